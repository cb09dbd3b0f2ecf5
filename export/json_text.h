#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace lamella {

/// Writes JSON (RFC 8259) on one line. Commas are its own; that objects and lists are closed is the caller's.
///
///     JsonText json;
///     json.open('{').key("pitch").number(0.1).close('}');
class JsonText {
 public:
  /// '{' or '['.
  JsonText& open(char bracket);
  JsonText& close(char bracket);
  JsonText& key(std::string_view name);
  /// Markup's `<` is escaped, so that the text may stand in a <script>.
  JsonText& text(std::string_view value);
  /// The shortest decimal that reads back as the same double; null unless finite.
  JsonText& number(double value);
  /// Seven significant digits, for what is only drawn.
  JsonText& short_number(double value);
  JsonText& integer(std::uint64_t value);
  JsonText& truth(bool value);

  [[nodiscard]] const std::string& str() const { return out_; }

 private:
  void separate();

  std::string out_;
};

}  // namespace lamella
