#include "export/follow_curves.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lamella {

namespace {

/// Rounding to the grid moves a corner by 0.7 of its step, in each of the steps of clipping.
constexpr double kOnSide = 3.0 * kContourGrid;  // mm
/// What ends nearer joins: the uncertainty that files state.
constexpr double kJoined = 1e-6;  // mm
constexpr int kNewtonSteps = 30;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

bool is_same(const Vec2& a, const Vec2& b) { return (a - b).cwiseAbs().maxCoeff() <= 0.75 * kContourGrid; }

/// Distance of a point from a segment.
double distance(const Vec2& point, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double squared = along.squaredNorm();
  const double t = squared > 0.0 ? std::clamp((point - from).dot(along) / squared, 0.0, 1.0) : 0.0;
  return (from + t * along - point).norm();
}

double polynomial(const double* c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

double polynomial_slope(const double* c, double t) {
  return c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * 5.0 * c[5])));
}

}  // namespace

namespace {

/// x, y and weight of a conic's rational Bezier curve at t, or their derivatives.
Vec3 blend(const std::array<double, 12>& n, double first, double middle, double last) {
  return first * Vec3(n[0], n[1], 1.0) + middle * n[6] * Vec3(n[2], n[3], 1.0) + last * Vec3(n[4], n[5], 1.0);
}
Vec3 conic_at(const std::array<double, 12>& n, double t) {
  return blend(n, (1.0 - t) * (1.0 - t), 2.0 * t * (1.0 - t), t * t);
}

}  // namespace

Vec2 CurveCarrier::at(double t) const {
  const auto& n = numbers;
  if (!kind) return {n[0] + t * (n[2] - n[0]), n[1] + t * (n[3] - n[1])};
  if (*kind == CurveKind::quintic) return {polynomial(n.data(), t), polynomial(n.data() + 6, t)};
  if (*kind == CurveKind::conic) return conic_at(n, t).hnormalized();
  const double angle = n[6] + t * n[7];
  return Vec2(n[0], n[1]) + std::cos(angle) * Vec2(n[2], n[3]) + std::sin(angle) * Vec2(n[4], n[5]);
}

Vec2 CurveCarrier::slope(double t) const {
  const auto& n = numbers;
  if (!kind) return {n[2] - n[0], n[3] - n[1]};
  if (*kind == CurveKind::quintic) return {polynomial_slope(n.data(), t), polynomial_slope(n.data() + 6, t)};
  if (*kind == CurveKind::conic) {
    const Vec3 value = conic_at(n, t);
    const Vec3 slope = blend(n, 2.0 * t - 2.0, 2.0 - 4.0 * t, 2.0 * t);
    return (slope.head<2>() - slope.z() * value.hnormalized()) / value.z();
  }
  const double angle = n[6] + t * n[7];
  return n[7] * (std::cos(angle) * Vec2(n[4], n[5]) - std::sin(angle) * Vec2(n[2], n[3]));
}

double CurveCarrier::nearest(const Vec2& point, double near) const {
  // Gauss and Newton: points are within a chord error of the curve, far less than its radius.
  double t = near;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vec2 along = slope(t);
    const double squared = along.squaredNorm();
    if (!(squared > 0.0)) break;
    const double step = along.dot(point - at(t)) / squared;
    t += std::clamp(step, -0.25, 0.25);
    if (std::abs(step) < 1e-15) break;
  }
  if (kind && *kind != CurveKind::ellipse) t = std::clamp(t, 0.0, 1.0);
  return t;
}

CurveFollower::CurveFollower(const LayerContours& contours, double chord_error)
    : contours_(contours), chord_error_(chord_error) {
  const std::size_t count = contours.points.size();
  corners_.reserve(count);
  for (std::size_t side = 0; side < count; ++side) {
    const Vec2& point = contours.points[side];
    corners_.push_back({std::llround(point.x() / kContourGrid), std::llround(point.y() / kContourGrid), side});
  }
  std::sort(corners_.begin(), corners_.end());
  curve_of_.assign(count, -1);
  for (std::size_t i = 0; i < contours.curves.size(); ++i) {
    const ContourCurve& curve = contours.curves[i];
    std::fill_n(curve_of_.begin() + static_cast<std::ptrdiff_t>(curve.first_side), curve.sides,
                static_cast<std::int64_t>(i));
  }
  for (std::size_t loop = 0; loop < contours.loops.size(); ++loop) {
    loop_of_.insert(loop_of_.end(), contours.point_start[loop + 1] - contours.point_start[loop], loop);
  }
}

std::uint64_t CurveFollower::next(std::uint64_t side) const {
  const std::uint64_t loop = loop_of_[side];
  return side + 1 == contours_.point_start[loop + 1] ? contours_.point_start[loop] : side + 1;
}

