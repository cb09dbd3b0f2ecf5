#include "export/material_contours.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <polyclipping/clipper.hpp>
#include <string>
#include <tuple>
#include <utility>

#include "core/error.h"
#include "export/contour_interfaces.h"
#include "slicing/interface_policy.h"
#include "slicing/rank_solids.h"

namespace lamella {

namespace {

namespace cl = ClipperLib;

/// What is thinner than this came of rounding corners to the grid: each side moves by half of it at most.
constexpr double kThinnest = 4.0 * kContourGrid;  // mm

cl::IntPoint to_grid(const Vec2& point) {
  return {std::llround(point.x() / kContourGrid), std::llround(point.y() / kContourGrid)};
}

Vec2 to_mm(const cl::IntPoint& point) {
  return {static_cast<double>(point.X) * kContourGrid, static_cast<double>(point.Y) * kContourGrid};
}

/// The section of one solid.
struct Part {
  MaterialId material;
  int priority = 0;
  int rank = 0;
  cl::Paths paths;
  Box2 box;
};

std::vector<Part> parts_of(const LayerContours& contours, const IdVector<SolidId, MaterialId>& materials,
                           const IdVector<SolidId, int>& priority, const IdVector<SolidId, int>& rank) {
  std::vector<Part> parts;
  SolidId last;
  for (std::size_t i = 0; i < contours.loops.size(); ++i) {
    const SolidId solid = contours.loops[i].solid;
    if (parts.empty() || solid != last) parts.push_back({materials[solid], priority[solid], rank[solid], {}, {}});
    last = solid;
    cl::Path& path = parts.back().paths.emplace_back();
    for (const Vec2& point : contours.polygon(i)) {
      path.push_back(to_grid(point));
      parts.back().box.extend(to_mm(path.back()));
    }
  }
  std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.rank > b.rank; });
  return parts;
}

/// Parts whose boxes touch, directly or by way of others; each group by falling rank.
std::vector<std::vector<std::size_t>> group_parts(const std::vector<Part>& parts) {
  std::vector<std::size_t> by_x(parts.size());
  std::iota(by_x.begin(), by_x.end(), 0);
  std::sort(by_x.begin(), by_x.end(), [&](std::size_t a, std::size_t b) {
    return std::pair(parts[a].box.min().x(), a) < std::pair(parts[b].box.min().x(), b);
  });
  std::vector<std::size_t> root(parts.size());
  std::iota(root.begin(), root.end(), 0);
  const auto find = [&](std::size_t part) {
    while (root[part] != part) part = root[part] = root[root[part]];
    return part;
  };
  for (std::size_t i = 0; i < by_x.size(); ++i) {
    const Box2& box = parts[by_x[i]].box;
    for (std::size_t j = i + 1; j < by_x.size() && parts[by_x[j]].box.min().x() <= box.max().x(); ++j) {
      if (!box.intersects(parts[by_x[j]].box)) continue;
      const std::size_t a = find(by_x[i]);
      const std::size_t b = find(by_x[j]);
      root[std::max(a, b)] = std::min(a, b);
    }
  }
  std::vector<std::vector<std::size_t>> groups(parts.size());
  for (std::size_t part = 0; part < parts.size(); ++part) groups[find(part)].push_back(part);
  std::erase_if(groups, [](const auto& group) { return group.empty(); });
  return groups;
}

bool may_share(const Part& a, const Part& b) {
  return a.priority == b.priority && a.material != b.material && a.box.intersects(b.box);
}

/// Whether two parts of the group may have to share an overlap.
bool has_shared(const std::vector<Part>& parts, const std::vector<std::size_t>& group) {
  for (std::size_t i = 0; i < group.size(); ++i) {
    for (std::size_t j = i + 1; j < group.size(); ++j) {
      if (may_share(parts[group[i]], parts[group[j]])) return true;
    }
  }
  return false;
}

InterfacePart interface_part(const Part& part) {
  InterfacePart out{part.priority, part.material, part.rank, {}};
  for (const cl::Path& path : part.paths) {
    auto& polygon = out.polygons.emplace_back();
    for (const cl::IntPoint& point : path) polygon.push_back(to_mm(point));
  }
  return out;
}

/// Leaves of the group's parts what the policy lets them keep.
void share_group(std::vector<Part>& parts, const std::vector<std::size_t>& group, OverlapPolicy policy) {
  std::vector<InterfacePart> all;
  for (const std::size_t i : group) all.push_back(interface_part(parts[i]));
  for (const KeptArea& kept : share_overlaps(all, policy)) {
    cl::Paths area;
    for (const Trapezoid& trapezoid : kept.area) {
      cl::Path& path = area.emplace_back();
      for (const Vec2& corner : trapezoid) path.push_back(to_grid(corner));
    }
    for (const std::size_t i : group) {
      if (parts[i].priority != kept.priority || parts[i].material != kept.material) continue;
      cl::Clipper clipper;
      clipper.AddPaths(parts[i].paths, cl::ptSubject, true);
      clipper.AddPaths(area, cl::ptClip, true);
      clipper.Execute(cl::ctIntersection, parts[i].paths, cl::pftPositive, cl::pftPositive);
    }
  }
}

