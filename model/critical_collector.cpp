#include <algorithm>
#include <cmath>

#include "model/critical_detail.h"
#include "model/evaluate.h"

namespace lamella {

namespace {

/// Points closer than this share of the bounds are one.
constexpr double kSamePoint = 1e-8;
constexpr std::size_t kMaxCopies = 4096;
constexpr std::size_t kMaxLevels = 4096;

Box2 padded(const Box2& box) {
  const Vec2 pad = 1e-9 * box.sizes().cwiseMax(box.min().cwiseAbs()).cwiseMax(box.max().cwiseAbs());
  return {box.min() - pad, box.max() + pad};
}

/// The step of Newton's method on z_u = z_v = 0; not finite where it is not defined.
Vec2 newton_step(const SurfacePoint2& at) {
  const double det = at.duu.z() * at.dvv.z() - at.duv.z() * at.duv.z();
  return Vec2(at.duv.z() * at.dv.z() - at.dvv.z() * at.du.z(), at.duv.z() * at.du.z() - at.duu.z() * at.dv.z()) / det;
}

double gradient(const SurfacePoint2& at, const Vec2& size) {
  return std::abs(at.du.z()) * size[0] + std::abs(at.dv.z()) * size[1];
}

/// A few steps of Newton's method that may only take away rounding: short ones that pay.
Vec2 polish(const Surface& surface, Vec2 uv, const Vec2& size) {
  SurfacePoint2 at = evaluate2(surface, uv);
  for (int i = 0; i < 3; ++i) {
    const Vec2 step = newton_step(at);
    if (!(step.cwiseQuotient(size).cwiseAbs().maxCoeff() < 1e-6)) break;
    const SurfacePoint2 next = evaluate2(surface, uv + step);
    if (!(gradient(next, size) < 0.5 * gradient(at, size))) break;
    uv += step;
    at = next;
  }
  return uv;
}

/// A row of the net may be one point in space, where every surface direction of that row has length zero.
bool on_pole(const Surface& surface, const Vec2& uv, const Box2& bounds) {
  const Vec2 size = bounds.sizes();
  for (const int axis : {0, 1}) {
    Vec2 elsewhere = uv;
    const bool lower = uv[axis] < bounds.center()[axis];
    elsewhere[axis] += (lower ? 0.3 : -0.3) * size[axis];
    const auto vanishes = [&](const Vec2& place) {
      const SurfacePoint at = evaluate(surface, place);
      const double along = (axis == 0 ? at.du : at.dv).norm() * size[axis];
      return along < 1e-8 * (axis == 0 ? at.dv : at.du).norm() * size[1 - axis];
    };
    if (vanishes(uv) && vanishes(elsewhere)) return true;
  }
  return false;
}

}  // namespace

std::vector<double> copies_within(double value, double period, const Interval& range) {
  std::vector<double> copies;
  if (!(period > 0.0)) {
    if (range.contains(value)) copies.push_back(value);
    return copies;
  }
  const double first = std::ceil((range.lo - value) / period);
  for (std::size_t k = 0; k < kMaxCopies; ++k) {
    const double copy = value + (first + static_cast<double>(k)) * period;
    if (!(copy <= range.hi)) break;
    copies.push_back(copy);
  }
  return copies;
}

CriticalCollector::CriticalCollector(const Surface& surface, const Box2& uv_bounds)
    : surface_(surface), bounds_(padded(uv_bounds)) {}

void CriticalCollector::add_point(const Vec2& uv, CriticalKind kind) {
  if (bounds_.contains(uv)) found_.points.push_back({uv, evaluate_point(surface_, uv).z(), kind});
}

void CriticalCollector::add_copies(const Vec2& uv, CriticalKind kind) {
  const Vec2 period = periods(surface_);
  const std::vector<double> all_u = copies_within(uv[0], period[0], range(0));
  const std::vector<double> all_v = copies_within(uv[1], period[1], range(1));
  if (all_u.size() * all_v.size() >= kMaxCopies) return give_up();
  for (const double u : all_u) {
    for (const double v : all_v) add_point({u, v}, kind);
  }
}

void CriticalCollector::add_near(const Vec2& uv) {
  const Vec2 size = bounds_.sizes();
  const Vec2 place = polish(surface_, uv, size).cwiseMax(bounds_.min()).cwiseMin(bounds_.max());
  // At a pole the height is stationary along the pole's row whatever the surface does there.
  if (on_pole(surface_, place, bounds_)) return;
  add_point(place, kind_by_curvature(surface_, place, size));
}

void CriticalCollector::merge_points() {
  std::vector<CriticalPoint>& points = found_.points;
  const Vec2 near = kSamePoint * bounds_.sizes();
  std::stable_sort(points.begin(), points.end(),
                   [](const CriticalPoint& a, const CriticalPoint& b) { return a.uv[0] < b.uv[0]; });
  std::vector<CriticalPoint> kept;
  for (const CriticalPoint& point : points) {
    bool repeated = false;
    for (auto other = kept.rbegin(); other != kept.rend() && !repeated; ++other) {
      if (other->uv[0] < point.uv[0] - near[0]) break;
      repeated = std::abs(other->uv[1] - point.uv[1]) <= near[1];
    }
    if (!repeated) kept.push_back(point);
  }
  points = std::move(kept);
}

void CriticalCollector::merge_levels() {
  std::vector<double>& merged = found_.levels;
  std::sort(exact_levels_.begin(), exact_levels_.end());
  std::sort(levels_.begin(), levels_.end());
  // Sets found exactly several times differ by rounding.
  for (const double z : exact_levels_) {
    if (merged.empty() || z > merged.back() + 1e-2 * kLevelAccuracy) merged.push_back(z);
  }
  const std::vector<double> exact = merged;
  for (std::size_t i = 0; i < levels_.size();) {
    const double first = levels_[i];
    double last = first;
    for (; i < levels_.size() && levels_[i] <= first + kLevelAccuracy; ++i) last = levels_[i];
    const auto near = std::lower_bound(exact.begin(), exact.end(), last - kLevelAccuracy);
    if (near == exact.end() || *near > first + kLevelAccuracy) merged.push_back(0.5 * (first + last));
  }
  std::sort(merged.begin(), merged.end());
  if (merged.size() <= kMaxLevels) return;
  give_up();
  // Evenly thinned: none of them is worth more than the others.
  for (std::size_t i = 0; i < kMaxLevels; ++i) merged[i] = merged[i * merged.size() / kMaxLevels];
  merged.resize(kMaxLevels);
}

CriticalPoints CriticalCollector::take() {
  const auto finite_point = [](const CriticalPoint& p) { return p.uv.allFinite() && std::isfinite(p.z); };
  const auto is_broken = [](double z) { return !std::isfinite(z); };
  const std::size_t broken = std::erase_if(found_.points, [&](const CriticalPoint& p) { return !finite_point(p); }) +
                             std::erase_if(levels_, is_broken) + std::erase_if(exact_levels_, is_broken);
  if (broken > 0) give_up();
  merge_points();
  merge_levels();
  return std::move(found_);
}

CriticalKind kind_by_curvature(const Surface& surface, const Vec2& uv, const Vec2& size) {
  const SurfacePoint2 at = evaluate2(surface, uv);
  const double uu = at.duu.z() * size[0] * size[0];
  const double uv_term = at.duv.z() * size[0] * size[1];
  const double vv = at.dvv.z() * size[1] * size[1];
  const double det = uu * vv - uv_term * uv_term;
  const double scale = std::max({std::abs(uu), std::abs(uv_term), std::abs(vv)});
  // Second derivatives carry rounding of about 1e-12 of their size; that is the smallest curvature to believe in.
  if (!(std::abs(det) > 1e-12 * scale * scale)) return CriticalKind::flat;
  if (det < 0.0) return CriticalKind::saddle;
  return uu > 0.0 ? CriticalKind::minimum : CriticalKind::maximum;
}

CriticalKind kind_of(const Ring& ring) {
  if (ring.changes == 0) return ring.above ? CriticalKind::minimum : CriticalKind::maximum;
  return ring.changes == 4 ? CriticalKind::saddle : CriticalKind::flat;
}

Ring look_around(const Surface& surface, const Vec2& uv, const Vec2& radius) {
  constexpr int kDirections = 64;
  const double z = evaluate_point(surface, uv).z();
  const double noise = 1e-14 * (1.0 + std::abs(z));
  Ring ring;
  int first = 0, before = 0;
  for (int i = 0; i < kDirections; ++i) {
    // Half a step off the axes, which creases run along.
    const double angle = (i + 0.5) * kTwoPi / kDirections;
    const Vec2 place = uv + radius.cwiseProduct(Vec2(std::cos(angle), std::sin(angle)));
    const double rise = evaluate_point(surface, place).z() - z;
    const int sign = rise > noise ? 1 : (rise < -noise ? -1 : 0);
    if (sign == 0) continue;
    (sign > 0 ? ring.above : ring.below) = true;
    if (first == 0) first = sign;
    if (before != 0 && sign != before) ++ring.changes;
    before = sign;
  }
  if (before != first) ++ring.changes;
  return ring;
}

}  // namespace lamella
