#pragma once

#include <vector>

#include "slicing/span/tracer.h"

namespace lamella::span {

/// An arc that is carried from layer to layer: its points and how they moved when z rose.
struct CarriedArc {
  TracedArc arc;
  double z = 0.0;
  std::vector<Vec2> velocity;       ///< d(u, v) / dz at each point
  std::vector<Vec2> last_velocity;  ///< the same on the layer before; empty if there was none
  double last_z = 0.0;

  [[nodiscard]] bool empty() const { return arc.pieces.empty(); }
  /// Begins with an arc as traced at height z.
  void start(double height);
};

/// Moves a point of the surface by a step in (u, v) as its second derivatives say: position to second order, first
/// derivatives to first.
void shift(SurfacePoint2& at, const Vec2& step);

/// Brings a carried arc to height z between the given ends: every point by extrapolation and one evaluation, to second
/// order in what was left to correct; points on cell limits stay on them. The error of every piece is measured as when
/// tracing. False when the arc doesn't hold any more; then it has to be traced anew.
bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, CarriedArc& carried);

}  // namespace lamella::span
