#include "model/bezier.h"

#include <algorithm>
#include <array>

#include "model/de_casteljau.h"

namespace lamella {
namespace {

double ratio(const Interval& interval, double t) {
  // The ends give 0 and 1 exactly; an interval of no length has only one point.
  const double length = interval.hi - interval.lo;
  return length == 0.0 ? 0.0 : (t - interval.lo) / length;
}

/// Corner of the net in space; i and j are 0 or 1.
Vec3 corner(const BezierPatch& patch, int i, int j) {
  const int index = i * patch.degree_u * (patch.degree_v + 1) + j * patch.degree_v;
  return patch.net[index].head<3>() / patch.net[index][3];
}

/// By how much the weights differ, as a ratio minus one, from a product of one factor per row and one per column.
double weight_coupling(const BezierPatch& patch) {
  const int columns = patch.degree_v + 1;
  double least = 1.0;
  double largest = 1.0;
  for (int i = 1; i <= patch.degree_u; ++i) {
    for (int j = 1; j < columns; ++j) {
      const double product = patch.net[i * columns][3] * patch.net[j][3];
      const double factor = patch.net[i * columns + j][3] * patch.net[0][3] / product;
      least = std::min(least, factor);
      largest = std::max(largest, factor);
    }
  }
  return largest / least - 1.0;
}

}  // namespace

std::pair<BezierPatch, BezierPatch> split_u(const BezierPatch& patch, double u) {
  std::pair<BezierPatch, BezierPatch> halves{patch, patch};
  halves.first.u.hi = u;
  halves.second.u.lo = u;
  const int columns = patch.degree_v + 1;
  const double s = ratio(patch.u, u);
  for (int j = 0; j < columns; ++j) {
    split_in_place(&halves.first.net[j], &halves.second.net[j], patch.degree_u, columns, s);
  }
  return halves;
}

std::pair<BezierPatch, BezierPatch> split_v(const BezierPatch& patch, double v) {
  std::pair<BezierPatch, BezierPatch> halves{patch, patch};
  halves.first.v.hi = v;
  halves.second.v.lo = v;
  const int columns = patch.degree_v + 1;
  const double s = ratio(patch.v, v);
  for (int i = 0; i <= patch.degree_u; ++i) {
    split_in_place(&halves.first.net[i * columns], &halves.second.net[i * columns], patch.degree_v, 1, s);
  }
  return halves;
}

BezierPatch restrict_to(const BezierPatch& patch, Interval u, Interval v) {
  BezierPatch part = patch;
  if (u.lo > part.u.lo) part = split_u(part, std::min(u.lo, part.u.hi)).second;
  if (u.hi < part.u.hi) part = split_u(part, std::max(u.hi, part.u.lo)).first;
  if (v.lo > part.v.lo) part = split_v(part, std::min(v.lo, part.v.hi)).second;
  if (v.hi < part.v.hi) part = split_v(part, std::max(v.hi, part.v.lo)).first;
  return part;
}

Box3 control_box(const BezierPatch& patch) {
  Box3 box;
  for (const Vec4& point : patch.net) box.extend(point.head<3>() / point[3]);
  return box;
}

double flatness(const BezierPatch& patch) {
  const std::array<Vec3, 4> c{corner(patch, 0, 0), corner(patch, 1, 0), corner(patch, 0, 1), corner(patch, 1, 1)};
  double largest = 0.0;
  for (int i = 0; i <= patch.degree_u; ++i) {
    const double s = static_cast<double>(i) / patch.degree_u;
    const Vec3 low = c[0] + s * (c[1] - c[0]);
    const Vec3 high = c[2] + s * (c[3] - c[2]);
    for (int j = 0; j <= patch.degree_v; ++j) {
      const double t = static_cast<double>(j) / patch.degree_v;
      const Vec4& point = patch.net[i * (patch.degree_v + 1) + j];
      largest = std::max(largest, (point.head<3>() / point[3] - (low + t * (high - low))).norm());
    }
  }
  // A point is the mean of the net under the weights w_ij B_i B_j, so `largest` bounds its distance from the mean of
  // the bilinear patch's own net. That mean lies on the patch but for the covariance of the two net coordinates times
  // the twist; the covariance is 0 if the weights are a product of rows and columns, else at most (d + d^2) / 4 when
  // they differ from one by the ratio 1 + d, and never more than 1/4 (docs/methods/exact-model.md).
  const double d = weight_coupling(patch);
  const double covariance = std::min(0.25, 0.25 * (d + d * d));
  return largest + covariance * (c[0] - c[1] - c[2] + c[3]).norm();
}

HomogeneousPoint evaluate_homogeneous(const BezierPatch& patch, double u, double v) {
  const int columns = patch.degree_v + 1;
  const double s = ratio(patch.u, u);
  const double t = ratio(patch.v, v);
  std::array<Vec4, kMaxDegree + 1> value;
  std::array<Vec4, kMaxDegree + 1> slope;
  for (int j = 0; j < columns; ++j) {
    const auto [point, tangent] = evaluate_bezier(&patch.net[j], patch.degree_u, columns, s);
    value[j] = point;
    slope[j] = tangent;
  }
  const auto [point, dv] = evaluate_bezier(value.data(), patch.degree_v, 1, t);
  const Vec4 du = evaluate_bezier(slope.data(), patch.degree_v, 1, t).first;
  return {point, du / patch.u.length(), dv / patch.v.length()};
}

Vec3 evaluate_point(const BezierPatch& patch, double u, double v) {
  const int columns = patch.degree_v + 1;
  const double s = ratio(patch.u, u);
  std::array<Vec4, kMaxDegree + 1> value;
  for (int j = 0; j < columns; ++j) value[j] = evaluate_bezier(&patch.net[j], patch.degree_u, columns, s).first;
  const Vec4 point = evaluate_bezier(value.data(), patch.degree_v, 1, ratio(patch.v, v)).first;
  return point.head<3>() / point[3];
}

Vec2 evaluate_point(const BezierCurve2& curve, double t) {
  const int degree = static_cast<int>(curve.net.size()) - 1;
  const Vec3 point = evaluate_bezier(curve.net.data(), degree, 1, ratio(curve.t, t)).first;
  return point.head<2>() / point[2];
}

std::pair<BezierCurve2, BezierCurve2> split(const BezierCurve2& curve, double t) {
  std::pair<BezierCurve2, BezierCurve2> halves{curve, curve};
  halves.first.t.hi = t;
  halves.second.t.lo = t;
  const int degree = static_cast<int>(curve.net.size()) - 1;
  split_in_place(halves.first.net.data(), halves.second.net.data(), degree, 1, ratio(curve.t, t));
  return halves;
}

Box2 control_box(const BezierCurve2& curve) {
  Box2 box;
  for (const Vec3& point : curve.net) box.extend(point.head<2>() / point[2]);
  return box;
}

BezierCurve2 reversed(BezierCurve2 curve) {
  std::reverse(curve.net.begin(), curve.net.end());
  std::swap(curve.t.lo, curve.t.hi);
  return curve;
}

}  // namespace lamella
