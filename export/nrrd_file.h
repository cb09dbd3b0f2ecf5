#pragma once

#include <filesystem>
#include <memory>

#include "export/volume_file.h"

namespace lamella {

/// One NRRD file of labels with the names and colours of the materials as segments (docs/formats/nrrd.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_nrrd_sink(const std::filesystem::path& file,
                                                        const VolumeOptions& options = {});

}  // namespace lamella
