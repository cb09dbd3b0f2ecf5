#include "slicing/span/net_kernel.h"

#include <array>

#include "model/bezier.h"
#include "slicing/span/cpu_level.h"

namespace lamella::span {

static_assert(kMaxDegree == 25, "net_sums.cpp has room for as many poles");

#define LAMELLA_DECLARE(level)                                                           \
  void surface_slopes_##level(const double*, const NetPlace&, const NetPlace&, double*); \
  void surface_bends_##level(const double*, const NetPlace&, const NetPlace&, double*);  \
  void curve_##level(const double*, const NetPlace&, double*)
LAMELLA_DECLARE(v2);
LAMELLA_DECLARE(v3);
LAMELLA_DECLARE(v4);
#undef LAMELLA_DECLARE

namespace {

constexpr std::array<NetKernel, kCpuLevels> kBuilds{{
    {surface_slopes_v2, surface_bends_v2, curve_v2},
#if defined(LAMELLA_X86_LEVELS)
    {surface_slopes_v3, surface_bends_v3, curve_v3},
    {surface_slopes_v4, surface_bends_v4, curve_v4},
#endif
}};

}  // namespace

std::span<const NetKernel> net_kernels() { return usable(kBuilds); }

const NetKernel& net_kernel() {
  static const NetKernel& best = net_kernels().back();
  return best;
}

}  // namespace lamella::span
