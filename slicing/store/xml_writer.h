#pragma once

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "core/xml.h"

namespace lamella {

/// XML of attributes and nested elements, indented, one element a line.
class XmlWriter {
 public:
  XmlWriter() : text_("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n") {}

  /// Starts an element inside the one that is open.
  XmlWriter& open(std::string_view name) {
    end_start_tag(">\n");
    text_.append(2 * open_.size(), ' ').append("<").append(name);
    open_.emplace_back(name);
    in_start_tag_ = true;
    return *this;
  }

  /// Adds an attribute to the element just opened.
  XmlWriter& attribute(std::string_view name, std::string_view value) {
    text_.append(" ").append(name).append("=\"").append(xml_escape(value)).append("\"");
    return *this;
  }
  XmlWriter& attribute(std::string_view name, const char* value) { return attribute(name, std::string_view(value)); }
  XmlWriter& attribute(std::string_view name, double value) {
    return attribute(name, std::string_view(format_double(value)));
  }
  XmlWriter& attribute(std::string_view name, bool value) { return attribute(name, value ? "true" : "false"); }
  XmlWriter& attribute(std::string_view name, std::integral auto value) {
    return attribute(name, std::string_view(std::to_string(value)));
  }

  XmlWriter& close() {
    const std::string name = std::move(open_.back());
    open_.pop_back();
    if (in_start_tag_) {
      end_start_tag("/>\n");
    } else {
      text_.append(2 * open_.size(), ' ').append("</").append(name).append(">\n");
    }
    return *this;
  }

  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  void end_start_tag(std::string_view end) {
    if (in_start_tag_) text_.append(end);
    in_start_tag_ = false;
  }

  std::string text_;
  std::vector<std::string> open_;
  bool in_start_tag_ = false;
};

}  // namespace lamella
