#include "slicing/store/build_folder.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <system_error>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/xml.h"
#include "slicing/store/build_file.h"

namespace lamella {

namespace {

namespace fs = std::filesystem;

bool are_digits(const std::string& text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
}

/// "000012.h5", or the temporary name of one that a killed run left.
bool is_shard_file(const fs::path& file) {
  const std::string name = file.filename().string();
  const std::size_t dot = name.find('.');
  if (dot == std::string::npos || dot < 6 || !are_digits(name.substr(0, dot))) return false;
  return name.substr(dot) == ".h5" || name.compare(dot, 9, ".h5.part-") == 0;
}

/// One of the files beside the shards, or its temporary name.
bool is_build_file(const fs::path& file) {
  const std::string name = file.filename().string();
  for (const std::string known : {kBuildName, kUnfinishedName, kMasterName}) {
    if (name == known || name.starts_with(known + ".part-")) return true;
  }
  return false;
}

/// Whether an XML file has the root of a build of any version.
bool is_build_xml(const fs::path& file) {
  try {
    return XmlDocument::read(file).root("build").attribute_or("xmlns", "").starts_with("urn:lamella:build:");
  } catch (const Error&) {
    return false;
  }
}

void remove_matching(const fs::path& folder, bool (*is_ours)(const fs::path&)) noexcept {
  std::error_code failure;
  std::vector<fs::path> ours;
  for (fs::directory_iterator entry(folder, failure), end; !failure && entry != end; entry.increment(failure)) {
    if (is_ours(entry->path())) ours.push_back(entry->path());
  }
  for (const fs::path& file : ours) fs::remove(file, failure);
}

}  // namespace

void remove_build_files(const fs::path& build) noexcept {
  // build.xml goes first: without it nothing claims that the rest is whole.
  std::error_code ignored;
  fs::remove(build / kBuildName, ignored);
  remove_matching(build / kShardFolder, is_shard_file);
  remove_matching(build, is_build_file);
  fs::remove(build / kShardFolder, ignored);
  fs::remove(build, ignored);
}

void prepare_build_folder(const fs::path& build) {
  std::error_code failure;
  if (fs::exists(build, failure) && !fs::is_directory(build, failure)) {
    throw ExportError("a file is where the build's folder should be", build.string(), "choose another folder");
  }
  if (fs::is_symlink(build / kShardFolder, failure)) {
    throw ExportError("a link is where the build's shards should be", (build / kShardFolder).string(), "remove it");
  }
  const bool is_ours = is_build_xml(build / kBuildName) || is_build_xml(build / kUnfinishedName);
  if (fs::is_directory(build, failure) && !fs::is_empty(build, failure) && !is_ours) {
    throw UsageError("the folder is not empty and holds no build", build.string(), "choose an empty or new folder");
  }
  if (is_ours) remove_build_files(build);
  make_folder(build);
}

}  // namespace lamella
