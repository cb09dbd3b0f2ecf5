#include "export/prism_mesh.h"

namespace lamella {

namespace {

/// Adds the prism over one outer loop and its holes.
void add_prism(std::span<const MaterialLoop> loops, double z_bottom, double z_top, PrismMesh& mesh) {
  std::vector<std::span<const Vec2>> polygons;
  std::uint32_t count = 0;
  for (const MaterialLoop& loop : loops) {
    polygons.emplace_back(loop.points);
    count += static_cast<std::uint32_t>(loop.points.size());
  }
  const auto bottom = static_cast<std::uint32_t>(mesh.points.size());
  const std::uint32_t top = bottom + count;
  for (const double z : {z_bottom, z_top}) {
    for (const auto& polygon : polygons) {
      for (const Vec2& point : polygon) mesh.points.emplace_back(point.x(), point.y(), z);
    }
  }
  for (const auto& [a, b, c] : triangulate(polygons)) {
    mesh.triangles.push_back({bottom + a, bottom + c, bottom + b});
    mesh.triangles.push_back({top + a, top + b, top + c});
  }
  std::uint32_t first = 0;
  for (const auto& polygon : polygons) {
    const auto size = static_cast<std::uint32_t>(polygon.size());
    for (std::uint32_t i = 0; i < size; ++i) {
      const std::uint32_t a = first + i;
      const std::uint32_t b = first + (i + 1) % size;
      mesh.triangles.push_back({bottom + a, bottom + b, top + b});
      mesh.triangles.push_back({bottom + a, top + b, top + a});
    }
    first += size;
  }
}

}  // namespace

void PrismMesh::add(std::span<const MaterialLoop> loops, double z_bottom, double z_top) {
  for (std::size_t begin = 0, end = 1; begin < loops.size(); begin = end++) {
    while (end < loops.size() && loops[end].parent >= 0) ++end;
    add_prism(loops.subspan(begin, end - begin), z_bottom, z_top, *this);
  }
}

}  // namespace lamella
