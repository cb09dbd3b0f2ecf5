#pragma once

#include <filesystem>
#include <memory>

#include "export/volume_file.h"

namespace lamella {

struct TiffOptions {
  VolumeOptions volume{};
  /// Bytes from which on the file is a BigTIFF; offsets of others have 32 bits.
  std::uint64_t big_from = std::uint64_t{1} << 32;
};

/// One TIFF with a page for each slice, and what ImageJ reads of its lattice (docs/formats/tiff.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_tiff_sink(const std::filesystem::path& file,
                                                        const TiffOptions& options = {});

}  // namespace lamella
