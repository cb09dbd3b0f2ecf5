#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.h"
#include "model/scene.h"

namespace lamella {

/// Largest density in g/cm^3 that is believed; osmium, the densest element, has 22.6.
inline constexpr double kMaxDensity = 100.0;

class FieldSource;

/// What adaptive layers that have a material must keep, all in mm; absent: what the run asks for.
struct ThicknessLimits {
  std::optional<double> deviation;  ///< of the layers from the material's surface
  std::optional<double> least;      ///< thickness
  std::optional<double> most;
};

struct Material {
  std::string name;
  std::optional<double> density;  ///< g/cm^3
  Color color{0.5, 0.5, 0.5};
  std::vector<MaterialId> components = {};  ///< what a graded material is mixed of, none of them graded; else empty
  std::shared_ptr<const FieldSource> field = nullptr;  ///< how, of a graded one; none in a build that was read

  ThicknessLimits layers = {};

  [[nodiscard]] bool is_graded() const { return !components.empty(); }
};

/// Which material a solid has, how it ranks where solids overlap, and which rule said so.
struct Assignment {
  MaterialId material;
  int priority = 0;  ///< higher wins
  std::string rule;  ///< e.g. "materials.xml:12 name=Grip*" or "STEP material"
};

enum class OverlapPolicy { priority, error, entry, exit, average };

/// Who is made of what, and who wins. Material ids follow the library's order.
struct MaterialTable {
  IdVector<MaterialId, Material> materials;
  IdVector<SolidId, Assignment> assignments;
  OverlapPolicy policy = OverlapPolicy::priority;
};

}  // namespace lamella
