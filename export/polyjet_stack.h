#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "slicing/layer_sink.h"

namespace lamella {

struct PolyjetOptions {
  std::optional<double> z_pitch{};  ///< mm, see UniformZ
  std::int64_t fewest_slices = 30;  ///< that a build must have; less for a sample of one
};

/// A folder of PNGs for the voxel printing of PolyJet machines: RGBA, opaque, a colour per material on black, slices
/// numbered from 0 without a gap (docs/formats/polyjet.md). begin() throws UsageError on what these machines refuse.
[[nodiscard]] std::unique_ptr<LayerSink> make_polyjet_sink(const std::filesystem::path& folder,
                                                           const PolyjetOptions& options = {});

}  // namespace lamella
