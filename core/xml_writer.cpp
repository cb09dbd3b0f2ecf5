#include "core/xml_writer.h"

#include <cmath>

#include "core/xml.h"

namespace lamella {

XmlWriter::XmlWriter(std::ostream& stream) : stream_(stream) { stream_ << R"(<?xml version="1.0" encoding="UTF-8"?>)"; }

XmlWriter& XmlWriter::start(std::string_view name) {
  finish_start_tag();
  indent();
  stream_ << '<' << name;
  open_.emplace_back(name);
  in_start_tag_ = true;
  has_text_ = false;
  return *this;
}

XmlWriter& XmlWriter::attribute(std::string_view name, std::string_view value) {
  stream_ << ' ' << name << "=\"" << xml_escape(value) << '"';
  return *this;
}

XmlWriter& XmlWriter::attribute(std::string_view name, double value) {
  return attribute(name, std::string_view(format_double(value)));
}

XmlWriter& XmlWriter::attribute(std::string_view name, std::span<const double> values) {
  std::string text;
  for (double value : values) {
    if (!text.empty()) text += ' ';
    text += format_double(value);
  }
  return attribute(name, std::string_view(text));
}

XmlWriter& XmlWriter::attribute_if_finite(std::string_view name, double value) {
  return std::isfinite(value) ? attribute(name, value) : *this;
}

XmlWriter& XmlWriter::text(std::string_view text) { return plain_text(xml_escape(text)); }

XmlWriter& XmlWriter::plain_text(std::string_view text) {
  finish_start_tag();
  stream_ << text;
  has_text_ = true;
  return *this;
}

XmlWriter& XmlWriter::end() {
  const std::string name = std::move(open_.back());
  open_.pop_back();
  if (in_start_tag_) {
    stream_ << "/>";
    in_start_tag_ = false;
  } else {
    if (!has_text_) indent();
    stream_ << "</" << name << '>';
  }
  has_text_ = false;
  if (open_.empty()) stream_ << '\n';
  return *this;
}

void XmlWriter::finish_start_tag() {
  if (in_start_tag_) stream_ << '>';
  in_start_tag_ = false;
}

void XmlWriter::indent() {
  stream_ << '\n';
  for (std::size_t i = 0; i < open_.size(); ++i) stream_ << ' ';
}

}  // namespace lamella
