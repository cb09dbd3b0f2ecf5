#pragma once

#include "slicing/layer_sink.h"

namespace lamella {

/// The ranks that the solids of a build had when its rows were combined: those of rank_solids() in slicing/combine.h.
[[nodiscard]] IdVector<SolidId, int> rank_solids(const BuildInfo& info);

}  // namespace lamella
