#pragma once

#include <cstdint>
#include <vector>

#include "bench/mesh.h"
#include "bench/peer.h"

namespace lamella::bench {

/// The triangles of one solid as mesh casters want them: each split at its middle vertex into at most two wedges, which
/// have one pair of edges over all their layers. Structure of arrays, ascending by first layer.
///
/// Lengths along y and z are counted in rows and layers, so that row m is at Y = m and layer k at Z = k; x is in mm.
/// An edge gives Y and X on layer k as anchor + (k - anchor_z) * slope from its lower end, in the same floats for both
/// of its triangles: together with the half-open rules (layer k from ceil(Z0) to ceil(Z1), row m from ceil(Y0) to
/// ceil(Y1)) every row is crossed by an even number of triangles of a closed mesh.
struct Wedges {
  std::vector<std::int32_t> first_layer;
  std::vector<std::int32_t> last_layer;  ///< one past
  std::vector<float> z_a, y_a, x_a, slope_y_a, slope_x_a;
  std::vector<float> z_b, y_b, x_b, slope_y_b, slope_x_b;
  std::vector<float> dx_dy;  ///< mm a row, on a layer; the triangle's plane
  std::int32_t first_row = 0;
  std::int32_t last_row = 0;  ///< one past; rows that the solid can meet

  [[nodiscard]] std::size_t size() const { return first_layer.size(); }
};

[[nodiscard]] Wedges make_wedges(const SolidMesh& mesh, const Lattice& lattice);

}  // namespace lamella::bench
