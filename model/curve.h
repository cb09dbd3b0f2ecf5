#pragma once

#include <variant>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// point(t) = origin + t * direction; `direction` need not have unit length.
template <int Dim>
struct Line {
  Vec<Dim> origin;
  Vec<Dim> direction;
};

/// point(t) = center + cos(t) * major + sin(t) * minor. A circle when the axes are orthogonal and equally long.
template <int Dim>
struct Ellipse {
  Vec<Dim> center;
  Vec<Dim> major;
  Vec<Dim> minor;
};

/// point(t) = apex + t^2 * axis + t * tangent.
template <int Dim>
struct Parabola {
  Vec<Dim> apex;
  Vec<Dim> axis;
  Vec<Dim> tangent;
};

/// point(t) = center + cosh(t) * major + sinh(t) * minor.
template <int Dim>
struct Hyperbola {
  Vec<Dim> center;
  Vec<Dim> major;
  Vec<Dim> minor;
};

/// A clamped, non-periodic, possibly rational B-spline curve.
/// `knots` is flat (multiplicities written out): knots.size() == poles.size() + degree + 1.
/// `weights` is empty for a polynomial curve, else positive and one per pole.
template <int Dim>
struct BSplineCurve {
  int degree = 1;
  std::vector<double> knots;
  std::vector<Vec<Dim>> poles;
  std::vector<double> weights;
};

template <int Dim>
using Curve = std::variant<Line<Dim>, Ellipse<Dim>, Parabola<Dim>, Hyperbola<Dim>, BSplineCurve<Dim>>;
using Curve2 = Curve<2>;
using Curve3 = Curve<3>;

}  // namespace lamella
