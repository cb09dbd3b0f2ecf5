#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/formats.h"
#include "apps/json.h"

namespace lamella::apps {

/// A file that a run has written.
struct WrittenFile {
  std::filesystem::path path;
  std::uintmax_t bytes = 0;
};

/// The files or folders that an output takes.
[[nodiscard]] std::vector<std::filesystem::path> places_of(const Output& output, const FormatOptions& options);

/// Throws UsageError when an output is one of the inputs, or a file of one that is a build, or lies where another
/// output lies.
void refuse_inputs_as_outputs(const std::vector<std::filesystem::path>& outputs,
                              const std::vector<std::string>& inputs);

/// Throws ExportError when an output certainly can't be written: a file where a folder is needed, a folder where a file
/// is needed, or a place where nothing may be created. Creates nothing.
void check_writable(const Output& output);

/// The files of an output, by name; none when it doesn't exist.
[[nodiscard]] std::vector<WrittenFile> list_files(const std::filesystem::path& path);

/// Their sizes together.
[[nodiscard]] double total_bytes(const std::vector<WrittenFile>& files);
/// {"format","files":[{"path","bytes"}]}
[[nodiscard]] Json files_json(const std::string& format, const std::vector<WrittenFile>& files);

}  // namespace lamella::apps
