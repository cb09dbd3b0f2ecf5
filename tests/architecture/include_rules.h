#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lamella::test {

/// One `#include` that breaks the architecture: an arrow to the right, or a third party outside its place.
struct IncludeViolation {
  std::string file;    ///< path in the tree
  std::string header;  ///< as included
  std::string reason;
};

/// Judges the includes in `text`, the contents of `file` (a path relative to the root of the tree).
[[nodiscard]] std::vector<IncludeViolation> check_includes(const std::string& file, const std::string& text);

/// All C++ files of the layered folders below `root`, relative to it.
[[nodiscard]] std::vector<std::filesystem::path> layered_sources(const std::filesystem::path& root);

}  // namespace lamella::test
