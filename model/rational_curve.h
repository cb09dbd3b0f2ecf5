#pragma once

#include <array>
#include <vector>

#include "model/bezier.h"
#include "model/curve.h"
#include "model/rational_form.h"

namespace lamella {

/// One rational Bezier piece of a curve; net[i] = (w x, ..., w), all w > 0.
template <int Dim>
struct RationalPiece {
  Interval s;  ///< in the parameter of the nets
  Interval t;  ///< in the curve's own parameter
  std::vector<Vec<Dim + 1>> net;
};

/// A curve over a range as rational Bezier pieces, and how their parameter maps to the curve's own.
template <int Dim>
struct RationalCurve {
  std::vector<RationalPiece<Dim>> pieces;
  RationalForm::Map map = RationalForm::Map::same;
  std::vector<double> breaks;  ///< curve parameters at the integer s; empty for Map::same
};

/// Converts exactly; ellipses in arcs of at most 90 degrees, hyperbolas in pieces of at most unit parameter length.
/// The range is clamped to a B-spline's domain; an empty range or one of no length gives no pieces.
/// Throws GeometryError for ranges that are not finite or would need more than kMaxPieces.
template <int Dim>
[[nodiscard]] RationalCurve<Dim> rational_curve(const Curve<Dim>& curve, Interval range);

extern template RationalCurve<2> rational_curve<2>(const Curve2&, Interval);
extern template RationalCurve<3> rational_curve<3>(const Curve3&, Interval);

/// Pieces of one curve, or of one direction of an analytic surface, at most: helical faces turn many times.
inline constexpr int kMaxPieces = 4096;

/// Parameters that cut `range` into equal pieces no longer than `longest`; none if it has no length.
[[nodiscard]] std::vector<double> even_breaks(Interval range, double longest);

/// One arc of the unit circle as a rational quadratic: cosine and sine parts (homogeneous) and weights of its net.
struct UnitArc {
  std::array<double, 3> cosine;
  std::array<double, 3> sine;
  std::array<double, 3> weight;
};
[[nodiscard]] UnitArc unit_arc(double begin, double end);
/// The same for cosh and sinh.
[[nodiscard]] UnitArc unit_hyperbola_arc(double begin, double end);

/// Surface or curve parameter at net parameter `s`, and back; both monotone.
[[nodiscard]] double parameter_at(RationalForm::Map map, const std::vector<double>& breaks, double s);
[[nodiscard]] double net_parameter_at(RationalForm::Map map, const std::vector<double>& breaks, double t);

}  // namespace lamella
