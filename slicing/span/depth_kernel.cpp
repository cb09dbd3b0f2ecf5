#include "slicing/span/depth_kernel.h"

#include <array>

#include "slicing/span/cpu_level.h"

namespace lamella::span {

#define LAMELLA_DECLARE(level)                                               \
  void solve_##level(DepthTask*, std::size_t, double, double*);              \
  void blend_##level(const double*, std::size_t, double, double*);           \
  void round_##level(const RoundTask&, const double*, std::size_t, double*); \
  void line_##level(const LineTask&, const double*, std::size_t, double*)
LAMELLA_DECLARE(v2);
LAMELLA_DECLARE(v3);
LAMELLA_DECLARE(v4);
#undef LAMELLA_DECLARE

namespace {

constexpr std::array<DepthKernel, kCpuLevels> kBuilds{{
    {solve_v2, blend_v2, round_v2, line_v2},
#if defined(LAMELLA_X86_LEVELS)
    {solve_v3, blend_v3, round_v3, line_v3},
    {solve_v4, blend_v4, round_v4, line_v4},
#endif
}};

}  // namespace

std::span<const DepthKernel> depth_kernels() { return usable(kBuilds); }

const DepthKernel& depth_kernel() {
  static const DepthKernel& best = depth_kernels().back();
  return best;
}

}  // namespace lamella::span
