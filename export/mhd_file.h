#pragma once

#include <filesystem>
#include <memory>

#include "export/volume_file.h"

namespace lamella {

/// A MetaImage header and its labels beside it, in a .zraw file or, not compressed, a .raw file of the same name; with
/// a table of the materials (docs/formats/mhd.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_mhd_sink(const std::filesystem::path& file,
                                                       const VolumeOptions& options = {});

/// Where make_mhd_sink() puts the data.
[[nodiscard]] std::filesystem::path mhd_data_place(std::filesystem::path file, bool is_raw);

/// The file that holds the data of a MetaImage header of ours; empty when `file` is none or has lost it.
[[nodiscard]] std::filesystem::path mhd_data_file(const std::filesystem::path& file);

}  // namespace lamella
