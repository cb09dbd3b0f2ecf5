#include "export/step_entities.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/utf8.h"
#include "export/decimal.h"

namespace lamella {

namespace {

/// Of a long list, so that lines stay short enough for any reader.
constexpr std::size_t kIdsPerLine = 16;

}  // namespace

StepId StepEntities::add(std::string_view text) {
  stream_ << '#' << ++last_ << '=' << text << ";\n";
  return last_;
}

std::string step_string(std::string_view text) {
  constexpr CodePoint kUnknown{U'\uFFFD', 1};
  std::string out = "'";
  for (std::size_t at = 0; at < text.size();) {
    CodePoint c = decode_utf8(text, at);
    if (c.length == 0) c = kUnknown;
    at += c.length;
    if (c.value == U'\'' || c.value == U'\\') {
      out.append(2, static_cast<char>(c.value));
    } else if (c.value >= U' ' && c.value <= U'~') {
      out += static_cast<char>(c.value);
    } else if (c.value <= 0xFFFF) {
      out += fmt::format("\\X2\\{:04X}\\X0\\", static_cast<unsigned>(c.value));
    } else {
      out += fmt::format("\\X4\\{:08X}\\X0\\", static_cast<unsigned>(c.value));
    }
  }
  return out + "'";
}

std::string step_real(double value) {
  std::string text;
  append_decimal(text, value);
  if (text.find('.') == std::string::npos) text += '.';
  return text;
}

std::string step_exact_real(double value) {
  std::string text = fmt::format("{}", value);
  const std::size_t exponent = text.find('e');
  if (text.find('.') == std::string::npos) text.insert(std::min(exponent, text.size()), 1, '.');
  std::replace(text.begin(), text.end(), 'e', 'E');
  return text;
}

std::string step_reference(StepId id) { return fmt::format("#{}", id); }

std::string step_list(std::span<const StepId> ids) {
  std::string out = "(";
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i > 0) out += i % kIdsPerLine == 0 ? ",\n" : ",";
    out += step_reference(ids[i]);
  }
  return out + ")";
}

}  // namespace lamella
