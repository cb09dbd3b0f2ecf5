#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>
#include <string>
#include <type_traits>

namespace lamella {

static_assert(std::endian::native == std::endian::little, "binary formats are written as numbers lie in memory");

/// Appends the bytes of a number, the lowest first.
template <class T>
requires std::is_arithmetic_v<T>
void append_little_endian(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Appends the lowest `bytes` bytes of a number, at most 8, the lowest first.
inline void append_little_endian(std::string& out, std::uint64_t value, int bytes) {
  out.append(reinterpret_cast<const char*>(&value), static_cast<std::size_t>(bytes));
}

/// Appends the bytes of a number, the highest first.
inline void append_big_endian(std::string& out, std::uint32_t value) {
  const auto* const bytes = reinterpret_cast<const char*>(&value);
  std::reverse_copy(bytes, bytes + sizeof(value), std::back_inserter(out));
}

}  // namespace lamella
