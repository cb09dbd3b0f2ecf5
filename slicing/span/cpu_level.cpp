#include "slicing/span/cpu_level.h"

namespace lamella::span {

namespace {

constexpr std::array<const char*, kCpuLevels> kNames{"baseline", "x86-64-v3", "x86-64-v4"};

std::size_t count_levels() {
#if defined(LAMELLA_X86_LEVELS)
  const bool runs_v3 =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
  const bool runs_v4 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                       __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
                       __builtin_cpu_supports("avx512cd");
  if (runs_v3) return runs_v4 ? 3 : 2;
#endif
  return 1;
}

}  // namespace

std::span<const char* const> cpu_levels() {
  static const std::size_t count = count_levels();
  return std::span<const char* const>(kNames).first(count);
}

}  // namespace lamella::span
