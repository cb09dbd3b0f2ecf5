#include "model/nearest_point.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "model/bezier.h"
#include "model/box_tree.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/rational_form.h"
#include "model/trim.h"

namespace lamella {

namespace {

constexpr int kSteps = 40;

/// Parts are halved until they bend by less than this part of their size, so that the distance over one has one
/// minimum for points that aren't near a centre of curvature, and Newton's iteration finds it from the middle.
constexpr double kBend = 0.02;
constexpr int kMaxHalvings = 12;
/// The box of a large slanted plane is all but empty.
constexpr int kLeastHalvings = 4;

/// Part of an edge over which its direction turns by at most about a quarter of a right angle.
constexpr int kArcParts = 16;
constexpr int kSpanParts = 4;

enum class Cover { inside, outside, crossed };

/// A part of a surface between lines of its parameters.
struct SurfacePart {
  std::uint32_t face = 0;  ///< in Data::faces
  Box2 uv;
  bool is_inside = false;  ///< no border within
  Mat3 axes;               ///< rows: the normal in the middle and two directions across it
  Box3 box;                ///< axes * S over the part, by its net: far thinner than its box where it is slanted
};

struct CurvePart {
  EdgeId edge;
  FaceId face;
  Interval t;
};

struct FaceData {
  FaceId id;
  const Surface* surface = nullptr;
  TrimRegion region;
};

/// Newton's iteration for the least distance over a box of parameters, damped where a step doesn't come nearer.
struct Descent {
  Vec2 uv;
  Vec3 foot;
  double squared = 0.0;
};

/// A Hessian that isn't positive definite (beyond a centre of curvature) gives way to Gauss and Newton's, which is.
Vec2 step_of(const SurfacePoint2& s, const Vec3& residual, double damping, const Vec2& uv, const Box2& box) {
  const Vec2 slope(s.du.dot(residual), s.dv.dot(residual));
  Eigen::Matrix2d gauss;
  gauss << s.du.squaredNorm(), s.du.dot(s.dv), s.du.dot(s.dv), s.dv.squaredNorm();
  Eigen::Matrix2d hessian = gauss;
  hessian(0, 0) -= residual.dot(s.duu);
  hessian(0, 1) -= residual.dot(s.duv);
  hessian(1, 0) = hessian(0, 1);
  hessian(1, 1) -= residual.dot(s.dvv);
  const bool is_convex = hessian(0, 0) > 0.0 && hessian.determinant() > 1e-12 * gauss(0, 0) * gauss(1, 1);
  Eigen::Matrix2d matrix = is_convex ? hessian : gauss;
  matrix.diagonal().array() += std::max(damping, std::numeric_limits<double>::epsilon()) * gauss.trace();
  Vec2 step = matrix.ldlt().solve(slope);
  // Along the border of the box the other parameter is alone.
  for (int fixed = 0; fixed < 2; ++fixed) {
    const bool is_held =
        (uv[fixed] <= box.min()[fixed] && step[fixed] < 0.0) || (uv[fixed] >= box.max()[fixed] && step[fixed] > 0.0);
    if (is_held) return fixed == 0 ? Vec2(0.0, slope.y() / matrix(1, 1)) : Vec2(slope.x() / matrix(0, 0), 0.0);
  }
  return step;
}

Descent descend(const Surface& surface, const Box2& box, const Vec3& point) {
  SurfacePoint2 s = evaluate2(surface, box.center());
  Descent at{box.center(), s.point, (point - s.point).squaredNorm()};
  double damping = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const Vec2 to = (at.uv + step_of(s, point - s.point, damping, at.uv, box)).cwiseMax(box.min()).cwiseMin(box.max());
    if (to == at.uv) break;
    const SurfacePoint2 next = evaluate2(surface, to);
    const double squared = (point - next.point).squaredNorm();
    // Comparisons are written so that NaN fails.
    if (squared < at.squared) {
      at = {to, next.point, squared};
      s = next;
      damping = damping < 1e-9 ? 0.0 : 0.1 * damping;
    } else if (damping < 1.0 && squared > at.squared * (1.0 + 1e-14)) {
      damping = std::max(10.0 * damping, 1e-6);
    } else {
      break;
    }
  }
  return at;
}

struct CurveDescent {
  Vec3 foot;
  double squared = 0.0;
};

CurveDescent descend(const Curve3& curve, const Interval& range, const Vec3& point) {
  double t = range.middle();
  CurvePoint2<3> c = evaluate2<3>(curve, t);
  CurveDescent best{c.point, (point - c.point).squaredNorm()};
  for (int step = 0; step < kSteps; ++step) {
    const Vec3 residual = point - c.point;
    double slope = c.dt.squaredNorm() - residual.dot(c.dtt);
    if (!(slope > 1e-12 * c.dt.squaredNorm())) slope = c.dt.squaredNorm();
    const double to = slope > 0.0 ? std::clamp(t + c.dt.dot(residual) / slope, range.lo, range.hi) : t;
    if (to == t) break;
    t = to;
    c = evaluate2<3>(curve, t);
    const double squared = (point - c.point).squaredNorm();
    if (!(squared < best.squared)) break;
    best = {c.point, squared};
  }
  for (const double end : {range.lo, range.hi}) {
    const Vec3 foot = evaluate<3>(curve, end).point;
    if (const double squared = (point - foot).squaredNorm(); squared < best.squared) best = {foot, squared};
  }
  return best;
}

/// How a box of parameters lies to the region of a face.
Cover cover_of(const TrimRegion& region, const Box2& uv) {
  for (const BezierCurve2& piece : region.boundary()) {
    if (control_box(piece).intersects(uv)) return Cover::crossed;
  }
  return region.classify(uv.center()) == TrimRegion::Side::inside ? Cover::inside : Cover::outside;
}

/// Rows: the direction, or any without one, and two across it.
Mat3 axes_along(const Vec3& direction) {
  const Vec3 normal = direction.allFinite() ? direction : Vec3::UnitZ();
  Mat3 axes;
  axes.row(0) = normal;
  axes.row(1) = normal.unitOrthogonal();
  axes.row(2) = axes.row(0).cross(axes.row(1));
  return axes;
}

/// The box along these axes of a patch: that of its net, which holds it.
Box3 box_along(const Mat3& axes, const BezierPatch& patch) {
  Box3 box;
  for (const Vec4& pole : patch.net) box.extend(Vec3(axes * (pole.head<3>() / pole.w())));
  return box;
}

/// Halves a patch across its longer side until it is flat enough.
void halve(const BezierPatch& patch, int depth, std::vector<BezierPatch>& out) {
  const Box3 box = control_box(patch);
  const bool is_flat = flatness(patch) <= kBend * box.sizes().norm();
  if (depth >= kMaxHalvings || (is_flat && depth >= kLeastHalvings)) {
    out.push_back(patch);
    return;
  }
  const auto corner = [&](int i, int j) -> Vec3 {
    const Vec4& p = patch.net[static_cast<std::size_t>(i * (patch.degree_v + 1) + j)];
    return p.head<3>() / p.w();
  };
  const int m = patch.degree_u;
  const int n = patch.degree_v;
  const double along_u =
      (corner(m / 2, n / 2) - corner(0, n / 2)).norm() + (corner(m, n / 2) - corner(m / 2, n / 2)).norm();
  const double along_v =
      (corner(m / 2, n / 2) - corner(m / 2, 0)).norm() + (corner(m / 2, n) - corner(m / 2, n / 2)).norm();
  const auto [first, second] = along_u >= along_v ? split_u(patch, patch.u.middle()) : split_v(patch, patch.v.middle());
  halve(first, depth + 1, out);
  halve(second, depth + 1, out);
}

/// Parameters at which a curve is divided, both ends included.
std::vector<double> divisions(const Curve3& curve, const Interval& range) {
  std::vector<double> breaks{range.lo, range.hi};
  int parts = std::holds_alternative<Line<3>>(curve) ? 1 : kArcParts;
  if (const auto* spline = std::get_if<BSplineCurve<3>>(&curve)) {
    parts = kSpanParts;
    for (const double knot : spline->knots) {
      if (knot > range.lo && knot < range.hi) breaks.push_back(knot);
    }
  }
  std::sort(breaks.begin(), breaks.end());
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  std::vector<double> out;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    for (int part = 0; part < parts; ++part) out.push_back(breaks[i] + (breaks[i + 1] - breaks[i]) * part / parts);
  }
  out.push_back(range.hi);
  return out;
}

}  // namespace

