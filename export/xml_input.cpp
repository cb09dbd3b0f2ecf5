#include "export/xml_input.h"

#include <libxml/parser.h>
#include <libxml/xmlreader.h>
#include <mutex>
#include <system_error>
#include <utility>

#include "core/error.h"

namespace lamella {

namespace {

/// No entity is ever substituted, no DTD loaded, no network used; libxml2's own limits stay on (no XML_PARSE_HUGE).
constexpr int kOptions = XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING;

constexpr std::int64_t kLinesOfNodes = 65535;

void initialise_library() {
  static std::once_flag done;
  std::call_once(done, [] { xmlInitParser(); });
}

std::string trimmed(const char* message) {
  std::string text = message == nullptr ? "malformed XML" : message;
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text;
}

}  // namespace

XmlInput::XmlInput(const std::filesystem::path& file, OnInvalid on_invalid)
    : name_(file.string()), on_invalid_(std::move(on_invalid)), stream_(file, std::ios::binary), guard_(file.string()) {
  std::error_code ignored;
  if (!stream_ || !std::filesystem::is_regular_file(file, ignored)) {
    throw InputError("can't read file", name_, "check the name and its permissions");
  }
  initialise_library();
  reader_.reset(xmlReaderForIO(&XmlInput::on_read, nullptr, this, nullptr, "UTF-8", kOptions));
  if (refusal_) std::rethrow_exception(refusal_);
  if (!reader_) throw InputError("can't read XML: the file is empty or not XML", name_);
  xmlTextReaderSetStructuredErrorHandler(reader_.get(), &XmlInput::on_error, this);
}

void XmlInput::Free::operator()(_xmlTextReader* reader) const { xmlFreeTextReader(reader); }

bool XmlInput::read() {
  const int result = xmlTextReaderRead(reader_.get());
  if (refusal_) std::rethrow_exception(refusal_);
  // A document that ends early yields its last nodes first and only then a result below zero.
  if (result < 0) {
    throw InputError("malformed XML: " + (error_.empty() ? std::string("unexpected end of file") : error_),
                     name_ + ":" + std::to_string(error_line_ > 0 ? error_line_ : guard_.line()));
  }
  return result > 0;
}

std::int64_t XmlInput::line() const {
  const xmlNode* node = xmlTextReaderCurrentNode(reader_.get());
  const std::int64_t line = node == nullptr ? 0 : xmlGetLineNo(node);
  return line > 0 && line < kLinesOfNodes ? line : xmlTextReaderGetParserLineNumber(reader_.get());
}

int XmlInput::on_read(void* self, char* buffer, int length) {
  auto& input = *static_cast<XmlInput*>(self);
  try {
    input.stream_.read(buffer, length);
    const auto count = static_cast<std::size_t>(input.stream_.gcount());
    if (input.stream_.bad()) throw InputError("can't read file", input.name_);
    input.guard_.feed({buffer, count});
    input.bytes_read_ += static_cast<std::int64_t>(count);
    return static_cast<int>(count);
  } catch (...) {
    // Exceptions must not pass through libxml2; read() throws this one.
    input.refusal_ = std::current_exception();
    return -1;
  }
}

void XmlInput::on_error(void* self, _xmlError* error) {
  auto& input = *static_cast<XmlInput*>(self);
  if (error == nullptr || error->level < XML_ERR_ERROR) return;
  if (error->domain == XML_FROM_SCHEMASV) {
    if (input.on_invalid_) input.on_invalid_(error->line, trimmed(error->message));
    return;
  }
  if (!input.error_.empty()) return;
  input.error_ = trimmed(error->message);
  input.error_line_ = error->line;
}

}  // namespace lamella
