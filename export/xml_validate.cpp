#include "export/xml_validate.h"

#include <libxml/xmlreader.h>
#include <libxml/xmlschemas.h>
#include <memory>

#include "core/error.h"
#include "export/xml_input.h"

namespace lamella {

namespace {

struct FreeSchema {
  void operator()(xmlSchemaParserCtxt* context) const { xmlSchemaFreeParserCtxt(context); }
  void operator()(xmlSchema* schema) const { xmlSchemaFree(schema); }
  void operator()(xmlSchemaValidCtxt* context) const { xmlSchemaFreeValidCtxt(context); }
};

void keep_first_message(void* data, xmlErrorPtr error) {
  auto& message = *static_cast<std::string*>(data);
  if (message.empty() && error != nullptr && error->message != nullptr) message = error->message;
}

std::unique_ptr<xmlSchema, FreeSchema> parse_schema(std::string_view text) {
  const std::unique_ptr<xmlSchemaParserCtxt, FreeSchema> context(
      xmlSchemaNewMemParserCtxt(text.data(), static_cast<int>(text.size())));
  std::string message;
  xmlSchemaSetParserStructuredErrors(context.get(), &keep_first_message, &message);
  std::unique_ptr<xmlSchema, FreeSchema> schema(xmlSchemaParse(context.get()));
  if (!schema) throw InputError("the XML schema is wrong: " + message);
  return schema;
}

/// The line behind the last colon of "file:line".
std::int64_t line_of(const std::string& where) {
  const auto colon = where.rfind(':');
  const std::string digits = colon == std::string::npos ? "" : where.substr(colon + 1);
  const bool number =
      !digits.empty() && digits.size() < 18 && digits.find_first_not_of("0123456789") == std::string::npos;
  return number ? std::stoll(digits) : 0;
}

/// Namespace and local name of the root element.
struct Root {
  std::string name_space;
  std::string name;
  std::int64_t line = 0;
};

Root read_root(const std::filesystem::path& file) {
  XmlInput input(file);
  const auto text = [](const xmlChar* s) { return s == nullptr ? "" : reinterpret_cast<const char*>(s); };
  while (input.read()) {
    if (xmlTextReaderNodeType(input.get()) != XML_READER_TYPE_ELEMENT) continue;
    return {text(xmlTextReaderConstNamespaceUri(input.get())), text(xmlTextReaderConstLocalName(input.get())),
            input.line()};
  }
  return {};
}

}  // namespace

std::string_view XmlSchema::target_namespace() const {
  constexpr std::string_view kAttribute = "targetNamespace=\"";
  const auto begin = text.find(kAttribute);
  if (begin == std::string_view::npos) return {};
  const std::string_view rest = text.substr(begin + kAttribute.size());
  return rest.substr(0, rest.find('"'));
}

std::vector<XmlFinding> validate_xml(const std::filesystem::path& file, std::string_view schema_text) {
  const auto schema = parse_schema(schema_text);
  const std::unique_ptr<xmlSchemaValidCtxt, FreeSchema> context(xmlSchemaNewValidCtxt(schema.get()));
  std::vector<XmlFinding> findings;
  XmlInput input(file, [&](std::int64_t line, const std::string& what) { findings.push_back({line, what}); });
  if (!context || xmlTextReaderSchemaValidateCtxt(input.get(), context.get(), 0) != 0) {
    throw InputError("can't start the XML validation", file.string());
  }
  try {
    while (findings.size() < kMaxXmlFindings && input.read()) {
    }
  } catch (const InputError& error) {
    findings.push_back({line_of(error.where()), error.what()});
  }
  if (findings.size() > kMaxXmlFindings) findings.resize(kMaxXmlFindings);
  return findings;
}

XmlValidation validate_xml(const std::filesystem::path& file) {
  Root root;
  try {
    root = read_root(file);
  } catch (const InputError& error) {
    if (error.where() == file.string()) throw;  // the file itself, not a line of it
    return {"", {{line_of(error.where()), error.what()}}};
  }
  for (const XmlSchema& schema : embedded_schemas()) {
    if (schema.target_namespace() == root.name_space && !root.name_space.empty()) {
      return {std::string(schema.file_name), validate_xml(file, schema.text)};
    }
  }
  return {"",
          {{root.line, "no schema is known for element '" + root.name + "' in namespace '" + root.name_space + "'"}}};
}

}  // namespace lamella