std::uint64_t CurveFollower::previous(std::uint64_t side) const {
  const std::uint64_t loop = loop_of_[side];
  return side == contours_.point_start[loop] ? contours_.point_start[loop + 1] - 1 : side - 1;
}

std::vector<std::uint64_t> CurveFollower::sides_from(const Vec2& corner) const {
  const Corner wanted{std::llround(corner.x() / kContourGrid), std::llround(corner.y() / kContourGrid), 0};
  std::vector<std::uint64_t> sides;
  for (auto at = std::lower_bound(corners_.begin(), corners_.end(), wanted);
       at != corners_.end() && at->x == wanted.x && at->y == wanted.y; ++at) {
    sides.push_back(at->side);
  }
  return sides;
}

/// Whether the way from a corner of the contours along `side`, on or back, leads to `to` in a straight line: clipping
/// leaves out corners that are on the line between their neighbours.
bool CurveFollower::reaches(std::uint64_t side, bool forward, const Vec2& from, const Vec2& to) const {
  const std::int64_t curve = curve_of_[side];
  const std::uint64_t loop = loop_of_[side];
  for (std::uint64_t walked = contours_.point_start[loop]; walked < contours_.point_start[loop + 1]; ++walked) {
    const Vec2& a = contours_.points[side];
    const Vec2& b = contours_.points[next(side)];
    if (distance(to, a, b) <= kOnSide) return true;
    const Vec2& onward = forward ? b : a;
    if (distance(onward, from, to) > kOnSide) return false;
    side = forward ? next(side) : previous(side);
    if (curve_of_[side] != curve) return false;
  }
  return false;
}

CurveFollower::Source CurveFollower::source_of(const Vec2& from, const Vec2& to, const Source& before) const {
  std::vector<Source> found;
  const auto add = [&](std::uint64_t side, bool forward) {
    found.push_back({static_cast<std::int64_t>(side), curve_of_[side], forward});
  };
  for (const std::uint64_t side : sides_from(from)) {
    if (reaches(side, true, from, to)) add(side, true);
    if (reaches(previous(side), false, from, to)) add(previous(side), false);
  }
  for (const std::uint64_t side : sides_from(to)) {
    if (reaches(previous(side), false, to, from)) add(previous(side), true);
    if (reaches(side, true, to, from)) add(side, false);
  }
  for (std::uint64_t side = 0; found.empty() && side < curve_of_.size(); ++side) {
    const Vec2& a = contours_.points[side];
    const Vec2& b = contours_.points[next(side)];
    if (distance(from, a, b) > kOnSide || distance(to, a, b) > kOnSide) continue;
    add(side, (to - from).dot(b - a) > 0.0);
  }
  if (found.empty()) return {};
  for (const Source& source : found) {
    if (source.curve >= 0 && source.curve == before.curve && source.forward == before.forward) return source;
  }
  // Where two solids touch, the loop stays with one of them for as long as it can.
  for (const Source& source : found) {
    if (before.side >= 0 &&
        loop_of_[static_cast<std::size_t>(source.side)] == loop_of_[static_cast<std::size_t>(before.side)]) {
      return source;
    }
  }
  return found.front();
}

/// Whether a loop's side goes on along the curve of the side before it.
bool CurveFollower::continues(const MaterialLoop& loop, const std::vector<Source>& sources, std::size_t side) const {
  const Source& here = sources[side];
  const Source& before = sources[side == 0 ? sources.size() - 1 : side - 1];
  if (here.curve < 0 || here.curve != before.curve || here.forward != before.forward) return false;
  // A closed curve begins anew in its node.
  const ContourCurve& curve = contours_.curves[static_cast<std::size_t>(here.curve)];
  const std::uint64_t end = next(curve.first_side + curve.sides - 1);
  return !(end == curve.first_side && is_same(loop.points[side], contours_.points[end]));
}

