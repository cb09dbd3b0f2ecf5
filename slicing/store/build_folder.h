#pragma once

#include <filesystem>

namespace lamella {

/// Readies `build` for a new build: creates the folder, or removes what an earlier build left in it. Other files in the
/// folder of an earlier build are not touched. Throws ExportError when it can't be written, UsageError when it holds
/// files but no build.
void prepare_build_folder(const std::filesystem::path& build);

/// Removes the files of a build, complete or not, and the folders if nothing else is in them.
void remove_build_files(const std::filesystem::path& build) noexcept;

}  // namespace lamella
