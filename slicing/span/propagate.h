#pragma once

#include <cstdint>
#include <vector>

#include "slicing/span/section_lanes.h"
#include "slicing/span/tracer.h"

namespace lamella::span {

/// How a point of a section moves when z rises, by divided differences over the last layers.
struct Motion {
  Vec2 velocity = Vec2::Zero();  ///< d(u, v) / dz
  Vec2 change = Vec2::Zero();    ///< its difference from the layer before, by z
  Vec2 bend = Vec2::Zero();      ///< the same of the change, over three layers
  int known = 0;                 ///< how many of the last two are known: the point may be a new one
};

/// An arc that is carried from layer to layer: its points and how they moved when z rose.
struct CarriedArc {
  TracedArc arc;
  double z = 0.0;
  std::vector<Motion> motions;  ///< one a point
  /// One a point: 0 or 1 where it keeps to a line u or v = const while z rises, because it lies on a knot or between
  /// points on two such knots, else -1. So what bends within a few knots keeps its points when it moves sideways.
  std::vector<std::int8_t> lines;
  std::vector<double> errors;  ///< one a piece, as measured, mm; infinite where it wasn't since start()
  double last_step = 0.0;      ///< of z, from the layer before; 0 if there was none
  double step_before = 0.0;    ///< and to that

  [[nodiscard]] bool empty() const { return arc.pieces.empty(); }
  /// Begins with an arc as traced at height z.
  void start(double height);
  /// How far an inner point moves while z rises by 1 mm, in lengths of the shorter piece beside it; the largest of all.
  [[nodiscard]] double speed() const;
};

/// A point of an arc while it is carried, and the piece to the next one.
struct CarriedPlace {
  std::uint32_t number = 0;  ///< of the point, its motion and its piece in CarryWork
  std::uint32_t uv = 0;      ///< the same of the piece in (u, v), if it doesn't fit
  Cell cell;                 ///< of the piece that begins here
  std::int8_t axis = -1;     ///< as in TracedArc
  std::int8_t line = -1;     ///< as in CarriedArc
  bool fixed = false;        ///< an end, or between two cells: can't be spared
  bool fits = false;
  bool dropped = false;
  int parts = 1;             ///< into which the piece is to be divided
  std::uint32_t traced = 0;  ///< what is to be put behind it: first and number in CarryWork::traced
  std::uint32_t traced_count = 0;
  double error = 0.0;  ///< mm; infinite where there is no such piece
};

/// Memory of carry(), kept from one call to the next.
struct CarryWork {
  std::vector<CarriedPlace> places;
  std::vector<CarriedPlace> mended;
  std::vector<CarriedPlace> traced;
  std::vector<SectionPoint> points;
  std::vector<Motion> motions;
  std::vector<ArcPiece> pieces;
  std::vector<ArcPiece> uv;
  std::vector<MovingPoint> moving;
};

/// Brings a carried arc to height z between the given ends: its points side by side by extrapolation and one
/// evaluation, to second order in what was left to correct; points on cell limits stay on them. The error of every
/// piece is measured as when tracing; pieces that are too long for it are divided, points that were overtaken are left
/// out. Within a band
/// (`same_band`) a bend that is too sharp for that is traced. False when the arc doesn't hold any more; then it has to
/// be traced anew.
bool carry(const SectionSurface& surface, double sign, const SectionPoint& begin, const SectionPoint& end, double z,
           const TraceLimits& limits, bool same_band, CarryWork& work, CarriedArc& carried);

}  // namespace lamella::span