CurveFollower::Run CurveFollower::run_of(const MaterialLoop& loop, const std::vector<Source>& sources,
                                         std::size_t first, std::size_t count) const {
  const std::size_t size = loop.points.size();
  Run run;
  run.from = loop.points[first];
  run.to = loop.points[(first + count) % size];
  const Source& source = sources[first];
  CurveCarrier& carrier = run.stretch.carrier;
  if (source.side < 0) {
    carrier.numbers = {run.from.x(), run.from.y(), run.to.x(), run.to.y()};
    run.begins_whole = run.ends_whole = true;
    return run;
  }
  const auto side = static_cast<std::uint64_t>(source.side);
  std::uint64_t first_side = side;
  std::uint64_t sides = 1;
  if (source.curve < 0) {
    const Vec2& a = contours_.points[side];
    const Vec2& b = contours_.points[next(side)];
    carrier.numbers = {a.x(), a.y(), b.x(), b.y()};
  } else {
    const ContourCurve& curve = contours_.curves[static_cast<std::size_t>(source.curve)];
    carrier = {curve.kind, curve.numbers};
    first_side = curve.first_side;
    sides = curve.sides;
  }
  const Vec2& begin = contours_.points[first_side];
  const Vec2& end = contours_.points[next(first_side + sides - 1)];
  run.begins_whole = is_same(run.from, source.forward ? begin : end);
  run.ends_whole = is_same(run.to, source.forward ? end : begin);
  const auto parameter = [&](const Vec2& corner, std::int64_t of_side) {
    const double near =
        (static_cast<double>(static_cast<std::uint64_t>(of_side) - first_side) + 0.5) / static_cast<double>(sides);
    return carrier.nearest(corner, near);
  };
  const std::int64_t last = sources[(first + count - 1) % size].side;
  run.stretch.begin = run.begins_whole ? (source.forward ? 0.0 : 1.0) : parameter(run.from, source.side);
  run.stretch.end = run.ends_whole ? (source.forward ? 1.0 : 0.0) : parameter(run.to, last);
  return run;
}

/// Makes b begin where a ends.
void CurveFollower::join(Run& a, Run& b) const {
  if (a.ends_whole && b.begins_whole) return;
  double& end = a.stretch.end;
  double& begin = b.stretch.begin;
  if (a.ends_whole || b.begins_whole) {
    double& moved = a.ends_whole ? begin : end;
    const CurveCarrier& carrier = a.ends_whole ? b.stretch.carrier : a.stretch.carrier;
    moved = carrier.nearest(a.ends_whole ? a.stretch.last() : b.stretch.first(), moved);
    return;
  }
  double s = end;
  double t = begin;
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Vec2 gap = b.stretch.carrier.at(t) - a.stretch.carrier.at(s);
    const Vec2 along = a.stretch.carrier.slope(s);
    const Vec2 other = b.stretch.carrier.slope(t);
    const double determinant = cross(along, other);
    if (!(std::abs(determinant) > 1e-9 * along.norm() * other.norm())) return;
    s += cross(gap, other) / determinant;
    t += cross(gap, along) / determinant;
  }
  const Vec2 crossing = a.stretch.carrier.at(s);
  if (!((b.stretch.carrier.at(t) - crossing).norm() < 1e-3 * kJoined)) return;
  // Chords cross next to where curves do, unless those run nearly along each other.
  if (!((crossing - a.to).norm() <= 16.0 * (chord_error_ + kOnSide))) return;
  end = s;
  begin = t;
}

namespace {

/// Whether a stretch is no longer than what joins; readers drop such curves or stumble over them.
bool is_speck(const CurveStretch& stretch) {
  const Vec2 first = stretch.first();
  const Vec2 middle = stretch.carrier.at(0.5 * (stretch.begin + stretch.end));
  return (middle - first).norm() <= kJoined && (stretch.last() - first).norm() <= kJoined;
}

}  // namespace

std::vector<CurveStretch> CurveFollower::follow(const MaterialLoop& loop) const {
  const std::size_t size = loop.points.size();
  std::vector<Source> sources;
  for (std::size_t i = 0; i < size; ++i) {
    sources.push_back(
        source_of(loop.points[i], loop.points[(i + 1) % size], sources.empty() ? Source() : sources.back()));
  }
  std::size_t first = 0;
  while (first < size && continues(loop, sources, first)) ++first;
  if (first == size) first = 0;
  std::vector<Run> runs;
  for (std::size_t done = 0; done < size;) {
    std::size_t count = 1;
    while (done + count < size && continues(loop, sources, (first + done + count) % size)) ++count;
    runs.push_back(run_of(loop, sources, (first + done) % size, count));
    done += count;
  }
  if (runs.size() > 1) {
    for (std::size_t i = 0; i < runs.size(); ++i) join(runs[i], runs[(i + 1) % runs.size()]);
  }
  std::erase_if(runs, [](const Run& run) { return is_speck(run.stretch); });
  std::vector<CurveStretch> stretches;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    stretches.push_back(runs[i].stretch);
    const Vec2 from = runs[i].stretch.last();
    const Vec2 to = runs[(i + 1) % runs.size()].stretch.first();
    if ((to - from).norm() <= kJoined) continue;
    stretches.push_back({{std::nullopt, {from.x(), from.y(), to.x(), to.y()}}, 0.0, 1.0});
  }
  return stretches;
}

}  // namespace lamella
