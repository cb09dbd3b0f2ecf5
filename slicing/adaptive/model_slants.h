#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/progress.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "model/scene.h"
#include "slicing/adaptive/edge_slants.h"
#include "slicing/adaptive/slant_profile.h"
#include "slicing/adaptive/thin_places.h"

namespace lamella {

/// What is flat somewhere: layers should end there.
enum class FlatKind {
  extremum,        ///< a point or a line where a solid's surface is locally highest or lowest
  face,            ///< a horizontal face
  material_change  ///< a solid begins or ends inside the assembly, which has several materials
};

struct FlatFeature {
  double z = 0.0;  ///< mm
  FlatKind kind = FlatKind::extremum;
  SolidId solid;          ///< one of those that have it
  std::size_t count = 1;  ///< features at this height
};

/// What of a model decides about layers.
struct ModelSlants {
  IdVector<MaterialId, std::optional<SlantProfile>> profiles;  ///< none for materials without a solid
  IdVector<MaterialId, std::vector<Interval>> heights;         ///< of the material's solids, ascending, apart
  std::size_t sharp_edges = 0;        ///< whose tips recede by more than is allowed in whatever layers
  std::vector<ThinPlace> thin;        ///< places that recede by more than is allowed in whatever layers meet none of it
  std::vector<FlatFeature> features;  ///< ascending, one a height
};

/// Where slants are wanted.
struct SlantGrid {
  double bottom = 0.0;  ///< mm
  double width = 0.0;   ///< mm, of a bin
  std::size_t count = 0;
};

/// Bounds the slants of the solids by their exact trimmed faces, edges and vertices, and finds what is flat. Solids
/// that are copies of one another at the same height are looked at once. Same result for any number of threads. Throws
/// GeometryError for surfaces beyond the stated limits (`wedges` has a rule for each material), Cancelled when asked.
[[nodiscard]] ModelSlants find_slants(const Scene& scene, const MaterialTable& table,
                                      const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids,
                                      const SlantGrid& grid, const IdVector<MaterialId, WedgeRule>& wedges,
                                      const Progress& progress = {}, int threads = 0);

}  // namespace lamella
