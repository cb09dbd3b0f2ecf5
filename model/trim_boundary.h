#pragma once

#include <cstddef>
#include <vector>

#include "model/bezier.h"
#include "model/scene.h"

namespace lamella {

/// The closed boundary of a face's region in (u, v): the pieces of loop k are pieces[loop_begin[k], loop_begin[k + 1]),
/// each beginning bit for bit where the one before it ends, the region on the left.
struct TrimBoundary {
  std::vector<BezierCurve2> pieces;
  std::vector<std::size_t> loop_begin;
};

/// Joins a face's pcurves to closed loops: brings them into one period, bridges gaps by straight pieces, turns loops of
/// a face of opposite sense round, adds the seam between rings around a periodic surface, and takes the face's
/// uv_bounds (or the whole of a closed surface) when no loop encloses anything. Throws GeometryError, naming face and
/// edge, for pcurves beyond the limits.
[[nodiscard]] TrimBoundary trim_boundary(const Scene& scene, FaceId face);

}  // namespace lamella
