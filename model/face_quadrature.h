#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry.h"
#include "core/ids.h"
#include "model/bezier.h"
#include "model/scene.h"

namespace lamella {

/// Integrals over one trimmed face. Lengths in mm.
struct FaceIntegrals {
  double flux = 0.0;                    ///< of (r - reference) / 3 through the face along its outward normal, mm^3
  double area = 0.0;                    ///< mm^2
  Vec3 abs_normal_area = Vec3::Zero();  ///< of |n_x|, |n_y|, |n_z|, mm^2

  [[nodiscard]] bool is_finite() const;
};

/// How fine a quadrature is along the border and across the face. Level 0 takes three fifths of the nodes of level 1,
/// level -1 two fifths; every level above 1 halves the panels. The difference of two levels estimates the error of the
/// lower one.
struct QuadratureLevel {
  int outer = 1;
  int inner = 1;
};

/// Quadrature over the trimmed (u, v) region D of a face by Green's theorem,
///   integral of F over D = - contour integral of H du over the border, H(u, v) = integral of F(u, s) ds from v0 to v,
/// both by composite Gauss-Legendre rules whose panels end at the surface's knots; the border's pieces also end where
/// they cross a knot line. See docs/methods/measure.md.
class FaceQuadrature {
 public:
  /// Throws GeometryError as TrimRegion does. The scene must outlive the object.
  FaceQuadrature(const Scene& scene, FaceId face);

  /// Area of the region in (u, v); positive unless the loops contradict the face's orientation.
  [[nodiscard]] double parameter_area() const;
  [[nodiscard]] FaceIntegrals integrate(const Vec3& reference, QuadratureLevel level) const;
  /// Solid angle of the face seen from `point`, positive where its back is seen (from inside a solid).
  [[nodiscard]] double solid_angle(const Vec3& point, QuadratureLevel level) const;
  /// Number of surface evaluations integrate() takes at this level.
  [[nodiscard]] double cost(QuadratureLevel level) const;
  /// False where level 0 is exact across the face already.
  [[nodiscard]] bool has_inner_levels() const;

 private:
  /// Part of a border piece within which the integrand is smooth.
  struct Strip {
    std::size_t piece;
    Interval s;  ///< in the piece's own [0, 1]
  };

  void set_nodes();
  void set_spline(const BSplineSurface& surface);
  void set_knots(int axis, const std::vector<double>* knots);
  void set_panels();
  void split_border();
  [[nodiscard]] std::vector<double> crossings(const BezierCurve2& piece) const;
  void add_strips(std::size_t piece, const std::vector<double>& cuts);

  template <class Sums, class Integrand>
  [[nodiscard]] Sums integrate(QuadratureLevel level, int min_nodes, const Integrand& integrand) const;
  template <class Sums, class Inner>
  [[nodiscard]] Sums integrate_border(Inner& inner, int level, int outer_nodes) const;

  const Face& face_;
  std::vector<BezierCurve2> border_;
  Box2 bounds_;
  std::vector<Strip> strips_;
  std::vector<double> knots_u_;  ///< lines across which the surface isn't smooth
  std::vector<double> knots_v_;
  std::vector<double> panels_v_;  ///< ends of the inner panels, the first one v0
  Vec2 step_ = Vec2::Zero();      ///< longest panel in u and v where a coordinate is an angle or exponential, else 0
  int inner_nodes_ = 1;
  int outer_nodes_ = 1;
};

}  // namespace lamella
