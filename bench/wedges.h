#pragma once

#include <cstdint>
#include <memory>

#include "bench/mesh.h"
#include "bench/peer.h"

namespace lamella::bench {

/// Where an edge is on layer k: Y = y + (k - z) * slope_y, X = x + (k - z) * slope_x, from its lower end.
struct EdgeLine {
  float z;
  float y;
  float x;
  float slope_y;
  float slope_x;
};

/// The part of a triangle below or above its middle vertex, with one pair of edges over all its layers.
struct Wedge {
  std::int32_t first_layer;
  std::int32_t last_layer;  ///< one past
  EdgeLine a;
  EdgeLine b;
  float dx_dy;  ///< mm a row, on a layer; the triangle's plane
};

/// The triangles of one solid as mesh casters want them: each split into at most two wedges; those that meet no layer
/// are gone.
///
/// Lengths along y and z are counted in rows and layers, so that row m is at Y = m and layer k at Z = k; x is in mm.
/// Both triangles of an edge have it in the same floats: together with the half-open rules (layer k from ceil(Z0) to
/// ceil(Z1), row m from ceil(Y0) to ceil(Y1)) every row is crossed by an even number of triangles of a closed mesh.
struct Wedges {
  std::unique_ptr<Wedge[]> items;  ///< ascending by first layer
  std::uint32_t size = 0;
  std::int32_t first_row = 0;
  std::int32_t last_row = 0;  ///< one past; rows that the solid can meet
};

[[nodiscard]] Wedges make_wedges(const SolidMesh& mesh, const Lattice& lattice);

}  // namespace lamella::bench
