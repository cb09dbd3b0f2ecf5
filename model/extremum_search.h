#pragma once

#include <optional>

#include "core/geometry.h"
#include "model/rational_form.h"
#include "model/trim.h"

namespace lamella {

/// What the search for an extremum inside a face may spend and must reach.
struct ExtremumLimits {
  double accuracy = 0.0;         ///< mm: an excess up to this is not looked for
  double border_accuracy = 0.0;  ///< mm: how far the border's images on face and edge may differ
  int max_boxes = 20000;
};

struct Extremum {
  double value = 0.0;
  bool converged = true;
  std::optional<Vec2> st;  ///< where, in the nets' parameters; nothing if `known` wasn't exceeded
};

/// Largest value of direction . S over the part of the nets inside `region`, at least `known` (the largest value
/// found on the border and along lines where the surface has a crease): branch and bound, best box first. A patch can't
/// exceed its control net (weights > 0), so what can't beat the value found is dropped, and so is what has no
/// stationary point by the signs of the net's differences.
[[nodiscard]] Extremum find_maximum(const RationalForm& form, const TrimRegion& region, const Vec3& direction,
                                    double known, const ExtremumLimits& limits);

}  // namespace lamella
