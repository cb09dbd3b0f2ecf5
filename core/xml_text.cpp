#include <array>
#include <charconv>
#include <cmath>

#include "core/error.h"
#include "core/utf8.h"
#include "core/xml.h"

namespace lamella {

namespace {

/// The escaped form of characters that may not stand for themselves, empty for the others. White space other than the
/// blank is escaped too, because XML turns it into blanks inside attributes.
std::string_view escaped(char32_t character) {
  switch (character) {
    case U'&':
      return "&amp;";
    case U'<':
      return "&lt;";
    case U'>':
      return "&gt;";
    case U'"':
      return "&quot;";
    case U'\'':
      return "&apos;";
    case U'\t':
      return "&#9;";
    case U'\n':
      return "&#10;";
    case U'\r':
      return "&#13;";
    default:
      return {};
  }
}

}  // namespace

std::string xml_escape(std::string_view text) {
  constexpr std::string_view kReplacement = "\xEF\xBF\xBD";  // U+FFFD
  std::string out;
  out.reserve(text.size() + text.size() / 8);
  for (std::size_t at = 0; at < text.size();) {
    const CodePoint c = decode_utf8(text, at);
    if (c.length == 0 || !is_xml_character(c.value)) {
      out += kReplacement;
      at += c.length == 0 ? 1 : c.length;
      continue;
    }
    const std::string_view replacement = escaped(c.value);
    out += replacement.empty() ? text.substr(at, c.length) : replacement;
    at += c.length;
  }
  return out;
}

std::string format_double(double value) {
  if (!std::isfinite(value)) throw GeometryError("a number that isn't finite can't be written", std::to_string(value));
  std::array<char, 32> digits;  // the longest shortest form has 24 characters
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

}  // namespace lamella
