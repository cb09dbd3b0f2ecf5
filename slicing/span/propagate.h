#pragma once

#include <vector>

#include "slicing/span/tracer.h"

namespace lamella::span {

/// How a point of a section moves when z rises, by divided differences over the last layers.
struct Motion {
  Vec2 velocity = Vec2::Zero();  ///< d(u, v) / dz
  Vec2 change = Vec2::Zero();    ///< its difference from the layer before, by z
  Vec2 bend = Vec2::Zero();      ///< the same of the change, over three layers
};

/// An arc that is carried from layer to layer: its points and how they moved when z rose.
struct CarriedArc {
  TracedArc arc;
  double z = 0.0;
  std::vector<Motion> motions;  ///< one a point
  double last_step = 0.0;       ///< of z, from the layer before; 0 if there was none
  double step_before = 0.0;     ///< and to that

  [[nodiscard]] bool empty() const { return arc.pieces.empty(); }
  /// Begins with an arc as traced at height z.
  void start(double height);
};

/// Brings a carried arc to height z between the given ends: its points side by side by extrapolation and one evaluation,
/// to second order in what was left to correct; points on cell limits stay on them. The error of every piece is measured
/// as when tracing; pieces that are too long for it are divided, points that were overtaken are left out. Within a band
/// (`same_band`) a bend that is too sharp for that is traced. False when the arc doesn't hold any more; then it has to be
/// traced anew.
bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, bool same_band, CarriedArc& carried);

}  // namespace lamella::span
