#include "bench/wedges.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

/// Where an edge is on a layer: value = start + (layer - z) * slope.
struct EdgeLine {
  float z;
  float y;
  float x;
  float slope_y;
  float slope_x;
};

EdgeLine line_of(const Corner& low, const Corner& high) {
  const float height = high.z - low.z;
  return {low.z, low.y, low.x, (high.y - low.y) / height, (high.x - low.x) / height};
}

struct Wedge {
  std::int32_t first_layer;
  std::int32_t last_layer;
  EdgeLine a;
  EdgeLine b;
  float dx_dy;
};

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

class Splitter {
 public:
  explicit Splitter(const Lattice& lattice) : layers_(lattice.layers) {}

  void add(Corner p, Corner q, Corner r) {
    if (q < p) std::swap(p, q);
    if (r < q) std::swap(q, r);
    if (q < p) std::swap(p, q);
    const std::int32_t low = std::max(0, ceiling(p.z));
    const std::int32_t middle = std::clamp(ceiling(q.z), 0, layers_);
    const std::int32_t high = std::min(layers_, ceiling(r.z));
    if (low >= high) return;
    const EdgeLine whole = line_of(p, r);
    const float slope = row_slope(p, q, r);
    if (low < middle) wedges_.push_back({low, middle, whole, line_of(p, q), slope});
    if (middle < high) wedges_.push_back({std::max(low, middle), high, whole, line_of(q, r), slope});
  }

  /// The wedges in the order of their first layers, by a counting sort.
  [[nodiscard]] Wedges sorted() const {
    std::vector<std::uint32_t> next(static_cast<std::size_t>(layers_) + 1, 0);
    for (const Wedge& wedge : wedges_) ++next[static_cast<std::size_t>(wedge.first_layer) + 1];
    for (std::size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
    Wedges result;
    for (auto* values : {&result.z_a, &result.y_a, &result.x_a, &result.slope_y_a, &result.slope_x_a, &result.z_b,
                         &result.y_b, &result.x_b, &result.slope_y_b, &result.slope_x_b, &result.dx_dy}) {
      values->resize(wedges_.size());
    }
    result.first_layer.resize(wedges_.size());
    result.last_layer.resize(wedges_.size());
    for (const Wedge& wedge : wedges_) put(result, next[static_cast<std::size_t>(wedge.first_layer)]++, wedge);
    return result;
  }

 private:
  static void put(Wedges& to, std::uint32_t i, const Wedge& wedge) {
    to.first_layer[i] = wedge.first_layer;
    to.last_layer[i] = wedge.last_layer;
    to.z_a[i] = wedge.a.z;
    to.y_a[i] = wedge.a.y;
    to.x_a[i] = wedge.a.x;
    to.slope_y_a[i] = wedge.a.slope_y;
    to.slope_x_a[i] = wedge.a.slope_x;
    to.z_b[i] = wedge.b.z;
    to.y_b[i] = wedge.b.y;
    to.x_b[i] = wedge.b.x;
    to.slope_y_b[i] = wedge.b.slope_y;
    to.slope_x_b[i] = wedge.b.slope_x;
    to.dx_dy[i] = wedge.dx_dy;
  }

  std::int32_t layers_;
  std::vector<Wedge> wedges_;
};

}  // namespace

Wedges make_wedges(const SolidMesh& mesh, const Lattice& lattice) {
  const std::vector<Corner> corners = corners_of(mesh, lattice);
  Splitter splitter(lattice);
  for (const auto& [a, b, c] : mesh.triangles) splitter.add(corners[a], corners[b], corners[c]);
  Wedges wedges = splitter.sorted();
  float lowest = std::numeric_limits<float>::max();
  float highest = std::numeric_limits<float>::lowest();
  for (const Corner& corner : corners) {
    lowest = std::min(lowest, corner.y);
    highest = std::max(highest, corner.y);
  }
  if (corners.empty()) return wedges;
  // One row more on either side, for the rounding of Y on an edge.
  wedges.first_row = std::clamp(ceiling(lowest) - 1, 0, lattice.rows);
  wedges.last_row = std::clamp(ceiling(highest) + 1, wedges.first_row, lattice.rows);
  return wedges;
}

}  // namespace lamella::bench
