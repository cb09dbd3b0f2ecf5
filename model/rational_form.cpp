#include "model/rational_form.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "model/bspline.h"
#include "model/rational_curve.h"

namespace lamella {
namespace {

using Map = RationalForm::Map;

Interval along(const Box2& box, int axis) { return {box.min()[axis], box.max()[axis]}; }

BezierPatch empty_patch(int degree_u, int degree_v, Interval u, Interval v) {
  return {degree_u, degree_v, u, v, std::vector<Vec4>(static_cast<std::size_t>(degree_u + 1) * (degree_v + 1))};
}

/// Bounds the nets of surfaces that wind in both directions.
constexpr std::size_t kMaxPatches = 1 << 18;

void check_count(std::size_t count_u, std::size_t count_v) {
  if (count_u * count_v <= kMaxPatches) return;
  throw GeometryError("a surface over so large a parameter range that it would need " +
                      std::to_string(count_u * count_v) + " Bezier nets");
}

/// Sweeps a rational profile along arcs in u: `point(arc, k, profile point)` is linear in the profile point, so that
/// weights multiply.
template <int Dim, class Point>
RationalForm revolve(const RationalCurve<Dim>& profile, Interval u, Point point) {
  RationalForm form;
  form.map_u = Map::angle;
  form.breaks_u = even_breaks(u, 0.5 * kPi);
  form.map_v = profile.map;
  form.breaks_v = profile.breaks;
  check_count(form.breaks_u.size(), profile.pieces.size());
  for (std::size_t i = 1; i < form.breaks_u.size(); ++i) {
    const UnitArc arc = unit_arc(form.breaks_u[i - 1], form.breaks_u[i]);
    for (const RationalPiece<Dim>& piece : profile.pieces) {
      const int degree = static_cast<int>(piece.net.size()) - 1;
      BezierPatch patch = empty_patch(2, degree, {static_cast<double>(i - 1), static_cast<double>(i)}, piece.s);
      for (int k = 0; k < 3; ++k) {
        for (int j = 0; j <= degree; ++j) patch.net[k * (degree + 1) + j] = point(arc, k, piece.net[j]);
      }
      form.patches.push_back(std::move(patch));
    }
  }
  return form;
}

/// The meridian (radius, height) of a surface of a frame turned about the frame's Z.
RationalForm revolve(const Frame& frame, const Curve2& meridian, const Box2& box) {
  const auto point = [&](const UnitArc& arc, int k, const Vec3& p) -> Vec4 {
    Vec4 result;
    const double weight = arc.weight[k] * p[2];
    const Vec3 radial = p[0] * (arc.cosine[k] * frame.x + arc.sine[k] * frame.y);
    result << weight * frame.origin + radial + (arc.weight[k] * p[1]) * frame.z, weight;
    return result;
  };
  return revolve(rational_curve(meridian, along(box, 1)), along(box, 0), point);
}

RationalForm convert(const Plane& plane, const Box2& box) {
  const Interval u = along(box, 0);
  const Interval v = along(box, 1);
  RationalForm form;
  BezierPatch patch = empty_patch(1, 1, u, v);
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const Vec3 point =
          plane.frame.origin + (i == 0 ? u.lo : u.hi) * plane.frame.x + (j == 0 ? v.lo : v.hi) * plane.frame.y;
      patch.net[2 * i + j] << point, 1.0;
    }
  }
  form.patches.push_back(std::move(patch));
  return form;
}

RationalForm convert(const Cylinder& cylinder, const Box2& box) {
  return revolve(cylinder.frame, Line<2>{{cylinder.radius, 0.0}, {0.0, 1.0}}, box);
}

RationalForm convert(const Cone& cone, const Box2& box) {
  const Vec2 slope{std::sin(cone.half_angle), std::cos(cone.half_angle)};
  return revolve(cone.frame, Line<2>{{cone.radius, 0.0}, slope}, box);
}

RationalForm convert(const Sphere& sphere, const Box2& box) {
  // Beyond the poles the sphere would be covered twice.
  Box2 once = box;
  once.min()[1] = std::max(once.min()[1], -0.5 * kPi);
  once.max()[1] = std::min(once.max()[1], 0.5 * kPi);
  const double r = sphere.radius;
  return revolve(sphere.frame, Ellipse<2>{{0.0, 0.0}, {r, 0.0}, {0.0, r}}, once);
}

RationalForm convert(const Torus& torus, const Box2& box) {
  const double r = torus.minor_radius;
  return revolve(torus.frame, Ellipse<2>{{torus.major_radius, 0.0}, {r, 0.0}, {0.0, r}}, box);
}

