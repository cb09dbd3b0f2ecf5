#pragma once

#include <array>
#include <functional>
#include <vector>

/// B-splines and quadrature of the generator's own, so that the manifest's volumes don't rest on OpenCASCADE.
namespace lamella::datasets {

using Point = std::array<double, 3>;

/// Greville abscissae of a knot vector: poles placed there make the spline's parameter equal to that coordinate.
[[nodiscard]] std::vector<double> greville(const std::vector<double>& knots, int degree);

/// Clamped knot vector with the given distinct breaks, inner ones of multiplicity 1.
[[nodiscard]] std::vector<double> clamped_knots(const std::vector<double>& breaks, int degree);

/// Uniform knots -degree .. count+degree of a closed spline of `count` poles; its period is [0, count].
[[nodiscard]] std::vector<double> periodic_knots(int count, int degree);

/// Rational curve in 3D; `poles` of a closed one are repeated at the end so that evaluation needs no special case.
struct SplineCurve {
  int degree = 3;
  std::vector<double> knots;  ///< flat, size poles + degree + 1
  std::vector<Point> poles;
  std::vector<double> weights;  ///< empty: all 1

  struct Frame {
    Point point, slope;
  };
  [[nodiscard]] Frame frame(double t) const;
  [[nodiscard]] Point point(double t) const { return frame(t).point; }
  [[nodiscard]] std::vector<double> breaks() const;  ///< distinct knots within the valid range
};

/// The same in two parameters; pole (i, j) is `poles[i * count_v + j]`.
struct SplineSurface {
  int degree_u = 3, degree_v = 3;
  std::vector<double> knots_u, knots_v;
  int count_v = 0;
  std::vector<Point> poles;
  std::vector<double> weights;

  struct Frame {
    Point point, du, dv;
  };
  [[nodiscard]] Frame frame(double u, double v) const;
  [[nodiscard]] std::vector<double> breaks_u() const;
  [[nodiscard]] std::vector<double> breaks_v() const;
};

/// Closed curve through the plane of the given poles (not repeated), uniform and of continuity degree - 1.
[[nodiscard]] SplineCurve closed_spline(const std::vector<Point>& poles, int degree = 3);

/// y = f(x) as a spline whose parameter is x: breaks in x, one value per pole.
[[nodiscard]] SplineCurve graph_spline(const std::vector<double>& breaks, const std::vector<double>& values,
                                       int degree = 3);

/// Integral over [a, b] by Gauss-Legendre with 12 points: exact for polynomials of degree 23.
[[nodiscard]] double integrate(double a, double b, const std::function<double(double)>& f);

/// The same, summed over consecutive intervals of `breaks`, each cut in `parts`.
[[nodiscard]] double integrate(const std::vector<double>& breaks, const std::function<double(double)>& f,
                               int parts = 1);

/// pi * integral of y^2 dx of a profile given as a graph (x is the parameter), between two values of x.
[[nodiscard]] double revolved_volume(const SplineCurve& profile, double from, double to);

/// Flux of (0, y, 0) through the surface, per span with 12 x 12 points: the volume enclosed if the rest of the
/// boundary has no y in its normal. Exact for polynomial patches of degree <= 7.
[[nodiscard]] double y_flux(const SplineSurface& surface, int parts = 1);

/// Flux of (x, y, z) / 3; summed over a closed boundary it is the volume.
[[nodiscard]] double radial_flux(const SplineSurface& surface, int parts = 1);

}  // namespace lamella::datasets
