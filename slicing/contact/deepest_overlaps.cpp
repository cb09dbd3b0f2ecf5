#include "slicing/contact/deepest_overlaps.h"

#include <algorithm>
#include <limits>

namespace lamella {

namespace {

/// The longest stretch that two solids share on a row.
Interval longest_common(std::span<const Span> row, SolidId a, SolidId b) {
  Interval longest;
  for (const Span& first : row) {
    if (first.solid != a) continue;
    for (const Span& second : row) {
      if (second.solid != b) continue;
      const Interval common{std::max(first.begin, second.begin), std::min(first.end, second.end)};
      if (common.length() > longest.length()) longest = common;
    }
  }
  return longest;
}

/// How far inside both solids a point lies that lies in both.
double depth_at(const SolidDistances& distances, const std::pair<SolidId, SolidId>& solids, const Vec3& point) {
  const auto first = distances.find(solids.first, point, std::numeric_limits<double>::infinity());
  if (!first) return 0.0;
  const auto second = distances.find(solids.second, point, first->distance);
  return second ? second->distance : first->distance;
}

}  // namespace

DepthSampling::DepthSampling(const LayerPlan& plan, const IdVector<SolidId, SolidMeasure>& measures) {
  constexpr std::size_t kSamples = 8;
  const auto layer_of = [&](double z) {
    const auto found = std::lower_bound(plan.layers.begin(), plan.layers.end(), z,
                                        [](const LayerSpan& layer, double height) { return layer.z_sample < height; });
    return static_cast<std::size_t>(found - plan.layers.begin());
  };
  for (const SolidMeasure& measure : measures) {
    Steps steps;
    const Box3& box = measure.bounds;
    if (!box.isEmpty() && box.min().allFinite() && box.max().allFinite()) {
      const std::size_t first = layer_of(box.min().z());
      const std::size_t count = layer_of(box.max().z()) - first;
      steps.step = static_cast<std::uint32_t>(std::max<std::size_t>(1, count / kSamples));
      // The middles of equal parts: at the very ends an overlap is flat.
      steps.first = static_cast<std::uint32_t>((first + steps.step / 2) % steps.step);
    }
    steps_.push_back(steps);
  }
}

void DeepestOverlaps::add(const PairLength& overlap, std::size_t row) {
  const auto [place, is_new] = rows_.try_emplace({overlap.first, overlap.second}, Rows{row, row, row, overlap.length});
  Rows& rows = place->second;
  rows.last = row;
  if (overlap.length > rows.length) rows.longest = row;
  rows.length = std::max(rows.length, overlap.length);
}

void DeepestOverlaps::measure(const SolidDistances& distances, double z, const RowLattice& lattice,
                              const SpanRows& spans, std::vector<PairLength>& out) const {
  out.clear();
  for (const auto& [pair, rows] : rows_) {
    double deepest = 0.0;
    for (const std::size_t row : {rows.longest, rows.first + (rows.last - rows.first) / 2}) {
      const Interval common = longest_common(spans.row(row), pair.first, pair.second);
      if (!(common.length() > 0.0)) continue;
      const double across = lattice.position(lattice.first_row + static_cast<std::int64_t>(row));
      const Vec2 xy = common.middle() * lattice.along + across * lattice.across;
      deepest = std::max(deepest, depth_at(distances, pair, {xy.x(), xy.y(), z}));
    }
    out.push_back({pair.first, pair.second, deepest});
  }
}

}  // namespace lamella
