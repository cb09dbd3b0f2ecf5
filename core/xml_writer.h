#pragma once

#include <array>
#include <concepts>
#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamella {

/// Writes XML as a stream, indented, one element at a time: start, attributes, then text or children, end.
/// Text and attributes are escaped; names must be legal XML names. Memory doesn't grow with the document.
class XmlWriter {
 public:
  /// Writes the XML declaration. `stream` outlives the writer; failures show in the stream's state.
  explicit XmlWriter(std::ostream& stream);

  XmlWriter& start(std::string_view name);
  XmlWriter& attribute(std::string_view name, std::string_view value);
  XmlWriter& attribute(std::string_view name, const char* value) { return attribute(name, std::string_view(value)); }
  XmlWriter& attribute(std::string_view name, bool value) { return attribute(name, value ? "true" : "false"); }
  /// Throws GeometryError when the number isn't finite.
  XmlWriter& attribute(std::string_view name, double value);
  template <std::integral T>
  XmlWriter& attribute(std::string_view name, T value) {
    return attribute(name, std::string_view(std::to_string(value)));
  }
  XmlWriter& attribute(std::string_view name, std::span<const double> values);
  /// Omitted when the number isn't finite: absent means unknown.
  XmlWriter& attribute_if_finite(std::string_view name, double value);
  /// Character data of an element without children.
  XmlWriter& text(std::string_view text);
  /// The same for long text that is known to need no escaping: numbers and base64.
  XmlWriter& plain_text(std::string_view text);
  XmlWriter& end();

 private:
  void finish_start_tag();
  void indent();

  std::ostream& stream_;
  std::vector<std::string> open_;
  bool in_start_tag_ = false;
  bool has_text_ = false;  ///< the innermost element holds text, so its end tag stays on the line
};

}  // namespace lamella
