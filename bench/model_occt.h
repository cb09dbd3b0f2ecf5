#pragma once

#include <TopoDS_Solid.hxx>
#include <filesystem>
#include <vector>

namespace lamella::bench {

/// The solids of a STEP file as OpenCASCADE reads them, in its own order, in mm. Throws std::runtime_error.
[[nodiscard]] std::vector<TopoDS_Solid> occt_solids(const std::filesystem::path& file);

}  // namespace lamella::bench
