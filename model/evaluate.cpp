#include "model/evaluate.h"

#include <cmath>
#include <type_traits>

#include "model/bspline.h"

namespace lamella {
namespace {

/// Homogeneous sums of poles relative to a local origin, so that parts far from the origin keep their accuracy.
template <int Dim>
struct Sum {
  Vec<Dim> numerator = Vec<Dim>::Zero();
  double weight = 0.0;

  void add(double factor, const Vec<Dim>& pole, double pole_weight) {
    numerator += (factor * pole_weight) * pole;
    weight += factor * pole_weight;
  }
};

template <int Dim>
CurvePoint2<Dim> at(const Line<Dim>& line, double t) {
  return {{line.origin + t * line.direction, line.direction}, Vec<Dim>::Zero()};
}

template <int Dim>
CurvePoint2<Dim> at(const Ellipse<Dim>& ellipse, double t) {
  const double c = std::cos(t);
  const double s = std::sin(t);
  const Vec<Dim> arm = c * ellipse.major + s * ellipse.minor;
  return {{ellipse.center + arm, c * ellipse.minor - s * ellipse.major}, -arm};
}

template <int Dim>
CurvePoint2<Dim> at(const Parabola<Dim>& parabola, double t) {
  return {{parabola.apex + t * (t * parabola.axis + parabola.tangent), 2.0 * t * parabola.axis + parabola.tangent},
          2.0 * parabola.axis};
}

template <int Dim>
CurvePoint2<Dim> at(const Hyperbola<Dim>& hyperbola, double t) {
  const double c = std::cosh(t);
  const double s = std::sinh(t);
  const Vec<Dim> arm = c * hyperbola.major + s * hyperbola.minor;
  return {{hyperbola.center + arm, s * hyperbola.major + c * hyperbola.minor}, arm};
}

template <int Dim>
CurvePoint2<Dim> at(const BSplineCurve<Dim>& curve, double t) {
  const Basis basis = evaluate_basis(curve.knots, curve.degree, t, 2);
  const Vec<Dim> origin = curve.poles[basis.first];
  std::array<Sum<Dim>, 3> sums;
  for (int order = 0; order <= 2; ++order) {
    for (int i = 0; i <= curve.degree; ++i) {
      const int index = basis.first + i;
      const double weight = curve.weights.empty() ? 1.0 : curve.weights[index];
      sums[order].add(basis.derivative[order][i], curve.poles[index] - origin, weight);
    }
  }
  if (curve.weights.empty()) return {{origin + sums[0].numerator, sums[1].numerator}, sums[2].numerator};
  // Derivatives of the quotient by Leibniz' rule on numerator = weight * point.
  const double w = sums[0].weight;
  const Vec<Dim> point = sums[0].numerator / w;
  const Vec<Dim> dt = (sums[1].numerator - sums[1].weight * point) / w;
  const Vec<Dim> dtt = (sums[2].numerator - 2.0 * sums[1].weight * dt - sums[2].weight * point) / w;
  return {{origin + point, dt}, dtt};
}

/// O + radius(v) (cos u X + sin u Y) + height(v) Z, the common form of the surfaces of a frame and a meridian.
struct Meridian {
  Vec3 value;  ///< radius, its first and second derivative
  Vec3 height;
};

SurfacePoint2 turn(const Frame& frame, double u, const Meridian& meridian) {
  const Vec3 outward = std::cos(u) * frame.x + std::sin(u) * frame.y;
  const Vec3 onward = std::cos(u) * frame.y - std::sin(u) * frame.x;
  const Vec3& r = meridian.value;
  const Vec3& h = meridian.height;
  SurfacePoint2 result;
  result.point = frame.origin + r[0] * outward + h[0] * frame.z;
  result.du = r[0] * onward;
  result.dv = r[1] * outward + h[1] * frame.z;
  result.duu = -r[0] * outward;
  result.duv = r[1] * onward;
  result.dvv = r[2] * outward + h[2] * frame.z;
  return result;
}

SurfacePoint2 at(const Plane& plane, const Vec2& uv) {
  const Frame& f = plane.frame;
  return {{f.origin + uv[0] * f.x + uv[1] * f.y, f.x, f.y}, Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
}

SurfacePoint2 at(const Cylinder& cylinder, const Vec2& uv) {
  return turn(cylinder.frame, uv[0], {{cylinder.radius, 0.0, 0.0}, {uv[1], 1.0, 0.0}});
}

SurfacePoint2 at(const Cone& cone, const Vec2& uv) {
  const double s = std::sin(cone.half_angle);
  const double c = std::cos(cone.half_angle);
  return turn(cone.frame, uv[0], {{cone.radius + uv[1] * s, s, 0.0}, {uv[1] * c, c, 0.0}});
}

SurfacePoint2 at(const Sphere& sphere, const Vec2& uv) {
  const double c = sphere.radius * std::cos(uv[1]);
  const double s = sphere.radius * std::sin(uv[1]);
  return turn(sphere.frame, uv[0], {{c, -s, -c}, {s, c, -s}});
}

SurfacePoint2 at(const Torus& torus, const Vec2& uv) {
  const double c = torus.minor_radius * std::cos(uv[1]);
  const double s = torus.minor_radius * std::sin(uv[1]);
  return turn(torus.frame, uv[0], {{torus.major_radius + c, -s, -c}, {s, c, -s}});
}

SurfacePoint2 at(const Extrusion& extrusion, const Vec2& uv) {
  return extrude(evaluate2(extrusion.basis, uv[0]), extrusion.direction, uv[1]);
}

SurfacePoint2 at(const Revolution& revolution, const Vec2& uv) {
  return revolve(evaluate2(revolution.meridian, uv[1]), revolution, uv[0]);
}

/// Which derivative by u and by v each of the six sums of a surface evaluation holds.
constexpr int kOrders[6][2] = {{0, 0}, {1, 0}, {0, 1}, {2, 0}, {1, 1}, {0, 2}};

SurfacePoint2 divide(const std::array<Sum<3>, 6>& sums, const Vec3& origin) {
  const double w = sums[0].weight;
  const double wu = sums[1].weight;
  const double wv = sums[2].weight;
  const Vec3 point = sums[0].numerator / w;
  SurfacePoint2 result;
  result.point = origin + point;
  result.du = (sums[1].numerator - wu * point) / w;
  result.dv = (sums[2].numerator - wv * point) / w;
  result.duu = (sums[3].numerator - 2.0 * wu * result.du - sums[3].weight * point) / w;
  result.duv = (sums[4].numerator - wu * result.dv - wv * result.du - sums[4].weight * point) / w;
  result.dvv = (sums[5].numerator - 2.0 * wv * result.dv - sums[5].weight * point) / w;
  return result;
}

/// Tensor-product evaluation: along v first, then along u. Derivatives above `order` are zero.
SurfacePoint2 at(const BSplineSurface& surface, const Vec2& uv, int order) {
  const Basis bu = evaluate_basis(surface.knots_u, surface.degree_u, uv[0], order);
  const Basis bv = evaluate_basis(surface.knots_v, surface.degree_v, uv[1], order);
  const auto index_of = [&](int i, int j) { return (bu.first + i) * surface.count_v + bv.first + j; };
  const bool rational = !surface.weights.empty();
  const Vec3 origin = surface.poles[index_of(0, 0)];
  std::array<Sum<3>, 6> sums;
  for (int i = 0; i <= surface.degree_u; ++i) {
    std::array<Sum<3>, 3> rows;
    for (int j = 0; j <= surface.degree_v; ++j) {
      const int index = index_of(i, j);
      const Vec3 pole = surface.poles[index] - origin;
      const double weight = rational ? surface.weights[index] : 1.0;
      for (int b = 0; b <= order; ++b) rows[b].add(bv.derivative[b][j], pole, weight);
    }
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = kOrders[k];
      if (a + b > order) break;
      sums[k].numerator += bu.derivative[a][i] * rows[b].numerator;
      sums[k].weight += bu.derivative[a][i] * rows[b].weight;
    }
  }
  if (rational) return divide(sums, origin);
  return {{origin + sums[0].numerator, sums[1].numerator, sums[2].numerator},
          sums[3].numerator,
          sums[4].numerator,
          sums[5].numerator};
}

SurfacePoint2 evaluate_order(const Surface& surface, const Vec2& uv, int order) {
  return std::visit(
      [&](const auto& shape) -> SurfacePoint2 {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, BSplineSurface>) {
          return at(shape, uv, order);
        } else if constexpr (std::is_same_v<Shape, FittedSurface>) {
          return at(shape.fit, uv, order);
        } else {
          return at(shape, uv);
        }
      },
      surface);
}

double period(const Curve3& curve) { return std::holds_alternative<Ellipse<3>>(curve) ? kTwoPi : 0.0; }

}  // namespace

