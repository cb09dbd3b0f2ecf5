#include "model/normal_cone.h"

#include <algorithm>
#include <cmath>

namespace lamella {

namespace {

/// Components of products of unit vectors below this are rounding.
constexpr double kRounding = 1e-12;

/// |n_z| on the shorter arc between two unit vectors: the larger of its ends' unless the arc passes over the place
/// where its great circle is highest or lowest.
double slant_on_arc(const Vec3& a, const Vec3& b) {
  const double k = std::clamp(a.dot(b), -1.0, 1.0);
  const double ends = std::max(std::abs(a.z()), std::abs(b.z()));
  const bool has_top = a.z() > k * b.z() && b.z() > k * a.z();
  const bool has_bottom = a.z() < k * b.z() && b.z() < k * a.z();
  if (!has_top && !has_bottom) return ends;
  const Vec3 across = a.cross(b);
  const double length = across.norm();
  if (!(length > kRounding)) return k > 0.0 ? ends : 1.0;
  const double along = across.z() / length;
  return std::max(ends, std::sqrt(std::max(0.0, 1.0 - along * along)));
}

/// Whether e is a combination of a, b and c with factors that aren't negative, up to rounding.
bool holds(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& e) {
  const double volume = a.dot(b.cross(c));
  if (std::abs(volume) <= kRounding) return false;  // flat: then pairs tell
  const double sign = volume > 0.0 ? 1.0 : -1.0;
  return sign * e.dot(b.cross(c)) >= -kRounding && sign * a.dot(e.cross(c)) >= -kRounding &&
         sign * a.dot(b.cross(e)) >= -kRounding;
}

}  // namespace

NormalCone cone_of(const std::vector<Vec3>& directions, double rounding) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& d : directions) {
    if (d.norm() > rounding) sum += d.normalized();
  }
  const double length = sum.norm();
  if (!(length > kRounding)) return {};
  NormalCone cone{sum / length, 0.0};
  double farthest = 1.0;
  for (const Vec3& d : directions) {
    if (d.norm() > rounding) farthest = std::min(farthest, d.normalized().dot(cone.axis));
  }
  // A cone of less than 90 degrees is convex: it holds the combinations too. acos near 1 is good to 2e-8.
  cone.half_angle = farthest > 0.0 ? std::acos(std::min(1.0, farthest)) + 3e-8 : kPi;
  return cone;
}

double largest_slant(const NormalCone& cone) {
  const double elevation = std::asin(std::clamp(std::abs(cone.axis.z()), 0.0, 1.0));
  const double highest = elevation + cone.half_angle;
  return highest >= 0.5 * kPi ? 1.0 : std::sin(highest);
}

double largest_slant_between(const NormalCone& first, const NormalCone& second) {
  const double angle = std::max(first.half_angle, second.half_angle);
  if (!(angle < 0.5 * kPi)) return 1.0;
  // With x a combination (sum of factors 1) of vectors of the cones and y that of the axes, |x - y| <= off and
  // |y| >= cos(half the angle between the axes); x / |x| and y / |y| differ by at most 2 |x - y| / (|x| + |y|).
  const double off = 2.0 * std::sin(0.5 * angle);
  const double k = std::clamp(first.axis.dot(second.axis), -1.0, 1.0);
  const double shortest = std::sqrt(0.5 * (1.0 + k));
  const double room = 2.0 * shortest - off;
  if (!(room > 0.0)) return 1.0;
  return std::min(1.0, slant_on_arc(first.axis, second.axis) + 2.0 * off / room);
}

double largest_slant_among(const std::vector<Vec3>& normals) {
  double most = 0.0;
  const std::size_t count = normals.size();
  for (std::size_t i = 0; i < count; ++i) {
    most = std::max(most, std::abs(normals[i].z()));
    for (std::size_t j = i + 1; j < count; ++j) {
      most = std::max(most, slant_on_arc(normals[i], normals[j]));
      for (std::size_t k = j + 1; k < count; ++k) {
        const bool vertical = holds(normals[i], normals[j], normals[k], Vec3::UnitZ()) ||
                              holds(normals[i], normals[j], normals[k], -Vec3::UnitZ());
        if (vertical) return 1.0;
      }
    }
  }
  return most;
}

}  // namespace lamella
