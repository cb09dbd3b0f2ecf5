#include "tests/architecture/include_rules.h"

#include <algorithm>
#include <array>
#include <optional>
#include <regex>
#include <sstream>
#include <string_view>

namespace lamella::test {

namespace {

// Left to right is the only direction of dependency: a folder sees itself and those before it.
constexpr std::array<std::string_view, 6> kOrder = {"core", "model", "materials", "slicing", "export", "apps"};

struct ThirdParty {
  const char* header;  ///< regular expression on the header as included
  const char* place;   ///< regular expression on the including file
};

// Third parties and the only files that may name them.
const std::vector<ThirdParty> kThirdParties = {
    {"Eigen/.*", ".*"},  // the vocabulary of vectors, everywhere by way of core/geometry.h
    {"(tbb|oneapi)/.*", "core/parallel\\.cpp"},
    {"tinyxml2\\.h", "core/xml[a-z_]*\\.cpp"},
    {"openssl/.*", "core/sha256\\.cpp"},
    {"[A-Za-z0-9]+(_[A-Za-z0-9]+)*\\.(hxx|lxx|gxx)", "model/step/.*"},
    {"hdf5.*\\.h", "slicing/store/.*"},
    {"openvdb/.*", "(export/vdb/grid_set|materials/vdb_grids)\\.cpp"},
    {"libdeflate\\.h", "(export/.*|slicing/store/packed_layer)\\.cpp"},
    {"(png|zlib|tiffio|zip)\\.h", "export/.*\\.cpp"},
    {"libxml/.*", "export/.*\\.cpp"},
    {"polyclipping/.*", "export/material_contours\\.cpp"},
    {"muParser\\.h", "materials/.*\\.cpp"},
    {"(CLI|spdlog|nlohmann)/.*", "apps/.*"},
    {"fmt/.*", "(export|apps)/.*\\.cpp"},
};

// C and POSIX headers that aren't third parties.
const std::regex kSystemHeader(
    "(unistd|dlfcn|fcntl|malloc|signal|fnmatch|poll|pthread|dirent|errno|iconv|stdlib|stdio|string|math|time)\\.h|sys/"
    "[a-z_]+\\.h");

std::optional<std::size_t> rank_of(std::string_view path) {
  const std::string_view folder = path.substr(0, path.find('/'));
  const auto place = std::find(kOrder.begin(), kOrder.end(), folder);
  if (place == kOrder.end()) return std::nullopt;
  return static_cast<std::size_t>(place - kOrder.begin());
}

std::optional<std::string> judge_own(const std::string& file, const std::string& header) {
  const auto to = rank_of(header);
  if (!to) return "an include in quotes starts with a folder of the tree";
  if (*to > *rank_of(file)) return "a folder sees only itself and those to its left";
  return std::nullopt;
}

std::optional<std::string> judge_foreign(const std::string& file, const std::string& header) {
  for (const ThirdParty& party : kThirdParties) {
    if (!std::regex_match(header, std::regex(party.header))) continue;
    if (std::regex_match(file, std::regex(party.place))) return std::nullopt;
    return std::string("this third party stays in ") + party.place;
  }
  const bool standard = header.find_first_of("./") == std::string::npos;
  if (standard || std::regex_match(header, kSystemHeader)) return std::nullopt;
  return "a third party that tests/architecture/include_rules.cpp gives no place";
}

}  // namespace

std::vector<IncludeViolation> check_includes(const std::string& file, const std::string& text) {
  static const std::regex kInclude("^\\s*#\\s*include\\s*([<\"])([^>\"]+)[>\"].*");
  std::vector<IncludeViolation> violations;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::smatch match;
    if (!std::regex_match(line, match, kInclude)) continue;
    const std::string header = match[2];
    const auto reason = match[1] == "\"" ? judge_own(file, header) : judge_foreign(file, header);
    if (reason) violations.push_back({file, header, *reason});
  }
  return violations;
}

std::vector<std::filesystem::path> layered_sources(const std::filesystem::path& root) {
  std::vector<std::filesystem::path> sources;
  for (const std::string_view folder : kOrder) {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / folder)) {
      const auto extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp") sources.push_back(entry.path().lexically_relative(root));
    }
  }
  std::sort(sources.begin(), sources.end());
  return sources;
}

}  // namespace lamella::test
