#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace lamella::span {

/// How often kernels are compiled: for three levels of the x86-64 architecture, or once for other processors.
inline constexpr std::size_t kCpuLevels = 3;

/// The names of the levels that this machine runs, the lowest first: one at least.
[[nodiscard]] std::span<const char* const> cpu_levels();

/// Those of a kernel's builds, lowest level first, that this machine runs; the last is the best one.
template <typename Kernel>
[[nodiscard]] std::span<const Kernel> usable(const std::array<Kernel, kCpuLevels>& builds) {
  return std::span<const Kernel>(builds).first(cpu_levels().size());
}

}  // namespace lamella::span
