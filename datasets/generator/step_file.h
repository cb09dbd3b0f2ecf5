#pragma once

#include <filesystem>

#include "datasets/generator/assembly.h"

namespace lamella::datasets {

/// Writes the data set as AP214 with names, colours and materials; the same bytes each time. Throws
/// std::runtime_error when OpenCASCADE refuses or the file can't be written.
void write_step(const DataSet& set, const std::filesystem::path& path);

}  // namespace lamella::datasets
