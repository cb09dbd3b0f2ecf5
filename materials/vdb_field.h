#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "materials/field.h"

namespace lamella {

/// Fractions by grids of floats of an OpenVDB file, trilinear between voxels, in the part's frame in mm by the grids'
/// own transforms: the name of a grid for each component, or one less, and the last component is what is left to 1.
/// Throws InputError with the file, `where` in the hint, and the names there are.
[[nodiscard]] std::shared_ptr<const FieldSource> make_vdb_field(const std::filesystem::path& file,
                                                                const std::vector<std::string>& grids,
                                                                std::size_t components, const std::string& where);

}  // namespace lamella
