#pragma once

#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "model/step/convert_solid.h"
#include "model/step/entity_index.h"
#include "model/step/raw_properties.h"

/// Private to model/step: from the imported assembly to a flat list of placed solids.
namespace lamella::step {

/// Bounds against assemblies that multiply without end.
inline constexpr int kMaxAssemblyDepth = 200;
inline constexpr std::size_t kMaxSolids = 2'000'000;

/// Material of a part by the number of its PRODUCT_DEFINITION.
using MaterialOf = std::function<std::optional<StepMaterial>(int product_definition)>;

struct Assembly {
  std::vector<SolidSource> solids;  ///< in the order of the walk
  std::vector<SolidSource> loose;   ///< shells and faces outside any solid, one entry per shell, one per part's faces
  FaceColors colors;
};

/// Where a copy of all roots is placed, and what its paths begin with ("" or "/label").
struct RootPlace {
  std::string path;
  TopLoc_Location location;
};

/// Walks all roots once for each place. Paths are unique among solids and loose geometry of a place together. Throws
/// InputError when the assembly is nested too deep or holds too many solids.
[[nodiscard]] Assembly walk_assembly(const Handle(TDocStd_Document) & document, const EntityIndex& entities,
                                     const MaterialOf& material_of, std::span<const RootPlace> places);

}  // namespace lamella::step
