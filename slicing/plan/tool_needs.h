#pragma once

#include <vector>

#include "materials/machine.h"
#include "materials/material_table.h"
#include "slicing/plan/layer_statistics.h"
#include "slicing/plan/load_tools.h"

namespace lamella {

/// What the layers of a build need of a machine's tools, which can all be loaded as they must. A material is one need,
/// to be held by tools that suit all its layers, where there is such a tool; else it is several whose tools differ. The
/// needs of a layer stand beside its materials. Throws InputError that names the layer and its materials where there is
/// no way to hold them.
[[nodiscard]] LoadProblem state_needs(const IdVector<MaterialId, Material>& materials,
                                      const std::vector<LayerStatistics>& layers, const Machine& machine);

}  // namespace lamella
