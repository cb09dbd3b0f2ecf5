#include "apps/outputs.h"

#include <algorithm>
#include <unistd.h>

#include "core/error.h"
#include "export/mhd_file.h"
#include "slicing/store/build_file.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

/// Where the path leads when links and dots are followed as far as it exists.
fs::path resolved(const fs::path& path) {
  std::error_code failure;
  const fs::path full = fs::absolute(path, failure);
  fs::path real = fs::weakly_canonical(full, failure);
  if (failure) return full.lexically_normal();
  return real.has_filename() ? real : real.parent_path();
}

/// The store is a folder too.
bool is_folder_format(const std::string& name) {
  const Format* format = find_format(name);
  return format == nullptr || format->is_folder;
}

/// The nearest part of the path that exists.
fs::path existing_part(fs::path path) {
  path = fs::absolute(path);
  std::error_code failure;
  while (!fs::exists(path, failure) && path.has_relative_path()) path = path.parent_path();
  return path;
}

void check_build_folder(const fs::path& folder) {
  std::error_code failure;
  if (fs::is_empty(folder, failure) || failure) return;
  for (const char* name : {kBuildName, kUnfinishedName}) {
    if (fs::exists(folder / name, failure)) return;
  }
  throw UsageError("the folder holds files but no build", folder.string(), "choose an empty or a new folder");
}

}  // namespace

namespace {

constexpr const char* kShardFolder = "layers";

/// Whether this is the folder of a build in which its layers lie.
bool is_shards(const fs::path& path) {
  std::error_code failure;
  return path.filename() == kShardFolder && fs::exists(path.parent_path() / kBuildName, failure);
}

/// A build is a folder with files of its own; others may lie beside them.
void append_files(const fs::path& input, std::vector<fs::path>& files) {
  files.push_back(input);
  std::error_code failure;
  if (!fs::is_directory(input, failure)) return;
  for (const char* name : {kBuildName, kUnfinishedName, "run.json", "layers.h5", kShardFolder}) {
    files.push_back(input / name);
  }
}

/// Whether `inner` is `outer` or lies below it.
bool is_within(const fs::path& inner, const fs::path& outer) {
  return std::mismatch(outer.begin(), outer.end(), inner.begin(), inner.end()).first == outer.end();
}

}  // namespace

std::vector<fs::path> places_of(const Output& output, const FormatOptions& options) {
  std::vector<fs::path> places{output.path};
  if (output.format != "mhd") return places;
  const fs::path data = mhd_data_place(output.path, options.raw);
  if (data != output.path) places.push_back(data);
  return places;
}

void refuse_inputs_as_outputs(const std::vector<fs::path>& outputs, const std::vector<std::string>& inputs) {
  std::vector<fs::path> inputs_there;
  for (const std::string& input : inputs) append_files(resolved(input), inputs_there);
  std::vector<fs::path> taken;
  for (const fs::path& output : outputs) {
    const fs::path place = resolved(output);
    for (const fs::path& input : inputs_there) {
      if (place == input || (is_shards(input) && is_within(place, input))) {
        throw UsageError("an output would overwrite an input", output.string(), "choose another name");
      }
    }
    for (const fs::path& other : taken) {
      if (!is_within(place, other) && !is_within(other, place)) continue;
      throw UsageError(place == other ? "two outputs have the same place" : "an output lies inside another",
                       output.string(), "choose a place of its own");
    }
    taken.push_back(place);
  }
}

void check_writable(const Output& output) {
  if (output.path.empty()) throw UsageError("an empty path", output.format, "name a place for the output");
  std::error_code failure;
  const bool exists = fs::exists(output.path, failure);
  const bool is_folder = fs::is_directory(output.path, failure);
  if (exists && is_folder != is_folder_format(output.format)) {
    throw ExportError(
        is_folder ? "a folder stands where a file is to be written" : "a file stands where a folder is needed",
        output.path.string(), "choose another name or remove it");
  }
  const fs::path above = existing_part(output.path);
  if (::access(above.c_str(), W_OK) != 0) {
    throw ExportError("can't write there", above.string(), "check the permissions");
  }
  if (is_folder && output.format == "store") check_build_folder(output.path);
}

std::vector<WrittenFile> list_files(const fs::path& path) {
  std::vector<WrittenFile> files;
  std::error_code failure;
  if (fs::is_regular_file(path, failure)) {
    files.push_back({path, fs::file_size(path, failure)});
    const fs::path data = mhd_data_file(path);
    if (!data.empty()) files.push_back({data, fs::file_size(data, failure)});
    return files;
  }
  for (fs::recursive_directory_iterator entry(path, failure), end; !failure && entry != end; entry.increment(failure)) {
    if (entry->is_regular_file(failure)) files.push_back({entry->path(), entry->file_size(failure)});
  }
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.path < b.path; });
  return files;
}

double total_bytes(const std::vector<WrittenFile>& files) {
  double bytes = 0.0;
  for (const WrittenFile& file : files) bytes += static_cast<double>(file.bytes);
  return bytes;
}

Json files_json(const std::string& format, const std::vector<WrittenFile>& files) {
  Json list = Json::array();
  for (const WrittenFile& file : files) list.push_back({{"path", file.path.string()}, {"bytes", file.bytes}});
  return {{"format", format}, {"files", list}};
}

}  // namespace lamella::apps