RationalForm convert(const Extrusion& extrusion, const Box2& box) {
  const RationalCurve<3> basis = rational_curve(extrusion.basis, along(box, 0));
  const Interval v = along(box, 1);
  RationalForm form;
  form.map_u = basis.map;
  form.breaks_u = basis.breaks;
  for (const RationalPiece<3>& piece : basis.pieces) {
    const int degree = static_cast<int>(piece.net.size()) - 1;
    BezierPatch patch = empty_patch(degree, 1, piece.s, v);
    for (int i = 0; i <= degree; ++i) {
      const Vec4& p = piece.net[i];
      patch.net[2 * i] << p.head<3>() + (p[3] * v.lo) * extrusion.direction, p[3];
      patch.net[2 * i + 1] << p.head<3>() + (p[3] * v.hi) * extrusion.direction, p[3];
    }
    form.patches.push_back(std::move(patch));
  }
  return form;
}

RationalForm convert(const Revolution& revolution, const Box2& box) {
  const Vec3& origin = revolution.axis_origin;
  const Vec3& axis = revolution.axis_direction;
  const auto point = [&](const UnitArc& arc, int k, const Vec4& p) -> Vec4 {
    const Vec3 arm = p.head<3>() - p[3] * origin;
    const Vec3 lift = axis.dot(arm) * axis;
    const Vec3 turned = arc.cosine[k] * (arm - lift) + arc.sine[k] * axis.cross(arm);
    Vec4 result;
    result << arc.weight[k] * (p[3] * origin + lift) + turned, arc.weight[k] * p[3];
    return result;
  };
  return revolve(rational_curve(revolution.meridian, along(box, 1)), along(box, 0), point);
}

RationalForm convert(const BSplineSurface& surface, const Box2& box) {
  RationalForm form;
  const Interval u = along(box, 0);
  const Interval v = along(box, 1);
  for (BezierPatch& patch : split_to_bezier(surface)) {
    const bool apart = patch.u.hi <= u.lo || patch.u.lo >= u.hi || patch.v.hi <= v.lo || patch.v.lo >= v.hi;
    if (!apart) form.patches.push_back(restrict_to(patch, u, v));
  }
  return form;
}

RationalForm convert(const FittedSurface& surface, const Box2& box) { return convert(surface.fit, box); }

/// Boxes of unbounded surfaces stay below this, in mm or radians; more is a placeholder for infinity.
constexpr double kMaxCoordinate = 1e10;

void check_box(const Box2& box) {
  const bool finite = box.min().cwiseAbs().maxCoeff() <= kMaxCoordinate &&  //
                      box.max().cwiseAbs().maxCoeff() <= kMaxCoordinate;
  if (box.min().allFinite() && box.max().allFinite() && finite) return;
  throw GeometryError("a surface over infinite or huge parameter bounds", {}, "trim the face to its finite part");
}

}  // namespace

Vec2 RationalForm::to_surface(const Vec2& st) const {
  return {parameter_at(map_u, breaks_u, st[0]), parameter_at(map_v, breaks_v, st[1])};
}

Vec2 RationalForm::from_surface(const Vec2& uv) const {
  return {net_parameter_at(map_u, breaks_u, uv[0]), net_parameter_at(map_v, breaks_v, uv[1])};
}

RationalForm rational_form(const Surface& surface, const Box2& uv_bounds) {
  if (uv_bounds.isEmpty()) return {};
  check_box(uv_bounds);
  if (!((uv_bounds.sizes().array() > 0.0).all())) return {};
  RationalForm form = std::visit([&](const auto& shape) { return convert(shape, uv_bounds); }, surface);
  for (const BezierPatch& patch : form.patches) {
    const auto finite = [](const Vec4& point) { return point.allFinite(); };
    if (!std::all_of(patch.net.begin(), patch.net.end(), finite)) {
      throw GeometryError(std::string(surface_type_name(surface)) + " whose coordinates are not finite numbers");
    }
  }
  return form;
}

std::vector<BezierCurve2> rational_pieces(const Curve2& curve, Interval range) {
  const bool backwards = range.lo > range.hi;
  if (backwards) std::swap(range.lo, range.hi);
  std::vector<BezierCurve2> result;
  for (RationalPiece<2>& piece : rational_curve(curve, range).pieces) result.push_back({piece.t, std::move(piece.net)});
  if (backwards) {
    std::reverse(result.begin(), result.end());
    for (BezierCurve2& piece : result) piece = reversed(std::move(piece));
  }
  return result;
}

}  // namespace lamella
