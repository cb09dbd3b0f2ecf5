#include "bench/wedges.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace lamella::bench {
namespace {

/// A vertex in units of the lattice.
struct Corner {
  float x;
  float y;
  float z;

  bool operator<(const Corner& other) const { return std::tie(z, y, x) < std::tie(other.z, other.y, other.x); }
};

EdgeLine line_of(const Corner& low, const Corner& high) {
  const float height = high.z - low.z;
  return {low.z, low.y, low.x, (high.y - low.y) / height, (high.x - low.x) / height};
}

std::vector<Corner> corners_of(const SolidMesh& mesh, const Lattice& lattice) {
  std::vector<Corner> corners;
  corners.reserve(mesh.vertices.size());
  for (const Vec3& point : mesh.vertices) {
    corners.push_back({static_cast<float>(point.x()),
                       static_cast<float>((point.y() - lattice.y0) / lattice.pitch_y - 0.5),
                       static_cast<float>((point.z() - lattice.z0) / lattice.pitch_z - 0.5)});
  }
  return corners;
}

/// dx/dy at constant z in the plane of three corners; 0 where the plane holds the ray's direction, and no row is met.
float row_slope(const Corner& p, const Corner& q, const Corner& r) {
  const double y1 = static_cast<double>(q.y) - p.y;
  const double z1 = static_cast<double>(q.z) - p.z;
  const double y2 = static_cast<double>(r.y) - p.y;
  const double z2 = static_cast<double>(r.z) - p.z;
  const double area = y1 * z2 - y2 * z1;
  if (area == 0.0) return 0.0F;
  return static_cast<float>(((static_cast<double>(q.x) - p.x) * z2 - (static_cast<double>(r.x) - p.x) * z1) / area);
}

std::int32_t ceiling(float value) { return static_cast<std::int32_t>(std::ceil(value)); }

/// A triangle's corners in ascending order, and the layers [low, middle) and [middle, high) of its wedges.
struct Triangle {
  Corner p;
  Corner q;
  Corner r;
  std::int32_t low;
  std::int32_t middle;
  std::int32_t high;
};

Triangle sort_corners(Corner p, Corner q, Corner r, std::int32_t layers) {
  if (q < p) std::swap(p, q);
  if (r < q) std::swap(q, r);
  if (q < p) std::swap(p, q);
  const std::int32_t low = std::clamp(ceiling(p.z), 0, layers);
  const std::int32_t high = std::clamp(ceiling(r.z), 0, layers);
  return {p, q, r, low, std::clamp(ceiling(q.z), low, high), high};
}

/// For each layer the number of wedges that begin below it, and their total at the end.
std::vector<std::uint32_t> count_wedges(const SolidMesh& mesh, const std::vector<Corner>& corners,
                                        std::int32_t layers) {
  std::vector<std::uint32_t> below(static_cast<std::size_t>(layers) + 1, 0);
  for (const auto& [a, b, c] : mesh.triangles) {
    const Triangle triangle = sort_corners(corners[a], corners[b], corners[c], layers);
    if (triangle.low < triangle.middle) ++below[static_cast<std::size_t>(triangle.low) + 1];
    if (triangle.middle < triangle.high) ++below[static_cast<std::size_t>(triangle.middle) + 1];
  }
  for (std::size_t k = 1; k < below.size(); ++k) below[k] += below[k - 1];
  return below;
}

void set_row_range(Wedges& wedges, const std::vector<Corner>& corners, std::int32_t rows) {
  if (corners.empty()) return;
  const auto [lowest, highest] =
      std::minmax_element(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) { return a.y < b.y; });
  // One row more on either side, for the rounding of Y on an edge.
  wedges.first_row = std::clamp(ceiling(lowest->y) - 1, 0, rows);
  wedges.last_row = std::clamp(ceiling(highest->y) + 1, wedges.first_row, rows);
}

}  // namespace

Wedges make_wedges(const SolidMesh& mesh, const Lattice& lattice) {
  const std::vector<Corner> corners = corners_of(mesh, lattice);
  std::vector<std::uint32_t> next = count_wedges(mesh, corners, lattice.layers);
  Wedges wedges;
  wedges.size = next.back();
  wedges.items = std::make_unique_for_overwrite<Wedge[]>(wedges.size);
  set_row_range(wedges, corners, lattice.rows);
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto [p, q, r, low, middle, high] = sort_corners(corners[a], corners[b], corners[c], lattice.layers);
    if (low == high) continue;
    const EdgeLine whole = line_of(p, r);
    const float slope = row_slope(p, q, r);
    if (low < middle) wedges.items[next[static_cast<std::size_t>(low)]++] = {low, middle, whole, line_of(p, q), slope};
    if (middle < high) {
      wedges.items[next[static_cast<std::size_t>(middle)]++] = {middle, high, whole, line_of(q, r), slope};
    }
  }
  return wedges;
}

}  // namespace lamella::bench
