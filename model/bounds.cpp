#include "model/bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "model/bezier.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/extremum_search.h"
#include "model/iso_line.h"
#include "model/measure.h"
#include "model/rational_form.h"
#include "model/trim.h"

namespace lamella {

namespace {

/// Of the face's size: how exact the bounds are to be.
constexpr double kAccuracy = 1e-9;

struct Border {
  Box3 box;
  double tolerance = 0.0;
};

Border border_of(const Scene& scene, const Face& face) {
  Border border;
  for (const LoopId loop : face.loops) {
    for (const HalfEdgeId id : scene.loops[loop].half_edges) {
      const Edge& edge = scene.edges[scene.half_edges[id].edge];
      border.tolerance = std::max(border.tolerance, edge.tolerance);
      if (edge.degenerate) {
        border.box.extend(scene.vertices[edge.start].point);
      } else {
        border.box.extend(exact_bounds(edge.curve, edge.range));
      }
    }
  }
  return border;
}

/// Finds the extrema of x, y and z inside one face and adds them to its border's box.
class InteriorBounds {
 public:
  InteriorBounds(const TrimRegion& region, const Surface& surface, const Border& border)
      : region_(region), surface_(surface), border_(border), result_{border.box, true} {}

  FaceBounds run() {
    std::visit([&](const auto& s) { add(s); }, surface_);
    return result_;
  }

 private:
  /// On a plane, and along the rulings of these surfaces, a coordinate is linear: a maximum inside goes on to the
  /// border.
  void add(const Plane&) {}
  void add(const Cylinder&) {}
  void add(const Cone&) {}
  void add(const Extrusion&) {}

  void add(const Sphere& sphere) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 normal = local(sphere.frame, axis);
      for (const double sign : {1.0, -1.0}) {
        const Vec3 n = sign * normal;
        try_point({std::atan2(n.y(), n.x()), std::asin(std::clamp(n.z(), -1.0, 1.0))}, axis);
      }
    }
  }

