#pragma once

#include <vector>

#include "model/basis_table.h"
#include "model/bspline.h"
#include "model/evaluate.h"
#include "model/surface.h"

/// Points and first derivatives along one line u = const of a surface, many at once for quadrature.
namespace lamella {

/// For the analytic surfaces.
class AnalyticLine {
 public:
  explicit AnalyticLine(const Surface& surface) : surface_(surface) {}

  /// The places v that at_node() knows.
  void set_nodes(std::vector<double> nodes) { nodes_ = std::move(nodes); }
  void set_u(double u) { u_ = u; }
  [[nodiscard]] SurfacePoint at(double v) const { return evaluate(surface_, Vec2(u_, v)); }
  [[nodiscard]] SurfacePoint at_node(std::size_t i) const { return at(nodes_[i]); }

 private:
  const Surface& surface_;
  std::vector<double> nodes_;
  double u_ = 0.0;
};

/// For surfaces of revolution: the meridian is evaluated once per node, then only turned.
class RevolutionLine {
 public:
  explicit RevolutionLine(const Revolution& surface) : surface_(surface) {}

  void set_nodes(const std::vector<double>& nodes);
  void set_u(double u);
  [[nodiscard]] SurfacePoint at(double v) const { return turned(evaluate<3>(surface_.meridian, v)); }
  [[nodiscard]] SurfacePoint at_node(std::size_t i) const { return turned(nodes_[i]); }

 private:
  [[nodiscard]] SurfacePoint turned(const CurvePoint<3>& at) const;

  const Revolution& surface_;
  std::vector<CurvePoint<3>> nodes_;
  Mat3 rotation_ = Mat3::Identity();
};

/// For B-spline surfaces: the net is contracted to a curve once per u, and the B-splines in v are kept at the nodes, so
/// that a point costs one sum of degree_v + 1 terms.
class SplineLine {
 public:
  explicit SplineLine(const BSplineSurface& surface);

  void set_nodes(const std::vector<double>& nodes);
  void set_u(double u);
  [[nodiscard]] SurfacePoint at(double v) const;
  [[nodiscard]] SurfacePoint at_node(std::size_t i) const;

 private:
  [[nodiscard]] SurfacePoint combine(int first, const double* value, const double* slope) const;

  const BSplineSurface& surface_;
  BasisTable table_u_;
  BasisTable table_v_;
  std::vector<Vec4> net_;       ///< (w x, w y, w z, w), laid out as the poles
  std::vector<Vec4> column_;    ///< poles of the curve v -> S(u, v), homogeneous
  std::vector<Vec4> column_u_;  ///< of its derivative by u
  std::vector<int> first_;      ///< per node: first pole
  std::vector<double> basis_;   ///< per node: degree_v + 1 values, then as many slopes
};

/// The curve v -> S(at, v), or u -> S(u, at) if not `along_v`.
[[nodiscard]] BSplineCurve<3> iso_curve(const BSplineSurface& surface, bool along_v, double at);

/// Knots strictly within `range` where the surface is only continuous: u-knots if `along_v`, else v-knots.
[[nodiscard]] std::vector<double> crease_knots(const BSplineSurface& surface, bool along_v, Interval range);

}  // namespace lamella
