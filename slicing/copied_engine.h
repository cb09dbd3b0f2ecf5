#pragma once

#include <functional>
#include <span>
#include <vector>

#include "slicing/copies.h"
#include "slicing/slab_engine.h"

namespace lamella {

/// Prepares an engine for some solids.
using EngineMaker = std::function<SlabEngine(std::span<const SolidId> solids)>;

/// An engine that cuts every cluster of solids that comes more than once only once a layer, on rows shifted to where
/// each copy lies, and the rest of `solids` as the maker's engine does. Spans of copies differ from those of their own
/// cut by rounding: 1e-12 of the coordinates. The scene must outlive it.
///
/// Sections cost more than rows, so a tray of copies costs hardly more sections than one of them does; and only one of
/// them is prepared and held in memory.
[[nodiscard]] SlabEngine make_copied_engine(const Scene& scene, std::span<const SolidId> solids,
                                            std::vector<CopiedCluster> copies, const EngineMaker& make);

}  // namespace lamella
