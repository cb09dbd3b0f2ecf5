#include "model/near_parts.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "model/curve_extrema.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

constexpr int kSteps = 40;
/// mm; over so short a step the surface bends by less than rounding.
constexpr double kLastStep = 1e-9;

/// Parts are halved until they bend by less than this part of their size, so that the distance over one has one
/// minimum for points that aren't near a centre of curvature, and Newton's iteration finds it from the middle.
constexpr double kBend = 0.05;
constexpr int kMaxHalvings = 12;
/// The box of a large slanted plane is all but empty.
constexpr int kLeastHalvings = 4;

/// Part of an edge over which its direction turns by at most about a quarter of a right angle.
constexpr int kArcParts = 16;
constexpr int kSpanParts = 4;

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
    const Vec3 move = s.du * (to.x() - at.uv.x()) + s.dv * (to.y() - at.uv.y());
    if (damping == 0.0 && move.squaredNorm() < kLastStep * kLastStep) {
      const Vec3 foot = at.foot + move;
      return {to, foot, (point - foot).squaredNorm()};
    }
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

/// A box that holds an edge's curve: cheap, not exact.
Box3 box_of(const Scene& scene, const Edge& edge) {
  if (edge.degenerate) return Box3(scene.vertices[edge.start].point);
  const auto* spline = std::get_if<BSplineCurve<3>>(&edge.curve);
  if (spline == nullptr) return exact_bounds(edge.curve, edge.range);
  Box3 box;
  for (const Vec3& pole : spline->poles) box.extend(pole);
  return box;
}

bool has_box_within(const BoxTree& tree, const Vec3& point, double squared) {
  bool has = false;
  tree.search(point, squared, [&](std::uint32_t, double) {
    has = true;
    return 0.0;
  });
  return has;
}

}  // namespace

NearFace::NearFace(const Scene& scene, FaceId face)
    : id(face), surface(&scene.faces[face].surface), region(scene, face) {
  if (!region.boundary().empty()) form = rational_form(*surface, region.bounds());
}

NearPatch::NearPatch(const NearFace& face, BezierPatch patch)
    : face_(face), box_(control_box(patch)), patch_(std::move(patch)) {}

void NearPatch::divide() const {
  std::vector<BezierPatch> pieces;
  halve(patch_, 0, pieces);
  patch_ = {};
  std::vector<Box3> boxes;
  for (const BezierPatch& piece : pieces) {
    Box2 uv;
    uv.extend(face_.form.to_surface({piece.u.lo, piece.v.lo}));
    uv.extend(face_.form.to_surface({piece.u.hi, piece.v.hi}));
    const TrimRegion::Side side = face_.region.classify(uv.center(), 0.5 * uv.sizes());
    if (side == TrimRegion::Side::outside) continue;
    const Mat3 axes = axes_along(evaluate(*face_.surface, uv.center()).normal().normalized());
    parts_.push_back({uv, side == TrimRegion::Side::inside, axes, box_along(axes, piece)});
    boxes.push_back(control_box(piece));
  }
  tree_ = BoxTree(boxes);
}

void NearPatch::search(const Vec3& point, double& squared, NearPoint& best) const {
  std::call_once(once_, [this] { divide(); });
  tree_.search(point, squared, [&](std::uint32_t item, double limit) {
    const SurfacePart& part = parts_[item];
    if (part.box.squaredExteriorDistance(Vec3(part.axes * point)) >= limit) return limit;
    const Descent found = descend(*face_.surface, part.uv, point);
    if (!(found.squared < limit)) return limit;
    if (!part.is_inside && face_.region.classify(found.uv) == TrimRegion::Side::outside) return limit;
    best = {0.0, found.foot, face_.id, found.uv, false};
    squared = found.squared;
    return squared;
  });
}

bool NearPatch::may_come_within(const Vec3& point, double squared) const {
  std::call_once(once_, [this] { divide(); });
  return has_box_within(tree_, point, squared);
}

NearEdge::NearEdge(const Scene& scene, EdgeId edge, FaceId face)
    : edge_(scene.edges[edge]), face_(face), box_(box_of(scene, edge_)) {}

void NearEdge::divide() const {
  const std::vector<double> t = divisions(edge_.curve, edge_.range);
  std::vector<Box3> boxes;
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    parts_.push_back({t[i], t[i + 1]});
    boxes.push_back(exact_bounds(edge_.curve, parts_.back()));
  }
  tree_ = BoxTree(boxes);
}

void NearEdge::search(const Vec3& point, double& squared, NearPoint& best) const {
  const auto take = [&](const Vec3& foot, double found) {
    if (!(found < squared)) return;
    best = {0.0, foot, face_, Vec2::Zero(), true};
    squared = found;
  };
  // A pole or an apex is a point of the surface, but perhaps on the border of the region.
  if (edge_.degenerate) return take(box_.min(), (point - box_.min()).squaredNorm());
  std::call_once(once_, [this] { divide(); });
  tree_.search(point, squared, [&](std::uint32_t item, double) {
    const CurveDescent found = descend(edge_.curve, parts_[item], point);
    take(found.foot, found.squared);
    return squared;
  });
}

bool NearEdge::may_come_within(const Vec3& point, double squared) const {
  if (edge_.degenerate) return box_.squaredExteriorDistance(point) < squared;
  std::call_once(once_, [this] { divide(); });
  return has_box_within(tree_, point, squared);
}

}  // namespace lamella
