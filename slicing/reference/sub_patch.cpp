#include "slicing/reference/sub_patch.h"

#include <algorithm>

namespace lamella::reference {

namespace {

Vec3 point(const Vec4& pole) { return pole.head<3>() / pole.w(); }

/// Largest second difference of the projected net along u (stride = degree_v + 1) or v (stride = 1): how much it bends,
/// or, for a bilinear direction, how much it twists is left to flatness().
double bend(const BezierPatch& patch, bool along_u) {
  const int rows = patch.degree_u + 1;
  const int columns = patch.degree_v + 1;
  double largest = 0.0;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const int stride = along_u ? columns : 1;
      const bool interior = along_u ? (i > 0 && i + 1 < rows) : (j > 0 && j + 1 < columns);
      if (!interior) continue;
      const Vec4* pole = &patch.net[i * columns + j];
      const Vec3 second = point(pole[-stride]) - 2.0 * point(pole[0]) + point(pole[stride]);
      largest = std::max(largest, second.norm());
    }
  }
  return largest;
}

double length_along(const BezierPatch& patch, bool along_u) {
  const int columns = patch.degree_v + 1;
  const int last_row = patch.degree_u * columns;
  const Vec3 p00 = point(patch.net.front());
  const Vec3 p01 = point(patch.net[columns - 1]);
  const Vec3 p10 = point(patch.net[last_row]);
  const Vec3 p11 = point(patch.net.back());
  return along_u ? std::max((p10 - p00).norm(), (p11 - p01).norm()) : std::max((p01 - p00).norm(), (p11 - p10).norm());
}

bool is_flat(const BezierPatch& patch, const RefineLimits& limits) {
  const double deviation = flatness(patch);
  return deviation <= limits.flatness && deviation <= limits.relative_flatness * control_box(patch).diagonal().norm();
}

std::pair<BezierPatch, BezierPatch> halve(const BezierPatch& patch) {
  const double bend_u = bend(patch, true);
  const double bend_v = bend(patch, false);
  const bool along_u = bend_u == bend_v ? length_along(patch, true) >= length_along(patch, false) : bend_u > bend_v;
  return along_u ? split_u(patch, patch.u.middle()) : split_v(patch, patch.v.middle());
}

SubPatch finish(BezierPatch&& patch, int level, std::uint32_t face, std::uint32_t id) {
  SubPatch result{id, face, level, std::move(patch), 0.0, 0.0};
  for (const Vec4& pole : result.patch.net) {
    result.max_weight = std::max(result.max_weight, pole.w());
    result.max_coordinate = std::max(result.max_coordinate, pole.head<3>().cwiseAbs().maxCoeff());
  }
  return result;
}

}  // namespace

RefineResult refine(std::vector<BezierPatch> pieces, const RefineLimits& limits, std::uint32_t face,
                    std::uint32_t first_id) {
  struct Open {
    BezierPatch patch;
    int level;
  };
  std::vector<Open> open;
  for (auto piece = pieces.rbegin(); piece != pieces.rend(); ++piece) open.push_back({std::move(*piece), 0});
  RefineResult result;
  while (!open.empty()) {
    Open next = std::move(open.back());
    open.pop_back();
    const bool flat = is_flat(next.patch, limits);
    const bool may_split =
        next.level < limits.max_level && result.patches.size() + open.size() + 2 <= limits.max_patches;
    if (flat || !may_split) {
      result.capped |= !flat;
      const auto id = static_cast<std::uint32_t>(first_id + result.patches.size());
      result.patches.push_back(finish(std::move(next.patch), next.level, face, id));
      continue;
    }
    auto [first, second] = halve(next.patch);
    open.push_back({std::move(second), next.level + 1});
    open.push_back({std::move(first), next.level + 1});
  }
  return result;
}

}  // namespace lamella::reference
