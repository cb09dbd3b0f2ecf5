#pragma once

#include <filesystem>
#include <memory>

#include "export/volume_file.h"

namespace lamella {

/// One VTK image file, labels as cell data, appended as raw bytes or zlib blocks (docs/formats/vti.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_vti_sink(const std::filesystem::path& file,
                                                       const VolumeOptions& options = {});

}  // namespace lamella
