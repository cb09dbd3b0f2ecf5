#include "slicing/accuracy/mesh_caster.h"

#include <algorithm>
#include <array>

#include "core/parallel.h"
#include "slicing/compensated_sum.h"

namespace lamella::accuracy {

namespace {

constexpr std::size_t kChunk = 32768;  ///< triangles that are cut as one task

struct Hit {
  std::uint32_t ray;
  std::int32_t winding;  ///< +1 where the ray enters
  double x;
};

/// The piece of a triangle in a plane z: from the edge that goes down to the one that goes up, material on its left.
struct Cut {
  Vec2 down = Vec2::Zero();
  Vec2 up = Vec2::Zero();
};

Vec3 corner(const StlTriangle& t, std::size_t i) { return {t[3 * i], t[3 * i + 1], t[3 * i + 2]}; }

/// Where an edge meets the plane, computed from its lower end.
Vec2 cut_edge(const Vec3& a, const Vec3& b, double z) {
  const Vec3& low = a.z() < b.z() ? a : b;
  const Vec3& high = a.z() < b.z() ? b : a;
  const double t = (z - low.z()) / (high.z() - low.z());
  return low.head<2>() + t * (high.head<2>() - low.head<2>());
}

/// Calls visit(layer, cut) for the planes that cut the triangle.
template <class Visit>
void for_each_cut(const StlTriangle& triangle, const std::vector<double>& heights, const Visit& visit) {
  const std::array<Vec3, 3> corners{corner(triangle, 0), corner(triangle, 1), corner(triangle, 2)};
  const double low = std::min({corners[0].z(), corners[1].z(), corners[2].z()});
  const double high = std::max({corners[0].z(), corners[1].z(), corners[2].z()});
  auto at = std::lower_bound(heights.begin(), heights.end(), low);
  for (; at != heights.end() && *at < high; ++at) {
    const double z = *at;
    Cut cut;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3& a = corners[i];
      const Vec3& b = corners[(i + 1) % 3];
      if ((a.z() <= z) == (b.z() <= z)) continue;
      (a.z() <= z ? cut.up : cut.down) = cut_edge(a, b, z);
    }
    visit(static_cast<std::size_t>(at - heights.begin()), cut);
  }
}

void add_hits(std::size_t layer, const Cut& cut, const RayLattice& lattice, std::vector<Hit>& hits) {
  const bool rises = cut.up.y() > cut.down.y();
  const Vec2& low = rises ? cut.down : cut.up;
  const Vec2& high = rises ? cut.up : cut.down;
  auto row = std::lower_bound(lattice.y.begin(), lattice.y.end(), low.y());
  for (; row != lattice.y.end() && *row < high.y(); ++row) {
    const double t = (*row - low.y()) / (high.y() - low.y());
    const auto ray =
        static_cast<std::uint32_t>(layer * lattice.y.size() + static_cast<std::size_t>(row - lattice.y.begin()));
    // Material lies on the left of the piece, so a ray along +x leaves where it runs towards +y.
    hits.push_back({ray, rises ? -1 : 1, low.x() + t * (high.x() - low.x())});
  }
}

/// Cuts the triangles in chunks: visit(chunk, triangle) for each, chunks in parallel.
template <class Visit>
void for_each_chunk(const std::vector<StlTriangle>& triangles, const Progress& progress, int threads,
                    const Visit& visit) {
  parallel_for((triangles.size() + kChunk - 1) / kChunk,
               [&](std::size_t chunk) {
                 progress.throw_if_cancelled();
                 const std::size_t end = std::min(triangles.size(), (chunk + 1) * kChunk);
                 for (std::size_t i = chunk * kChunk; i < end; ++i) visit(chunk, triangles[i]);
               },
               threads);
}

std::size_t count_chunks(const std::vector<StlTriangle>& triangles) { return (triangles.size() + kChunk - 1) / kChunk; }

/// The ends of the runs of one ray in which the winding number isn't zero. Hits ascend in x.
void append_spans(std::span<const Hit> hits, MeshCast& cast) {
  std::int32_t winding = 0;
  double begin = 0.0;
  for (const Hit& hit : hits) {
    const std::int32_t before = winding;
    winding += hit.winding;
    if (before == 0) begin = hit.x;
    if (before == 0 || winding != 0 || !(begin < hit.x)) continue;
    cast.crossings.push_back({hit.ray, begin});
    cast.crossings.push_back({hit.ray, hit.x});
  }
  if (winding != 0) ++cast.unclosed_rays;
}

/// Joins spans that meet: what isn't there can't be crossed.
void drop_empty_gaps(Crossings& crossings) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < crossings.size(); i += 2) {
    if (kept > 0 && crossings[kept - 1] == crossings[i]) {
      crossings[kept - 1] = crossings[i + 1];
      continue;
    }
    crossings[kept++] = crossings[i];
    crossings[kept++] = crossings[i + 1];
  }
  crossings.resize(kept);
}

}  // namespace

MeshCast cast_at_mesh(const std::vector<StlTriangle>& triangles, const RayLattice& lattice, const Progress& progress,
                      int threads) {
  std::vector<std::vector<Hit>> chunks(count_chunks(triangles));
  for_each_chunk(triangles, progress, threads, [&](std::size_t chunk, const StlTriangle& triangle) {
    for_each_cut(triangle, lattice.z,
                 [&](std::size_t layer, const Cut& cut) { add_hits(layer, cut, lattice, chunks[chunk]); });
  });
  std::vector<Hit> hits;
  for (const std::vector<Hit>& chunk : chunks) hits.insert(hits.end(), chunk.begin(), chunk.end());
  // Entries before exits of the same place: two bodies that touch are one span.
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
    if (a.ray != b.ray) return a.ray < b.ray;
    if (a.x != b.x) return a.x < b.x;
    return a.winding > b.winding;
  });
  MeshCast cast;
  for (std::size_t first = 0; first < hits.size();) {
    std::size_t last = first;
    while (last < hits.size() && hits[last].ray == hits[first].ray) ++last;
    append_spans(std::span(hits).subspan(first, last - first), cast);
    first = last;
  }
  drop_empty_gaps(cast.crossings);
  return cast;
}

std::vector<double> mesh_section_areas(const std::vector<StlTriangle>& triangles, const std::vector<double>& heights,
                                       const Progress& progress, int threads) {
  std::vector<CompensatedSum> sums(heights.size());
  if (triangles.empty()) return std::vector<double>(heights.size(), 0.0);
  const Vec2 near = corner(triangles.front(), 0).head<2>();  // so that nothing cancels far from the origin
  std::vector<std::vector<CompensatedSum>> chunks(count_chunks(triangles));
  for (auto& chunk : chunks) chunk.resize(heights.size());
  for_each_chunk(triangles, progress, threads, [&](std::size_t chunk, const StlTriangle& triangle) {
    for_each_cut(triangle, heights, [&](std::size_t layer, const Cut& cut) {
      const Vec2 a = cut.down - near;
      const Vec2 b = cut.up - near;
      chunks[chunk][layer].add(0.5 * (a.x() * b.y() - a.y() * b.x()));
    });
  });
  for (const auto& chunk : chunks) {
    for (std::size_t layer = 0; layer < heights.size(); ++layer) sums[layer].add(chunk[layer].value());
  }
  std::vector<double> areas;
  for (const CompensatedSum& sum : sums) areas.push_back(sum.value());
  return areas;
}

}  // namespace lamella::accuracy