struct NearestPoint::Data {
  const Scene* scene = nullptr;
  std::vector<FaceData> faces;
  std::vector<SurfacePart> surface_parts;
  std::vector<CurvePart> curve_parts;
  std::vector<Box3> boxes;  ///< of the surface parts
  std::set<EdgeId> known_edges;
  BoxTree surface_tree;
  BoxTree curve_tree;

  void add_face(FaceId id);
  void add_edges(FaceId id, std::vector<Box3>& boxes);
  void search_faces(const Vec3& point, double& squared, NearPoint& best) const;
  void search_edges(const Vec3& point, double& squared, NearPoint& best) const;
};

void NearestPoint::Data::add_face(FaceId id) {
  const Face& face = scene->faces[id];
  faces.push_back({id, &face.surface, TrimRegion(*scene, id)});
  const FaceData& data = faces.back();
  if (data.region.boundary().empty()) return;
  const RationalForm form = rational_form(face.surface, data.region.bounds());
  std::vector<BezierPatch> parts;
  for (const BezierPatch& patch : form.patches) halve(patch, 0, parts);
  for (const BezierPatch& part : parts) {
    Box2 uv;
    uv.extend(form.to_surface({part.u.lo, part.v.lo}));
    uv.extend(form.to_surface({part.u.hi, part.v.hi}));
    const Cover cover = cover_of(data.region, uv);
    if (cover == Cover::outside) continue;
    const Mat3 axes = axes_along(evaluate(face.surface, uv.center()).normal().normalized());
    surface_parts.push_back(
        {static_cast<std::uint32_t>(faces.size() - 1), uv, cover == Cover::inside, axes, box_along(axes, part)});
    boxes.push_back(control_box(part));
  }
}

