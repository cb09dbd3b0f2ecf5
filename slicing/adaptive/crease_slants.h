#pragma once

#include <vector>

#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/ridge_slants.h"

namespace lamella {

/// Lines inside a face where normals jump.
struct CreaseSlants {
  std::vector<Slant> parts;
  std::vector<double> extrema;  ///< heights in mm where a vertical lies between the normals around a place of it
  std::size_t sharp = 0;        ///< lines that are wedges of which more than the allowed deviation may be cut off
};

/// What the face's creases are: the knots of full multiplicity of its B-spline, in which it is continuous but need not
/// be smooth. They count as the edges between two faces do, their crossings as vertices.
[[nodiscard]] CreaseSlants crease_slants(const FaceSlants& face, const SlantProfile& known, const WedgeRule& wedges);

/// The face's creases as lines. The face must outlive them.
[[nodiscard]] std::vector<RidgeLine> crease_lines(const FaceSlants& face);

/// Where a half-edge of the face crosses one of its creases, or one ends in it: shares of its edge's range inside
/// (0, 1), ascending. Along a crease there are none.
[[nodiscard]] std::vector<double> crease_crossings(const FaceSlants& face, const Scene& scene, HalfEdgeId half_edge);

}  // namespace lamella
