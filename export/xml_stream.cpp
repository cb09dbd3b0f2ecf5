#include "export/xml_stream.h"

#include <algorithm>
#include <cmath>
#include <libxml/xmlreader.h>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "export/xml_input.h"
#include "export/xml_payload.h"

namespace lamella {

namespace {

enum class Token { start, end, text, file_end };

std::string_view view(const xmlChar* text) {
  return text == nullptr ? std::string_view{} : std::string_view(reinterpret_cast<const char*>(text));
}

std::string said(const char* what, std::string_view name) { return std::string(what) + " '" + std::string(name) + "'"; }

}  // namespace

struct XmlStream::Reader {
  Reader(const std::filesystem::path& file, std::string ns) : input(file), name_space(std::move(ns)) {}

  XmlInput input;
  std::string name_space;
  Token token = Token::text;
  bool fresh = false;      ///< `token` has not been consumed
  bool empty_end = false;  ///< the element just entered was <a/>, whose end comes next
  std::vector<std::pair<std::string, std::string>> attributes;

  /// The next start, end or text of more than white space.
  Token peek() {
    while (!fresh) {
      if (std::exchange(empty_end, false)) {
        token = Token::end;
        fresh = true;
      } else if (!input.read()) {
        token = Token::file_end;
        fresh = true;
      } else {
        fresh = classify(xmlTextReaderNodeType(input.get()));
      }
    }
    return token;
  }

  /// Whether a node of this type is one to stop at; sets `token`.
  bool classify(int type) {
    switch (type) {
      case XML_READER_TYPE_ELEMENT:
        token = Token::start;
        return true;
      case XML_READER_TYPE_END_ELEMENT:
        token = Token::end;
        return true;
      case XML_READER_TYPE_TEXT:
      case XML_READER_TYPE_CDATA:
        token = Token::text;
        return true;
      case XML_READER_TYPE_WHITESPACE:
      case XML_READER_TYPE_SIGNIFICANT_WHITESPACE:
      case XML_READER_TYPE_COMMENT:
      case XML_READER_TYPE_PROCESSING_INSTRUCTION:
      case XML_READER_TYPE_XML_DECLARATION:
        return false;
      default:
        fail("unexpected kind of XML node");
    }
  }

  [[nodiscard]] std::string_view local_name() const { return view(xmlTextReaderConstLocalName(input.get())); }

  [[nodiscard]] std::string describe() const {
    switch (token) {
      case Token::start:
        return said("element", local_name());
      case Token::end:
        return "the end of the element";
      case Token::text:
        return "text";
      case Token::file_end:
        break;
    }
    return "the end of the file";
  }

  void read_attributes(std::initializer_list<std::string_view> allowed) {
    attributes.clear();
    xmlTextReader* reader = input.get();
    while (xmlTextReaderMoveToNextAttribute(reader) == 1) {
      if (xmlTextReaderIsNamespaceDecl(reader) == 1) continue;
      const std::string_view ns = view(xmlTextReaderConstNamespaceUri(reader));
      const std::string_view name = local_name();
      if (!ns.empty() || std::find(allowed.begin(), allowed.end(), name) == allowed.end()) {
        fail(said("unknown attribute", name));
      }
      attributes.emplace_back(name, view(xmlTextReaderConstValue(reader)));
    }
    xmlTextReaderMoveToElement(reader);
  }

  [[nodiscard]] const std::string* find(std::string_view name) const {
    for (const auto& [key, value] : attributes) {
      if (key == name) return &value;
    }
    return nullptr;
  }

  [[nodiscard]] const std::string& require(std::string_view name) const {
    if (const std::string* value = find(name)) return *value;
    fail(said("missing attribute", name));
  }

  [[noreturn]] void fail(const std::string& what, const std::string& hint = {}) const {
    throw InputError(what, input.name() + ":" + std::to_string(input.line()), hint);
  }
};

XmlStream::XmlStream(const std::filesystem::path& file, std::string name_space)
    : reader_(std::make_unique<Reader>(file, std::move(name_space))) {}

XmlStream::~XmlStream() = default;

bool XmlStream::at(std::string_view name) {
  return reader_->peek() == Token::start && reader_->local_name() == name &&
         view(xmlTextReaderConstNamespaceUri(reader_->input.get())) == reader_->name_space;
}

void XmlStream::enter(std::string_view name, std::initializer_list<std::string_view> attributes) {
  if (!at(name)) {
    fail(said("expected element", name) + ", found " + reader_->describe(),
         "elements are in namespace " + reader_->name_space);
  }
  const bool empty = xmlTextReaderIsEmptyElement(reader_->input.get()) == 1;
  reader_->read_attributes(attributes);
  reader_->fresh = false;
  reader_->empty_end = empty;
}

void XmlStream::leave() {
  if (reader_->peek() != Token::end) fail("expected the end of the element, found " + reader_->describe());
  reader_->fresh = false;
}

std::string XmlStream::text() {
  std::string text;
  while (reader_->peek() == Token::text) {
    text += view(xmlTextReaderConstValue(reader_->input.get()));
    reader_->fresh = false;
  }
  return text;
}

void XmlStream::finish() {
  if (reader_->peek() != Token::file_end) fail("expected the end of the file, found " + reader_->describe());
}

bool XmlStream::has(std::string_view name) const { return reader_->find(name) != nullptr; }

std::string XmlStream::attribute(std::string_view name) const { return reader_->require(name); }

double XmlStream::number(std::string_view name) const { return numbers(name, 1).front(); }

double XmlStream::number_or_unknown(std::string_view name) const { return has(name) ? number(name) : std::nan(""); }

std::int64_t XmlStream::integer(std::string_view name, std::int64_t least, std::int64_t most) const {
  try {
    const auto value = parse_number<std::int64_t>(reader_->require(name));
    if (value >= least && value <= most) return value;
  } catch (const std::invalid_argument& error) {
    fail(said("attribute", name) + ": " + error.what());
  }
  fail(said("attribute", name) + " is not between " + std::to_string(least) + " and " + std::to_string(most));
}

std::vector<double> XmlStream::numbers(std::string_view name, std::size_t count) const {
  std::vector<double> values;
  try {
    parse_list(reader_->require(name), count, values);
  } catch (const std::invalid_argument& error) {
    fail(said("attribute", name) + ": " + error.what());
  }
  if (values.size() != count) fail(said("attribute", name) + " needs " + std::to_string(count) + " numbers");
  return values;
}

std::int64_t XmlStream::bytes_read() const { return reader_->input.bytes_read(); }

void XmlStream::fail(const std::string& what, const std::string& hint) const { reader_->fail(what, hint); }

}  // namespace lamella
