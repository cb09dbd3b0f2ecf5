#include "slicing/orient/natural_directions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <type_traits>

#include "slicing/orient/flat_face.h"

namespace lamella {

namespace {

constexpr std::size_t kMost = 500;

std::optional<Vec3> axis_of(const Surface& surface) {
  return std::visit(
      [](const auto& s) -> std::optional<Vec3> {
        using T = std::decay_t<decltype(s)>;
        if constexpr (std::is_same_v<T, Cylinder> || std::is_same_v<T, Cone> || std::is_same_v<T, Torus>) {
          return s.frame.z.stableNormalized();
        } else if constexpr (std::is_same_v<T, Revolution>) {
          return s.axis_direction.stableNormalized();
        } else {
          return std::nullopt;
        }
      },
      surface);
}

}  // namespace

std::vector<Vec3> natural_directions(const Scene& scene, std::span<const SolidId> solids) {
  struct Group {
    Vec3 direction;
    std::size_t faces = 0;
  };
  // Equal but for rounding: by their coordinates to 1e-9, upwards or, level, along +x.
  std::map<std::array<long, 3>, Group> groups;
  for (const SolidId solid : solids) {
    for (const ShellId shell : scene.solids[solid].shells) {
      for (const FaceId face : scene.shells[shell].faces) {
        auto axis = flat_normal(scene.faces[face]);
        if (!axis) axis = axis_of(scene.faces[face].surface);
        if (!axis || !axis->allFinite() || !(axis->norm() > 0.5)) continue;
        std::array<long, 3> key{};
        for (int i = 0; i < 3; ++i) key[i] = std::lround((*axis)[i] * 1e9);
        const std::array<long, 3> opposite{-key[0], -key[1], -key[2]};
        if (opposite > key) {
          key = opposite;
          *axis = -*axis;
        }
        Group& group = groups.try_emplace(key, Group{*axis, 0}).first->second;
        ++group.faces;
      }
    }
  }
  std::vector<Group> sorted;
  for (const auto& [key, group] : groups) sorted.push_back(group);
  std::stable_sort(sorted.begin(), sorted.end(), [](const Group& a, const Group& b) { return a.faces > b.faces; });
  std::vector<Vec3> directions;
  for (std::size_t i = 0; i < std::min(kMost, sorted.size()); ++i) directions.push_back(sorted[i].direction);
  return directions;
}

}  // namespace lamella
