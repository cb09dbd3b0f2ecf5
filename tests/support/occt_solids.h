#pragma once

#include <TopoDS_Solid.hxx>
#include <filesystem>
#include <vector>

#include "model/measure.h"

/// The solids of a STEP file as OpenCASCADE alone reads them, for comparisons.
namespace lamella::test {

/// None where it can't read the file.
[[nodiscard]] std::vector<TopoDS_Solid> occt_solids(const std::filesystem::path& file);

/// For each solid of a scene, by its measures, the index of OpenCASCADE's solid with the same box and volume, each
/// taken once; -1 for none.
[[nodiscard]] std::vector<int> match_solids(const std::vector<SolidMeasure>& measures,
                                            const std::vector<TopoDS_Solid>& solids);

}  // namespace lamella::test
