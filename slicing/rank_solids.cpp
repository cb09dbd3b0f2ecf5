#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "slicing/combine.h"

namespace lamella {

namespace {

/// `value` to seven significant digits; what is not a number counts as infinitely large.
double rounded_volume(double value) {
  if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 6.0);
  return std::round(value / unit) * unit;
}

/// Bounds as one sortable value; an empty or undefined box becomes zeros.
std::array<double, 6> corners(const Box3& box) {
  if (!box.min().allFinite() || !box.max().allFinite()) return {};
  return {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()};
}

}  // namespace

IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                   const IdVector<SolidId, SolidMeasure>& measures) {
  std::vector<SolidId> order;
  for (const SolidId solid : scene.solids.ids()) order.push_back(solid);
  const auto loses_to = [&](SolidId a, SolidId b) {
    const int priority_a = table.assignments[a].priority;
    const int priority_b = table.assignments[b].priority;
    if (priority_a != priority_b) return priority_a < priority_b;
    const double volume_a = rounded_volume(measures[a].volume);
    const double volume_b = rounded_volume(measures[b].volume);
    if (volume_a != volume_b) return volume_a > volume_b;
    const int paths = scene.solids[a].info.path.compare(scene.solids[b].info.path);
    if (paths != 0) return paths > 0;
    const auto corners_a = corners(measures[a].bounds);
    const auto corners_b = corners(measures[b].bounds);
    if (corners_a != corners_b) return corners_a > corners_b;
    return a > b;
  };
  std::sort(order.begin(), order.end(), loses_to);
  IdVector<SolidId, int> rank(scene.solids.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);
  return rank;
}

}  // namespace lamella
