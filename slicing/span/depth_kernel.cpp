#include "slicing/span/depth_kernel.h"

#include <array>

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

struct Kernels {
  std::array<DepthKernel, 3> list;
  std::size_t count = 0;
};

Kernels find_kernels() {
  Kernels kernels;
  kernels.list[kernels.count++] = {solve_v2, blend_v2, round_v2, line_v2, "baseline"};
#if defined(LAMELLA_X86_LEVELS)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2")) {
    kernels.list[kernels.count++] = {solve_v3, blend_v3, round_v3, line_v3, "x86-64-v3"};
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd")) {
      kernels.list[kernels.count++] = {solve_v4, blend_v4, round_v4, line_v4, "x86-64-v4"};
    }
  }
#endif
  return kernels;
}

const Kernels& kernels() {
  static const Kernels found = find_kernels();
  return found;
}

}  // namespace

const DepthKernel& depth_kernel() { return kernels().list[kernels().count - 1]; }

std::size_t depth_kernels(const DepthKernel** list) {
  *list = kernels().list.data();
  return kernels().count;
}

}  // namespace lamella::span
