#pragma once

#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/ridge_slants.h"

namespace lamella {

/// Parts that cover an edge, given by one of its half-edges, with bounds of the slant of what lies between the normals
/// of its two faces. Where `known`, the slants of the faces, has as much anyway, parts may be long and bounds
/// coarse. An edge without a twin may be slanted in any way.
[[nodiscard]] EdgeSlants edge_slants(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                                     const FaceSlants* neighbor, const SlantProfile& known, const WedgeRule& wedges);

/// An edge that isn't degenerate, given by one of its half-edges. What is passed must outlive the line.
[[nodiscard]] RidgeLine edge_line(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                                  const FaceSlants& neighbor);

/// The face's parameters on a half-edge at a share, in [0, 1], of its edge's range.
[[nodiscard]] Vec2 parameters_at(const Scene& scene, HalfEdgeId half_edge, double share);

}  // namespace lamella
