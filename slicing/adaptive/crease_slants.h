#pragma once

#include <vector>

#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/ridge_slants.h"

namespace lamella {

/// A line inside a face where normals jump.
struct CreaseSlants {
  std::vector<Slant> parts;
  std::vector<double> extrema;  ///< heights in mm where a vertical lies between the normals around a place of it
  std::size_t sharp = 0;        ///< lines that are wedges of which more than the allowed deviation may be cut off
};

/// What the face's creases are: the knots of full multiplicity of its B-spline, in which it is continuous but need not
/// be smooth. They count as the edges between two faces do, their crossings as vertices.
[[nodiscard]] CreaseSlants crease_slants(const FaceSlants& face, const SlantProfile& known, const WedgeRule& wedges);

}  // namespace lamella