  void add(const Torus& torus) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 d = local(torus.frame, axis);
      const double across = std::hypot(d.x(), d.y());
      const double u = std::atan2(d.y(), d.x());
      // Along the axis the extrema are rings; one that stays off the border is inside at any u, so at this one.
      for (const double sign : {1.0, -1.0}) {
        const double v = std::atan2(d.z(), sign * across);
        const double turn = sign > 0.0 ? 0.0 : kPi;
        try_point({u + turn, v}, axis);
        try_point({u + turn, v + kPi}, axis);
      }
    }
  }

  void add(const Revolution& revolution) {
    if (const auto spread = radial_direction(revolution)) {
      for (int axis = 0; axis < 3; ++axis) add_meridian_extrema(revolution, *spread, axis);
    } else {
      search();
    }
  }

  void add(const BSplineSurface& surface) {
    add_creases(surface);
    search();
  }
  void add(const FittedSurface& surface) { add(surface.fit); }

  /// Along knots of full multiplicity the surface may have a crease, with an extremum of no stationary point.
  void add_creases(const BSplineSurface& surface) {
    if (region_.bounds().isEmpty()) return;
    for (const bool along_v : {true, false}) {
      const Vec2 lo = region_.bounds().min();
      const Vec2 hi = region_.bounds().max();
      const Interval across = along_v ? Interval{lo.x(), hi.x()} : Interval{lo.y(), hi.y()};
      const Interval along = along_v ? Interval{lo.y(), hi.y()} : Interval{lo.x(), hi.x()};
      for (const double knot : crease_knots(surface, along_v, across)) {
        const Curve3 crease = iso_curve(surface, along_v, knot);
        for (int axis = 0; axis < 3; ++axis) {
          const Interval known{result_.box.min()[axis], result_.box.max()[axis]};
          for (const double t : critical_parameters(crease, along, Vec3::Unit(axis), &known)) {
            if (known.contains(evaluate<3>(crease, t).point[axis])) continue;
            try_point(along_v ? Vec2(knot, t) : Vec2(t, knot), axis);
          }
        }
      }
    }
  }

  static Vec3 local(const Frame& frame, int axis) { return {frame.x[axis], frame.y[axis], frame.z[axis]}; }

  /// The unit vector from the axis in whose plane the whole meridian lies; none if the meridian isn't plane.
  std::optional<Vec3> radial_direction(const Revolution& revolution) const {
    constexpr int kSamples = 16;
    const Interval range = meridian_range();
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

  static Vec3 meridian_point(const Revolution& revolution, double v) {
    return evaluate<3>(revolution.meridian, v).point;
  }
  [[nodiscard]] Interval meridian_range() const { return {region_.bounds().min().y(), region_.bounds().max().y()}; }

  /// Where d . S is extremal in u the meridian has been turned into the plane of d and the axis; there d . S is a
  /// linear function of the meridian's plane, whose extrema along it are those of a curve.
  void add_meridian_extrema(const Revolution& revolution, const Vec3& radial, int axis) {
    const Vec3& a = revolution.axis_direction;
    const Vec3 d = Vec3::Unit(axis);
    const Vec3 across = d - d.dot(a) * a;
    const double u = std::atan2(a.cross(radial).dot(across), radial.dot(across));
    for (const double sign : {1.0, -1.0}) {
      const Vec3 in_plane = d.dot(a) * a + sign * across.norm() * radial;
      for (const double v : critical_parameters(revolution.meridian, meridian_range(), in_plane)) {
        try_point({sign > 0.0 ? u : u + kPi, v}, axis);
      }
    }
  }

  void try_point(const Vec2& uv, int axis) {
    if (region_.classify(uv) == TrimRegion::Side::outside) return;
    const double value = evaluate_point(surface_, uv)[axis];
    result_.box.min()[axis] = std::min(result_.box.min()[axis], value);
    result_.box.max()[axis] = std::max(result_.box.max()[axis], value);
  }

  void search() {
    if (region_.bounds().isEmpty()) return;
    try {
      search(rational_form(surface_, region_.bounds()));
    } catch (const GeometryError&) {
      result_.converged = false;  // beyond the stated limits: the border's box stands
    }
  }

  void search(const RationalForm& form) {
    ExtremumLimits limits;
    limits.accuracy =
        kAccuracy * std::max(size_of(form.patches), border_.box.isEmpty() ? 0.0 : border_.box.sizes().norm());
    limits.border_accuracy = border_.tolerance;
    for (int axis = 0; axis < 3; ++axis) {
      const double lo = result_.box.isEmpty() ? -std::numeric_limits<double>::infinity() : -result_.box.min()[axis];
      const double hi = result_.box.isEmpty() ? -std::numeric_limits<double>::infinity() : result_.box.max()[axis];
      const Extremum low = find_maximum(form, region_, -Vec3::Unit(axis), lo, limits);
      const Extremum high = find_maximum(form, region_, Vec3::Unit(axis), hi, limits);
      box_.min()[axis] = -low.value;
      box_.max()[axis] = high.value;
      result_.converged = result_.converged && low.converged && high.converged;
    }
    result_.box = box_;
  }

  static double size_of(const std::vector<BezierPatch>& patches) {
    Box3 box;
    for (const BezierPatch& patch : patches) box.extend(control_box(patch));
    return box.isEmpty() ? 0.0 : box.sizes().norm();
  }

  const TrimRegion& region_;
  const Surface& surface_;
  const Border& border_;
  FaceBounds result_;
  Box3 box_;
};

}  // namespace

FaceBounds face_bounds(const Scene& scene, FaceId id) {
  const Face& face = scene.faces[id];
  const Border border = border_of(scene, face);
  const TrimRegion region(scene, id);
  return InteriorBounds(region, face.surface, border).run();
}

Box3 exact_bounds(const Scene& scene, FaceId face) { return face_bounds(scene, face).box; }

}  // namespace lamella
