#include <charconv>

#include "model/step/part21.h"
#include "model/step/text.h"

namespace lamella::step {
namespace {

void append_utf8(std::string& out, char32_t code) {
  if (code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) code = 0xFFFD;
  if (code < 0x80) {
    out.push_back(static_cast<char>(code));
  } else if (code < 0x800) {
    out.push_back(static_cast<char>(0xC0 | (code >> 6)));
    out.push_back(static_cast<char>(0x80 | (code & 0x3F)));
  } else if (code < 0x10000) {
    out.push_back(static_cast<char>(0xE0 | (code >> 12)));
    out.push_back(static_cast<char>(0x80 | ((code >> 6) & 0x3F)));
    out.push_back(static_cast<char>(0x80 | (code & 0x3F)));
  } else {
    out.push_back(static_cast<char>(0xF0 | (code >> 18)));
    out.push_back(static_cast<char>(0x80 | ((code >> 12) & 0x3F)));
    out.push_back(static_cast<char>(0x80 | ((code >> 6) & 0x3F)));
    out.push_back(static_cast<char>(0x80 | (code & 0x3F)));
  }
}

/// `digits` hexadecimal digits at `i`; false when they aren't there.
bool read_hex(std::string_view text, std::size_t i, std::size_t digits, char32_t& code) {
  if (i + digits > text.size()) return false;
  std::uint32_t value = 0;
  const char* end = text.data() + i + digits;
  const auto [stop, error] = std::from_chars(text.data() + i, end, value, 16);
  code = value;
  return error == std::errc() && stop == end;
}

/// \X2\ and \X4\: characters of 4 or 8 digits up to \X0\. Returns the index after it.
std::size_t append_wide(std::string_view text, std::size_t i, std::size_t digits, std::string& out) {
  char32_t high = 0;
  while (i < text.size() && text.substr(i, 4) != "\\X0\\") {
    char32_t code = 0;
    if (!read_hex(text, i, digits, code)) return i;
    i += digits;
    // Some exporters write UTF-16 where the standard wants UCS-2.
    if (digits == 4 && code >= 0xD800 && code <= 0xDBFF) {
      high = code;
      continue;
    }
    if (high != 0 && code >= 0xDC00 && code <= 0xDFFF) code = 0x10000 + ((high - 0xD800) << 10) + (code - 0xDC00);
    high = 0;
    append_utf8(out, code);
  }
  return i + 4;
}

/// The directive at `i`, which holds a backslash; returns the index after it.
std::size_t append_directive(std::string_view text, std::size_t i, std::string& out) {
  const std::string_view rest = text.substr(i);
  if (rest.starts_with("\\X2\\")) return append_wide(text, i + 4, 4, out);
  if (rest.starts_with("\\X4\\")) return append_wide(text, i + 4, 8, out);
  char32_t code = 0;
  if (rest.starts_with("\\X\\") && read_hex(text, i + 3, 2, code)) {
    append_utf8(out, code);
    return i + 5;
  }
  if (rest.starts_with("\\S\\") && rest.size() > 3 && static_cast<unsigned char>(rest[3]) < 0x80) {
    append_utf8(out, static_cast<unsigned char>(rest[3]) + 0x80U);
    return i + 4;
  }
  if (rest.starts_with("\\P") && rest.size() > 3 && rest[3] == '\\') return i + 4;
  out.push_back('\\');
  return i + (rest.starts_with("\\\\") ? 2 : 1);
}

}  // namespace

std::string decode_string(std::string_view text) {
  const std::string whole = is_utf8(text) ? std::string(text) : latin1_to_utf8(text);
  std::string result;
  for (std::size_t i = 0; i < whole.size();) {
    if (whole[i] == '\\') {
      i = append_directive(whole, i, result);
    } else if (whole[i] == '\'') {
      result.push_back('\'');
      i += whole.compare(i, 2, "''") == 0 ? 2 : 1;
    } else {
      result.push_back(whole[i++]);
    }
  }
  return result;
}

}  // namespace lamella::step
