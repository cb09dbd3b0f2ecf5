#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "slicing/layer_sink.h"

namespace lamella {

struct VdbOptions {
  bool density = true;              ///< the grid `density` of all materials together
  bool labels = true;               ///< the grid `material`
  bool fog = true;                  ///< a grid `density_<material>` each
  bool integer_ids = false;         ///< also an Int32 grid `material_id` (pyopenvdb can't read it)
  bool signed_distance = false;     ///< also a level set `surface_<material>` each, which needs cubic voxels
  std::optional<double> z_pitch{};  ///< mm, see UniformZ
};

/// One OpenVDB file: fog `density`, one float mask `density_<material>` each, float `material` ids (0 void, 1 + id), as
/// far as they are asked for; id-to-name metadata, and a voxel-centre transform with the true anisotropic pitch.
[[nodiscard]] std::unique_ptr<LayerSink> make_vdb_sink(const std::filesystem::path& file,
                                                       const VdbOptions& options = {});

}  // namespace lamella
