#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lamella {

/// What a ZIP package is made of: names within it, in order, and where their bytes come from.
struct PackageParts {
  std::vector<std::pair<std::string, std::string>> texts;            ///< name and bytes
  std::vector<std::pair<std::string, std::filesystem::path>> files;  ///< name and file
};

/// Writes a ZIP file, deflated, under a temporary name first. All entries bear the same date, so that the same parts
/// give the same bytes. Throws ExportError.
void write_package(const std::filesystem::path& target, const PackageParts& parts);

}  // namespace lamella
