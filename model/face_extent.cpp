#include "model/face_extent.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "model/bezier.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/extremum_search.h"
#include "model/iso_line.h"

namespace lamella {

namespace {

/// Of the face's size: how exact the reach is to be.
constexpr double kAccuracy = 1e-9;

double size_of(const std::vector<BezierPatch>& patches) {
  Box3 box;
  for (const BezierPatch& patch : patches) box.extend(control_box(patch));
  return box.isEmpty() ? 0.0 : box.sizes().norm();
}

Vec3 meridian_point(const Revolution& revolution, double v) { return evaluate<3>(revolution.meridian, v).point; }

/// The unit vector from the axis in whose plane the whole meridian lies; none if the meridian isn't plane.
std::optional<Vec3> radial_direction(const Revolution& revolution, const Interval& range) {
  constexpr int kSamples = 16;
  std::vector<Vec3> radii;
  for (int i = 0; i <= kSamples; ++i) {
    const Vec3 way = meridian_point(revolution, range.lo + range.length() * i / kSamples) - revolution.axis_origin;
    radii.push_back(way - way.dot(revolution.axis_direction) * revolution.axis_direction);
  }
  const Vec3 longest = *std::max_element(
      radii.begin(), radii.end(), [](const Vec3& a, const Vec3& b) { return a.squaredNorm() < b.squaredNorm(); });
  const Vec3 direction = longest.normalized();
  for (const Vec3& r : radii) {
    if (!((r - r.dot(direction) * direction).norm() <= 1e-12 * longest.norm())) return std::nullopt;
  }
  return direction;
}

struct Crease {
  Curve3 curve;
  bool along_v;
  double knot;
};

/// Along knots of full multiplicity the surface may have a crease, with an extremum of no stationary point.
std::vector<Crease> find_creases(const BSplineSurface& surface, const Box2& bounds) {
  std::vector<Crease> creases;
  for (const bool along_v : {true, false}) {
    const Interval across =
        along_v ? Interval{bounds.min().x(), bounds.max().x()} : Interval{bounds.min().y(), bounds.max().y()};
    for (const double knot : crease_knots(surface, along_v, across)) {
      creases.push_back({iso_curve(surface, along_v, knot), along_v, knot});
    }
  }
  return creases;
}

const BSplineSurface* spline_of(const Surface& surface) {
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) return &fitted->fit;
  return std::get_if<BSplineSurface>(&surface);
}

}  // namespace

bool may_exceed_border(const Surface& surface) {
  return !(std::holds_alternative<Plane>(surface) || std::holds_alternative<Cylinder>(surface) ||
           std::holds_alternative<Cone>(surface) || std::holds_alternative<Extrusion>(surface));
}

struct FaceExtent::Parts {
  const Surface& surface;
  TrimRegion region;
  RationalForm form;
  bool has_form = false;   ///< to be searched
  bool is_beyond = false;  ///< of the stated limits: the border stands
  std::vector<Crease> creases;
  std::optional<Vec3> radial;
  ExtremumLimits limits;

  Parts(const Scene& scene, FaceId id) : surface(scene.faces[id].surface), region(scene, id) {
    if (!may_exceed_border(surface) || region.bounds().isEmpty()) return;
    if (const auto* revolution = std::get_if<Revolution>(&surface)) {
      radial = radial_direction(*revolution, range_v());
      if (radial) return;
    }
    const BSplineSurface* spline = spline_of(surface);
    if (spline == nullptr && !std::holds_alternative<Revolution>(surface)) return;
    if (spline != nullptr) creases = find_creases(*spline, region.bounds());
    try {
      form = rational_form(surface, region.bounds());
      has_form = true;
    } catch (const GeometryError&) {
      is_beyond = true;
    }
    set_limits(scene, scene.faces[id]);
  }

  void set_limits(const Scene& scene, const Face& face) {
    Box3 border;
    for (const LoopId loop : face.loops) {
      for (const HalfEdgeId use : scene.loops[loop].half_edges) {
        const Edge& edge = scene.edges[scene.half_edges[use].edge];
        limits.border_accuracy = std::max(limits.border_accuracy, edge.tolerance);
        if (edge.degenerate) {
          border.extend(scene.vertices[edge.start].point);
        } else {
          border.extend(exact_bounds(edge.curve, edge.range));
        }
      }
    }
    limits.accuracy = kAccuracy * std::max(size_of(form.patches), border.isEmpty() ? 0.0 : border.sizes().norm());
  }

