#include "core/xml.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <tinyxml2.h>
#include <utility>

#include "core/error.h"
#include "core/xml_scan.h"

namespace lamella {

namespace detail {

struct XmlDocumentData {
  tinyxml2::XMLDocument tree;
  std::string name;
  int first_line = 1;

  /// "file:line" of a line of the text that was parsed.
  [[nodiscard]] std::string where(int line) const { return name + ":" + std::to_string(first_line - 1 + line); }
};

}  // namespace detail

namespace {

const tinyxml2::XMLElement& as_element(const void* element) {
  return *static_cast<const tinyxml2::XMLElement*>(element);
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Reads the whole of `text` as a number; XML Schema allows blanks around it and a leading plus.
template <class Number>
std::optional<Number> parse_number(std::string_view text) {
  text = trimmed(text);
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// Namespace declarations and schema hints belong to XML itself and are allowed everywhere.
bool belongs_to_xml(std::string_view attribute) {
  return attribute == "xmlns" || attribute.starts_with("xmlns:") || attribute.starts_with("xsi:") ||
         attribute.starts_with("xml:");
}

bool contains(std::initializer_list<std::string_view> names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string joined(std::initializer_list<std::string_view> names) {
  std::string out;
  for (const std::string_view name : names) out += (out.empty() ? "" : ", ") + std::string(name);
  return out.empty() ? "none" : out;
}

std::string read_bytes(const std::filesystem::path& path) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    throw InputError("can't read XML file", path.string(), "no such file");
  }
  std::ifstream stream(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, failure);
  std::string bytes(failure ? XmlDocument::kMaxBytes + 1 : std::min(size, XmlDocument::kMaxBytes + 1), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream.is_open() || stream.bad()) throw InputError("can't read XML file", path.string(), "is it readable?");
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

}  // namespace

std::string_view XmlElement::name() const { return as_element(element_).Name(); }

int XmlElement::line() const { return document_->first_line - 1 + as_element(element_).GetLineNum(); }

std::string XmlElement::where() const { return document_->where(as_element(element_).GetLineNum()); }

std::string XmlElement::text() const {
  std::string out;
  for (const auto* node = as_element(element_).FirstChild(); node != nullptr; node = node->NextSibling()) {
    if (const auto* text = node->ToText()) out += text->Value();
  }
  return std::string(trimmed(out));
}

bool XmlElement::has(const char* attribute) const { return as_element(element_).Attribute(attribute) != nullptr; }

std::string XmlElement::attribute(const char* name) const {
  if (const char* value = as_element(element_).Attribute(name)) return value;
  throw InputError("<" + std::string(this->name()) + "> has no attribute '" + name + "'", where(), "add it");
}

std::string XmlElement::attribute_or(const char* name, std::string fallback) const {
  return has(name) ? attribute(name) : std::move(fallback);
}

double XmlElement::number(const char* name) const {
  const std::string text = attribute(name);
  const auto value = parse_number<double>(text);
  if (!value || !std::isfinite(*value)) {
    throw InputError(std::string(name) + "=\"" + text + "\" is not a number", where(), "write it as 1.25 or 1e-3");
  }
  return *value;
}

double XmlElement::number_or(const char* name, double fallback) const { return has(name) ? number(name) : fallback; }

long XmlElement::integer(const char* name) const {
  const std::string text = attribute(name);
  const auto value = parse_number<long>(text);
  if (!value) throw InputError(std::string(name) + "=\"" + text + "\" is not a whole number", where(), "write digits");
  return *value;
}

long XmlElement::integer_or(const char* name, long fallback) const { return has(name) ? integer(name) : fallback; }

std::vector<std::string> XmlElement::attributes() const {
  std::vector<std::string> names;
  for (const auto* a = as_element(element_).FirstAttribute(); a != nullptr; a = a->Next()) {
    if (!belongs_to_xml(a->Name())) names.emplace_back(a->Name());
  }
  return names;
}

std::vector<XmlElement> XmlElement::children() const {
  std::vector<XmlElement> out;
  const auto& element = as_element(element_);
  for (const auto* child = element.FirstChildElement(); child != nullptr; child = child->NextSiblingElement()) {
    out.push_back(XmlElement(document_, child));
  }
  return out;
}

std::vector<XmlElement> XmlElement::children(std::string_view name) const {
  std::vector<XmlElement> out = children();
  std::erase_if(out, [name](const XmlElement& child) { return child.name() != name; });
  return out;
}

std::optional<XmlElement> XmlElement::child(std::string_view name) const {
  const std::vector<XmlElement> found = children(name);
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw InputError("more than one <" + std::string(name) + ">", found[1].where(), "leave one");
  }
  return found.front();
}

void XmlElement::allow_only(std::initializer_list<std::string_view> attributes,
                            std::initializer_list<std::string_view> children) const {
  std::string here(1, '<');
  here.append(name()).append(">");
  for (const auto* a = as_element(element_).FirstAttribute(); a != nullptr; a = a->Next()) {
    if (contains(attributes, a->Name()) || belongs_to_xml(a->Name())) continue;
    throw InputError(here + " has an unknown attribute '" + a->Name() + "'", document_->where(a->GetLineNum()),
                     "known: " + joined(attributes));
  }
  for (const XmlElement& child : this->children()) {
    if (contains(children, child.name())) continue;
    throw InputError(here + " has an unknown element <" + std::string(child.name()) + ">", child.where(),
                     "known: " + joined(children));
  }
  if (children.size() > 0 && !text().empty()) throw InputError(here + " holds text", where(), "remove the text");
}

XmlDocument::XmlDocument(std::unique_ptr<detail::XmlDocumentData> data) : data_(std::move(data)) {}
XmlDocument::~XmlDocument() = default;
XmlDocument::XmlDocument(XmlDocument&&) noexcept = default;
XmlDocument& XmlDocument::operator=(XmlDocument&&) noexcept = default;

XmlDocument XmlDocument::read(const std::filesystem::path& path) { return parse(read_bytes(path), path.string()); }

XmlDocument XmlDocument::parse(std::string_view text, std::string name, int first_line) {
  if (text.size() > kMaxBytes) throw InputError("XML file too large", name, "at most 64 MiB are read");
  detail::scan_xml(text, name, first_line);
  auto data = std::make_unique<detail::XmlDocumentData>();
  data->name = std::move(name);
  data->first_line = first_line;
  if (data->tree.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const std::string reason = tinyxml2::XMLDocument::ErrorIDToName(data->tree.ErrorID());
    throw InputError("not well-formed XML (" + reason + ")", data->where(data->tree.ErrorLineNum()),
                     "check the tags and quotes");
  }
  return XmlDocument(std::move(data));
}

XmlElement XmlDocument::root(std::string_view expected_name) const {
  const XmlElement found = root();
  if (found.name() == expected_name) return found;
  throw InputError(
      "the root element is <" + std::string(found.name()) + ">, expected <" + std::string(expected_name) + ">",
      found.where(), "is it the right file?");
}

XmlElement XmlDocument::root() const { return {data_.get(), data_->tree.RootElement()}; }

void check_xml_head(const XmlElement& root, std::string_view name_space, std::string_view kind) {
  if (root.attribute_or("xmlns", "") != name_space) {
    throw InputError("not a Lamella " + std::string(kind), root.where(),
                     "the root needs xmlns=\"" + std::string(name_space) + "\"");
  }
  constexpr std::size_t kLongest = 6;  // 1.9999
  const std::string version = root.attribute("version");
  const bool is_known = version.starts_with("1.") && version.size() > 2 && version.size() <= kLongest &&
                        version.find_first_not_of("0123456789", 2) == std::string::npos;
  if (is_known) return;
  throw InputError("version '" + version + "' isn't known", root.where(),
                   "this program reads versions 1.0 and later 1.x");
}

}  // namespace lamella
