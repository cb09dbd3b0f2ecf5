#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Arrays of numbers inside XML (docs/formats/slices-xml.md): as text, or as blocks of zlib + base64.
/// Numbers are double or std::uint32_t; binary ones are little-endian.
namespace lamella {

/// Largest number of items in one block. Bounds the memory that a hostile block can ask for, and keeps its text far
/// below the 10 MB at which libxml2 refuses a text node.
inline constexpr std::size_t kMaxBlockItems = std::size_t{1} << 16;

struct PackedBlock {
  std::size_t bytes = 0;   ///< before compression
  std::size_t stored = 0;  ///< after compression, before base64
  std::string text;        ///< base64
};

/// At most kMaxBlockItems numbers as one block. The same numbers give the same text.
template <class T>
[[nodiscard]] PackedBlock pack_block(std::span<const T> items);

/// Appends the numbers of a block. The sizes are checked against each other and against kMaxBlockItems before anything
/// is allocated; every error is a std::invalid_argument that says what is wrong.
template <class T>
void unpack_block(std::size_t bytes, std::size_t stored, std::string_view text, std::vector<T>& items);

/// Numbers with one blank between; doubles in the shortest form that reads back the same.
template <class T>
[[nodiscard]] std::string format_list(std::span<const T> items);

/// Appends the numbers of a white-space separated list; doubles must be finite. Throws std::invalid_argument on a
/// malformed number and when there are more than `most`.
template <class T>
void parse_list(std::string_view text, std::size_t most, std::vector<T>& items);

/// One number, with white space around it allowed. Throws std::invalid_argument.
template <class T>
[[nodiscard]] T parse_number(std::string_view text);

}  // namespace lamella
