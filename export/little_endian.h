#pragma once

#include <bit>
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

}  // namespace lamella