  [[nodiscard]] Interval range_u() const { return {region.bounds().min().x(), region.bounds().max().x()}; }
  [[nodiscard]] Interval range_v() const { return {region.bounds().min().y(), region.bounds().max().y()}; }

  void try_point(const Vec2& uv, const Vec3& direction, Reach& best) const {
    const Vec3 point = evaluate_point(surface, uv);
    const double value = direction.dot(point);
    if (value > best.value && region.classify(uv) != TrimRegion::Side::outside) best.raise(value, point);
  }

  void raise(const Sphere& sphere, const Vec3& direction, Reach& best) const {
    const Frame& frame = sphere.frame;
    const Vec3 n(direction.dot(frame.x), direction.dot(frame.y), direction.dot(frame.z));
    try_point({std::atan2(n.y(), n.x()), std::asin(std::clamp(n.z(), -1.0, 1.0))}, direction, best);
  }

  void raise(const Torus& torus, const Vec3& direction, Reach& best) const {
    const Frame& frame = torus.frame;
    const Vec3 d(direction.dot(frame.x), direction.dot(frame.y), direction.dot(frame.z));
    const double across = std::hypot(d.x(), d.y());
    const double u = std::atan2(d.y(), d.x());
    // Along the axis the extrema are rings; one that stays off the border is inside at any u, so at this one.
    for (const double sign : {1.0, -1.0}) {
      const double v = std::atan2(d.z(), sign * across);
      const double turn = sign > 0.0 ? 0.0 : kPi;
      try_point({u + turn, v}, direction, best);
      try_point({u + turn, v + kPi}, direction, best);
    }
  }

  /// Where d . S is extremal in u the meridian has been turned into the plane of d and the axis; there d . S is a
  /// linear function of the meridian's plane, whose extrema along it are those of a curve.
  void raise(const Revolution& revolution, const Vec3& direction, Reach& best) const {
    if (!radial) return search(direction, best);
    const Vec3& a = revolution.axis_direction;
    const Vec3 across = direction - direction.dot(a) * a;
    const double u = std::atan2(a.cross(*radial).dot(across), radial->dot(across));
    for (const double sign : {1.0, -1.0}) {
      const Vec3 in_plane = direction.dot(a) * a + sign * across.norm() * *radial;
      for (const double v : critical_parameters(revolution.meridian, range_v(), in_plane)) {
        try_point({sign > 0.0 ? u : u + kPi, v}, direction, best);
      }
    }
  }

  void raise(const BSplineSurface&, const Vec3& direction, Reach& best) const {
    for (const Crease& crease : creases) {
      const Interval known{-std::numeric_limits<double>::infinity(), best.value};
      for (const double t :
           critical_parameters(crease.curve, crease.along_v ? range_v() : range_u(), direction, &known))
        try_point(crease.along_v ? Vec2(crease.knot, t) : Vec2(t, crease.knot), direction, best);
    }
    search(direction, best);
  }

  void search(const Vec3& direction, Reach& best) const {
    if (is_beyond) best.converged = false;
    if (!has_form) return;
    const Extremum found = find_maximum(form, region, direction, best.value, limits);
    if (found.st) best.raise(found.value, evaluate_point(surface, form.to_surface(*found.st)));
    best.converged = best.converged && found.converged;
  }
};

FaceExtent::FaceExtent(const Scene& scene, FaceId face) : parts_(std::make_shared<Parts>(scene, face)) {}

void FaceExtent::raise(const Vec3& direction, Reach& best) const {
  if (parts_->region.bounds().isEmpty()) return;
  std::visit(
      [&](const auto& surface) {
        if constexpr (requires { parts_->raise(surface, direction, best); }) {
          parts_->raise(surface, direction, best);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(surface)>, FittedSurface>) {
          parts_->raise(surface.fit, direction, best);
        }
      },
      parts_->surface);
}

}  // namespace lamella
