#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lamella {

/// A stretch of bytes in a file.
struct FilePart {
  std::string name;  ///< in the package
  std::uint64_t begin = 0;
  std::uint64_t bytes = 0;
};

/// What a ZIP package is made of: names within it, in order, and where their bytes come from.
struct PackageParts {
  std::vector<std::pair<std::string, std::string>> texts;            ///< name and bytes, deflated
  std::vector<std::pair<std::string, std::filesystem::path>> files;  ///< name and file, deflated
  std::filesystem::path images{};  ///< a file whose stretches are stored as they are, since they are compressed already
  std::vector<FilePart> image_parts{};
};

/// Writes a ZIP file under a temporary name first. All entries bear the same date, so that the same parts give the same
/// bytes. Throws ExportError.
void write_package(const std::filesystem::path& target, const PackageParts& parts);

}  // namespace lamella
