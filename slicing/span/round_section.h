#pragma once

#include <optional>
#include <vector>

#include "model/surface.h"
#include "slicing/span/arc_piece.h"

namespace lamella::span {

/// center + cos(a) cosine + sin(a) sine in the layer's plane.
struct PlaneEllipse {
  Vec2 center = Vec2::Zero();
  Vec2 cosine = Vec2::Zero();
  Vec2 sine = Vec2::Zero();

  [[nodiscard]] Vec2 at(double angle) const { return center + std::cos(angle) * cosine + std::sin(angle) * sine; }
  /// The angle in (-pi, pi] of the point on the ellipse towards `xy` in its own affine frame.
  [[nodiscard]] double angle_of(const Vec2& xy) const;
};

/// The part of an ellipse from angle `begin` over `sweep`, of either sign.
struct EllipseArc {
  PlaneEllipse ellipse;
  double begin = 0.0;
  double sweep = 0.0;
};

/// Whether all sections of a surface are ellipses with the surface's own u as angle: cylinders that aren't nearly
/// horizontal, cones and tori with a vertical axis; and spheres, whose angle is counted from +x.
[[nodiscard]] bool has_round_sections(const Surface& surface);

/// The section of such a surface at height z; `inner` chooses the inner of a torus' two circles. Radii are 0 where the
/// surface doesn't reach.
[[nodiscard]] PlaneEllipse round_section(const Surface& surface, double z, bool inner);

/// (u, v) of the surface at an angle of its section.
[[nodiscard]] Vec2 round_parameters(const Surface& surface, double z, bool inner, double angle);

/// The arc as quintics that keep to the tolerance, mm.
void append_pieces(const EllipseArc& arc, double tolerance, std::vector<ArcPiece>& pieces);

}  // namespace lamella::span
