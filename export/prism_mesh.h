#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "export/material_contours.h"
#include "export/triangulate.h"

namespace lamella {

/// A closed surface of triangles that shows a material as a stack of upright prisms.
struct PrismMesh {
  std::vector<Vec3> points;         ///< mm
  std::vector<Triangle> triangles;  ///< counterclockwise from outside

  /// Adds what the loops enclose from one height to another. Prisms have no points in common, so each closes by itself.
  void add(std::span<const MaterialLoop> loops, double z_bottom, double z_top);
};

}  // namespace lamella
