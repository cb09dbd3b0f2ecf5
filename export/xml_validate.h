#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamella {

/// An XSD of ours, compiled into the program.
struct XmlSchema {
  std::string_view file_name;  ///< "slices.xsd"
  std::string_view text;

  /// The namespace that it describes.
  [[nodiscard]] std::string_view target_namespace() const;
};

[[nodiscard]] std::span<const XmlSchema> embedded_schemas();

/// One thing wrong with an XML file.
struct XmlFinding {
  std::int64_t line = 0;
  std::string what;
};

struct XmlValidation {
  std::string schema;                ///< file name of the schema that was used, empty when there is none
  std::vector<XmlFinding> findings;  ///< empty: valid; at most kMaxXmlFindings
};

inline constexpr std::size_t kMaxXmlFindings = 100;

/// Validates a file of any size, as a stream, against the schema of its root element's namespace. XML that isn't
/// well-formed or is refused (XmlGuard), and a namespace that is none of ours, are findings too.
/// Throws InputError when the file can't be read.
[[nodiscard]] XmlValidation validate_xml(const std::filesystem::path& file);

/// The same against a given schema. Throws InputError also when the schema itself is wrong.
[[nodiscard]] std::vector<XmlFinding> validate_xml(const std::filesystem::path& file, std::string_view schema);

}  // namespace lamella
