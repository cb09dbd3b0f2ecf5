#include "slicing/rank_solids.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <string_view>

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

/// What decides who wins.
struct Standing {
  int priority = 0;
  double volume = 0.0;  ///< mm^3, rounded
  std::string_view path;
  std::array<double, 6> corners{};
};

bool loses_to(const Standing& a, const Standing& b) {
  if (a.priority != b.priority) return a.priority < b.priority;
  if (a.volume != b.volume) return a.volume > b.volume;
  const int paths = a.path.compare(b.path);
  if (paths != 0) return paths > 0;
  return a.corners > b.corners;
}

IdVector<SolidId, int> rank(const std::vector<Standing>& standings) {
  std::vector<std::size_t> order(standings.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    if (loses_to(standings[a], standings[b])) return true;
    return !loses_to(standings[b], standings[a]) && a > b;
  });
  IdVector<SolidId, int> ranks(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) ranks[SolidId{order[i]}] = static_cast<int>(i);
  return ranks;
}

}  // namespace

IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                   const IdVector<SolidId, SolidMeasure>& measures) {
  std::vector<Standing> standings;
  for (const SolidId solid : scene.solids.ids()) {
    standings.push_back({table.assignments[solid].priority, rounded_volume(measures[solid].volume),
                         scene.solids[solid].info.path, corners(measures[solid].bounds)});
  }
  return rank(standings);
}

IdVector<SolidId, int> rank_solids(const BuildInfo& info) {
  constexpr double kUnknown = std::numeric_limits<double>::infinity();
  std::vector<Standing> standings;
  for (const BuildSolid& solid : info.solids) {
    // A build says 0 of a volume that isn't known.
    const double volume = solid.volume_exact == 0.0 ? kUnknown : rounded_volume(solid.volume_exact);
    standings.push_back({solid.priority, volume, solid.path, corners(solid.bounds)});
  }
  return rank(standings);
}

}  // namespace lamella