SurfacePoint2 extrude(const CurvePoint2<3>& base, const Vec3& direction, double v) {
  return {{base.point + v * direction, base.dt, direction}, base.dtt, Vec3::Zero(), Vec3::Zero()};
}

SurfacePoint2 revolve(const CurvePoint2<3>& base, const Revolution& revolution, double u) {
  const Vec3& axis = revolution.axis_direction;
  const double c = std::cos(u);
  const double s = std::sin(u);
  // Rodrigues' rotation, its two arms kept apart for the derivatives by the angle.
  const auto across = [&](const Vec3& p) -> Vec3 { return p - axis.dot(p) * axis; };
  const auto rotated = [&](const Vec3& p) -> Vec3 { return axis.dot(p) * axis + c * across(p) + s * axis.cross(p); };
  const auto onward = [&](const Vec3& p) -> Vec3 { return c * axis.cross(p) - s * across(p); };
  const Vec3 arm = base.point - revolution.axis_origin;
  SurfacePoint2 result;
  result.point = revolution.axis_origin + rotated(arm);
  result.du = onward(arm);
  result.dv = rotated(base.dt);
  result.duu = -(c * across(arm) + s * axis.cross(arm));
  result.duv = onward(base.dt);
  result.dvv = rotated(base.dtt);
  return result;
}

