#pragma once

#include <cstddef>
#include <string_view>

namespace lamella {

/// One decoded character; `length` bytes long, 0 when the bytes aren't UTF-8.
struct CodePoint {
  char32_t value = 0;
  std::size_t length = 0;
};

/// Decodes the character at `text[position]`. Overlong forms, surrogates and values above U+10FFFF are refused
/// (RFC 3629), so that every text has one encoding only.
[[nodiscard]] CodePoint decode_utf8(std::string_view text, std::size_t position);

/// Whether XML 1.0 (production 2, Char) allows the character.
[[nodiscard]] bool is_xml_character(char32_t character);

}  // namespace lamella