/// What is left of part `place` of the group when those before it, of higher rank, have taken theirs. Parts of the same
/// material take nothing: they unite with it.
cl::Paths seen_of(const std::vector<Part>& parts, const std::vector<std::size_t>& group, std::size_t place) {
  const Part& part = parts[group[place]];
  cl::Clipper clipper;
  bool is_covered = false;
  for (std::size_t i = 0; i < place; ++i) {
    const Part& above = parts[group[i]];
    if (above.material == part.material || !above.box.intersects(part.box)) continue;
    clipper.AddPaths(above.paths, cl::ptClip, true);
    is_covered = true;
  }
  if (!is_covered) return part.paths;
  clipper.AddPaths(part.paths, cl::ptSubject, true);
  cl::Paths seen;
  clipper.Execute(cl::ctDifference, seen, cl::pftPositive, cl::pftPositive);
  return seen;
}

double length_of(const cl::Path& path) {
  double length = 0.0;
  for (std::size_t i = 0; i < path.size(); ++i) length += (to_mm(path[(i + 1) % path.size()]) - to_mm(path[i])).norm();
  return length;
}

bool is_sliver(const cl::Path& path) {
  const double area = std::abs(cl::Area(path)) * kContourGrid * kContourGrid;
  return path.size() < 3 || 2.0 * area <= kThinnest * length_of(path);
}

/// Of a path that begins with its lowest point, of those the leftmost: where it begins then depends on nothing else.
MaterialLoop loop_of(const cl::Path& path, std::int32_t parent) {
  MaterialLoop loop;
  loop.parent = parent;
  loop.area = cl::Area(path) * kContourGrid * kContourGrid;
  for (const cl::IntPoint& point : path) loop.points.push_back(to_mm(point));
  const auto lowest = std::min_element(loop.points.begin(), loop.points.end(), [](const Vec2& a, const Vec2& b) {
    return std::pair(a.y(), a.x()) < std::pair(b.y(), b.x());
  });
  std::rotate(loop.points.begin(), lowest, loop.points.end());
  return loop;
}

/// Loops by where they begin; those that begin in one point by area.
bool comes_before(const MaterialLoop& a, const MaterialLoop& b) {
  const auto key = [](const MaterialLoop& loop) {
    return std::tuple(loop.points.front().y(), loop.points.front().x(), loop.area);
  };
  return key(a) < key(b);
}

/// One outer loop and its holes, parents not yet numbered.
struct Island {
  MaterialLoop outer;
  std::vector<MaterialLoop> holes;
};

void add_islands(const cl::PolyNode& around, std::vector<Island>& islands) {
  for (const cl::PolyNode* outer : around.Childs) {
    for (const cl::PolyNode* hole : outer->Childs) add_islands(*hole, islands);
    if (is_sliver(outer->Contour)) continue;
    Island& island = islands.emplace_back();
    island.outer = loop_of(outer->Contour, -1);
    for (const cl::PolyNode* hole : outer->Childs) {
      if (!is_sliver(hole->Contour)) island.holes.push_back(loop_of(hole->Contour, 0));
    }
    std::sort(island.holes.begin(), island.holes.end(), comes_before);
  }
}

void unite(const cl::Paths& seen, std::vector<Island>& islands) {
  cl::Clipper clipper;
  clipper.AddPaths(seen, cl::ptSubject, true);
  cl::PolyTree tree;
  clipper.Execute(cl::ctUnion, tree, cl::pftPositive, cl::pftPositive);
  add_islands(tree, islands);
}

std::vector<MaterialLoop> loops_of(std::vector<Island>& islands) {
  std::sort(islands.begin(), islands.end(),
            [](const Island& a, const Island& b) { return comes_before(a.outer, b.outer); });
  std::vector<MaterialLoop> loops;
  for (Island& island : islands) {
    const auto outer = static_cast<std::int32_t>(loops.size());
    loops.push_back(std::move(island.outer));
    for (MaterialLoop& hole : island.holes) {
      hole.parent = outer;
      loops.push_back(std::move(hole));
    }
  }
  return loops;
}

}  // namespace

void require_contours(const BuildInfo& info, std::string_view format) {
  if (info.plan.chord_error) return;
  throw UsageError(std::string(format) + " needs contours, and the build has none", {}, "slice with --contours");
}

ContourCombiner::ContourCombiner(const BuildInfo& info, std::string_view format)
    : policy_(info.policy), rank_(rank_solids(info)), material_count_(info.materials.size()) {
  require_contours(info, format);
  for (const BuildSolid& solid : info.solids) {
    materials_.push_back(solid.material);
    priority_.push_back(solid.priority);
  }
}

MaterialContours ContourCombiner::combine(const LayerContours& contours) const {
  std::vector<Part> parts = parts_of(contours, materials_, priority_, rank_);
  IdVector<MaterialId, std::vector<Island>> islands(material_count_);
  for (const std::vector<std::size_t>& group : group_parts(parts)) {
    if (has_interfaces(policy_) && has_shared(parts, group)) share_group(parts, group, policy_);
    IdVector<MaterialId, cl::Paths> seen(material_count_);
    for (std::size_t place = 0; place < group.size(); ++place) {
      const cl::Paths more = seen_of(parts, group, place);
      cl::Paths& all = seen[parts[group[place]].material];
      all.insert(all.end(), more.begin(), more.end());
    }
    for (const MaterialId material : seen.ids()) {
      if (!seen[material].empty()) unite(seen[material], islands[material]);
    }
  }
  MaterialContours result(material_count_);
  for (const MaterialId material : result.ids()) result[material] = loops_of(islands[material]);
  return result;
}

}  // namespace lamella