Vec3 evaluate_point(const Surface& surface, const Vec2& uv) { return evaluate_order(surface, uv, 0).point; }

SurfacePoint evaluate(const Surface& surface, const Vec2& uv) { return evaluate_order(surface, uv, 1); }

SurfacePoint2 evaluate2(const Surface& surface, const Vec2& uv) { return evaluate_order(surface, uv, 2); }

template <int Dim>
CurvePoint2<Dim> evaluate2(const Curve<Dim>& curve, double t) {
  return std::visit([&](const auto& shape) { return at(shape, t); }, curve);
}

template <int Dim>
CurvePoint<Dim> evaluate(const Curve<Dim>& curve, double t) {
  return evaluate2<Dim>(curve, t);
}

template CurvePoint<2> evaluate<2>(const Curve<2>&, double);
template CurvePoint<3> evaluate<3>(const Curve<3>&, double);
template CurvePoint2<2> evaluate2<2>(const Curve<2>&, double);
template CurvePoint2<3> evaluate2<3>(const Curve<3>&, double);

Vec2 periods(const Surface& surface) {
  return std::visit(
      [](const auto& shape) -> Vec2 {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, Torus>) return {kTwoPi, kTwoPi};
        if constexpr (std::is_same_v<Shape, Extrusion>) return {period(shape.basis), 0.0};
        if constexpr (std::is_same_v<Shape, Revolution>) return {kTwoPi, period(shape.meridian)};
        constexpr bool kTurns =
            std::is_same_v<Shape, Cylinder> || std::is_same_v<Shape, Cone> || std::is_same_v<Shape, Sphere>;
        return {kTurns ? kTwoPi : 0.0, 0.0};
      },
      surface);
}

}  // namespace lamella
