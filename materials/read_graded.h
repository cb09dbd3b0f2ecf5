#pragma once

#include <filesystem>
#include <vector>

#include "core/xml.h"
#include "materials/material_table.h"

namespace lamella {

/// Reads a <graded> of a library: its components, which must be in `library` already, and its field (docs/formats/
/// materials.md). Name, colour and priority are left to the caller. Files are relative to `folder`, and added to
/// `files`. Throws InputError.
[[nodiscard]] Material read_graded(const XmlElement& element, const std::vector<Material>& library,
                                   const std::filesystem::path& folder, std::vector<std::filesystem::path>& files);

}  // namespace lamella
