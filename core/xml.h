#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lamella {

namespace detail {
struct XmlDocumentData;
}

/// One element of a settings-sized XML file; a view that lives as long as its `XmlDocument`.
/// All getters throw InputError with file and line when the value is missing or malformed.
class XmlElement {
 public:
  [[nodiscard]] std::string_view name() const;
  [[nodiscard]] int line() const;
  /// "file:line", for error messages.
  [[nodiscard]] std::string where() const;
  [[nodiscard]] std::string text() const;

  [[nodiscard]] bool has(const char* attribute) const;
  [[nodiscard]] std::string attribute(const char* name) const;
  [[nodiscard]] std::string attribute_or(const char* name, std::string fallback) const;
  [[nodiscard]] double number(const char* name) const;
  [[nodiscard]] double number_or(const char* name, double fallback) const;
  [[nodiscard]] long integer(const char* name) const;
  [[nodiscard]] long integer_or(const char* name, long fallback) const;

  /// Names of the attributes but those that belong to XML itself (xmlns, xsi:...), in the order of the file.
  [[nodiscard]] std::vector<std::string> attributes() const;

  [[nodiscard]] std::vector<XmlElement> children() const;
  [[nodiscard]] std::vector<XmlElement> children(std::string_view name) const;
  [[nodiscard]] std::optional<XmlElement> child(std::string_view name) const;

  /// Throws unless every attribute and child element is one of those named: a typing error must not pass silently.
  void allow_only(std::initializer_list<std::string_view> attributes,
                  std::initializer_list<std::string_view> children) const;

 private:
  friend class XmlDocument;
  XmlElement(const detail::XmlDocumentData* document, const void* element) : document_(document), element_(element) {}

  const detail::XmlDocumentData* document_;
  const void* element_;
};

/// A parsed settings-sized XML file.
///
/// Input is hostile: a document type declaration (and with it every entity definition) is refused, as are files over
/// `kMaxBytes`, nesting over `kMaxDepth`, and bytes that aren't UTF-8.
class XmlDocument {
 public:
  static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  static constexpr int kMaxDepth = 64;

  /// Reads and checks a file. Throws InputError with file and line.
  static XmlDocument read(const std::filesystem::path& path);
  /// The same on text; `name` stands for the file in messages, of which `first_line` is the text's first line.
  static XmlDocument parse(std::string_view text, std::string name, int first_line = 1);

  ~XmlDocument();
  XmlDocument(XmlDocument&&) noexcept;
  XmlDocument& operator=(XmlDocument&&) noexcept;

  /// The root element; throws InputError unless it has this name.
  [[nodiscard]] XmlElement root(std::string_view expected_name) const;
  /// The root element, whatever its name.
  [[nodiscard]] XmlElement root() const;

 private:
  explicit XmlDocument(std::unique_ptr<detail::XmlDocumentData> data);
  std::unique_ptr<detail::XmlDocumentData> data_;
};

/// Checks the root of a settings file: its namespace and version="1.x". `kind` is what the file ought to be, for the
/// message: "materials file". Throws InputError.
void check_xml_head(const XmlElement& root, std::string_view name_space, std::string_view kind);

/// `text` with the five XML specials escaped and control characters that XML 1.0 forbids replaced by U+FFFD.
[[nodiscard]] std::string xml_escape(std::string_view text);

/// The shortest decimal text that reads back as the same double ("inf" and "nan" are refused with GeometryError).
[[nodiscard]] std::string format_double(double value);

}  // namespace lamella
