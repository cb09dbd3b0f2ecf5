#pragma once

#include <vector>

#include "slicing/accuracy/accuracy_study.h"
#include "slicing/accuracy/exact_side.h"

namespace lamella::accuracy {

/// What meshes are measured against.
struct Exact {
  const Scene& scene;
  const IdVector<SolidId, SolidMeasure>& measures;
  const std::vector<SolidId>& solids;
  RayLattice lattice;
  SolidCrossings crossings;
  std::vector<std::vector<double>> areas;  ///< of each solid on each layer, mm^2
};

/// Tessellates, writes STL files, reads and slices them, from coarse to fine, and measures their errors.
[[nodiscard]] std::vector<StlResult> study_stl(const Exact& exact, StepShapes& shapes, const StudyOptions& options,
                                               const Progress& progress);

}  // namespace lamella::accuracy
