#pragma once

#include <vector>

#include "core/geometry.h"
#include "model/curve.h"
#include "slicing/span/bezier_nets.h"

namespace lamella::span {

/// A part of a curve along which z runs from z0 to z1 without turning back; t0 and t1 are parameters of the curve.
struct MonotonePiece {
  double t0 = 0.0;
  double t1 = 0.0;
  double z0 = 0.0;  ///< stored heights decide crossings: neighbours share them bit for bit
  double z1 = 0.0;

  /// The half-open rule that every crossing in the engine follows.
  [[nodiscard]] bool crosses(double z) const { return (z0 <= z) != (z1 <= z); }
  [[nodiscard]] bool rises() const { return z0 < z1; }
};

/// Splits a curve at its extrema in z. `z_begin` and `z_end` are the stored heights of its ends (of the shared
/// vertices), which may differ from the curve's own by the file's tolerance. Extrema of a prominence below 1e-9 mm are
/// left out. A curve in one horizontal plane gives one piece that never crosses.
[[nodiscard]] std::vector<MonotonePiece> monotone_pieces(const Curve3& curve, Interval range, double z_begin,
                                                         double z_end);

/// Where a curve crosses a height.
struct Crossing {
  double t = 0.0;
  CurvePoint<3> at;
};

/// Where the curve reaches height z on a piece that crosses it; `guess` is the parameter to begin with, anything when
/// unknown. Where the stored heights leave the curve's own, the nearer end of the piece.
[[nodiscard]] Crossing find_crossing(const SectionCurve<3>& curve, const MonotonePiece& piece, double z, double guess);

}  // namespace lamella::span
