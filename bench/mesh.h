#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace lamella::bench {

/// Triangles of one solid over shared vertices: neighbours name the same vertex, so that a caster can be watertight.
struct SolidMesh {
  std::vector<Vec3> vertices;                           ///< mm
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices into `vertices`
};

/// The tessellation of a model.
struct ModelMesh {
  std::vector<SolidMesh> solids;
  double seconds = 0.0;  ///< CPU time of tessellating

  [[nodiscard]] std::size_t triangle_count() const;
};

/// The mesh as bytes, for pipes and the cache, and back. Throws std::runtime_error when bytes are missing.
[[nodiscard]] std::string to_bytes(const ModelMesh& mesh);
[[nodiscard]] ModelMesh mesh_from_bytes(const std::string& bytes);

}  // namespace lamella::bench