void NearestPoint::Data::add_edges(FaceId id, std::vector<Box3>& edge_boxes) {
  for (const LoopId loop : scene->faces[id].loops) {
    for (const HalfEdgeId half_edge : scene->loops[loop].half_edges) {
      const EdgeId edge_id = scene->half_edges[half_edge].edge;
      if (!known_edges.insert(edge_id).second) continue;
      const Edge& edge = scene->edges[edge_id];
      // A pole or an apex is a point of the surface, but perhaps on the border of the region.
      if (edge.degenerate) {
        curve_parts.push_back({edge_id, id, {}});
        edge_boxes.emplace_back(scene->vertices[edge.start].point);
        continue;
      }
      const std::vector<double> t = divisions(edge.curve, edge.range);
      for (std::size_t i = 0; i + 1 < t.size(); ++i) {
        curve_parts.push_back({edge_id, id, {t[i], t[i + 1]}});
        edge_boxes.push_back(exact_bounds(edge.curve, {t[i], t[i + 1]}));
      }
    }
  }
}

void NearestPoint::Data::search_faces(const Vec3& point, double& squared, NearPoint& best) const {
  surface_tree.search(point, squared, [&](std::uint32_t item, double limit) {
    const SurfacePart& part = surface_parts[item];
    if (part.box.squaredExteriorDistance(Vec3(part.axes * point)) >= limit) return limit;
    const FaceData& face = faces[part.face];
    const Descent found = descend(*face.surface, part.uv, point);
    if (!(found.squared < limit)) return limit;
    if (!part.is_inside && face.region.classify(found.uv) == TrimRegion::Side::outside) return limit;
    best = {0.0, found.foot, face.id, found.uv, false};
    squared = found.squared;
    return squared;
  });
}

void NearestPoint::Data::search_edges(const Vec3& point, double& squared, NearPoint& best) const {
  curve_tree.search(point, squared, [&](std::uint32_t item, double limit) {
    const CurvePart& part = curve_parts[item];
    const Edge& edge = scene->edges[part.edge];
    CurveDescent found;
    if (edge.degenerate) {
      found.foot = scene->vertices[edge.start].point;
      found.squared = (point - found.foot).squaredNorm();
    } else {
      found = descend(edge.curve, part.t, point);
    }
    if (!(found.squared < limit)) return limit;
    best = {0.0, found.foot, part.face, Vec2::Zero(), true};
    squared = found.squared;
    return squared;
  });
}

NearestPoint::NearestPoint(const Scene& scene, std::span<const FaceId> faces) : data_(std::make_unique<Data>()) {
  data_->scene = &scene;
  std::vector<Box3> edge_boxes;
  data_->faces.reserve(faces.size());
  for (const FaceId face : faces) {
    data_->add_face(face);
    data_->add_edges(face, edge_boxes);
  }
  data_->surface_tree = BoxTree(data_->boxes);
  data_->curve_tree = BoxTree(edge_boxes);
}

NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;
NearestPoint& NearestPoint::operator=(NearestPoint&&) noexcept = default;

std::optional<NearPoint> NearestPoint::find(const Vec3& point, double within) const {
  NearPoint best;
  double squared = within * within;
  data_->search_faces(point, squared, best);
  data_->search_edges(point, squared, best);
  if (!best.face.valid()) return std::nullopt;
  best.distance = std::sqrt(squared);
  return best;
}

bool NearestPoint::may_come_within(const Vec3& point, double within) const {
  bool may = false;
  const auto stop = [&](std::uint32_t, double) {
    may = true;
    return 0.0;
  };
  data_->surface_tree.search(point, within * within, stop);
  if (!may) data_->curve_tree.search(point, within * within, stop);
  return may;
}

Box3 NearestPoint::bounds() const {
  Box3 box;
  if (!data_->surface_tree.empty()) box.extend(data_->surface_tree.bounds());
  if (!data_->curve_tree.empty()) box.extend(data_->curve_tree.bounds());
  return box;
}

std::vector<FaceId> faces_of(const Scene& scene, SolidId solid) {
  std::vector<FaceId> faces;
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) faces.push_back(face);
  }
  return faces;
}

}  // namespace lamella
