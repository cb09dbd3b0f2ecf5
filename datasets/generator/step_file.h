#pragma once

#include <filesystem>

#include "datasets/generator/assembly.h"

namespace lamella::datasets {

/// Writes the data set as AP214 with names, colours and materials; the same bytes each time. Throws
/// std::runtime_error when OpenCASCADE refuses or the file can't be written.
void write_step(const DataSet& set, const std::filesystem::path& path);

/// What OpenCASCADE writes, made exact: names in ISO 10303-21 encoding instead of raw UTF-8, densities in g/cm^3
/// with the exponents 1 and -3 instead of the 3 and 2 it writes.
[[nodiscard]] std::string normalised(const std::string& step_text);

}  // namespace lamella::datasets
