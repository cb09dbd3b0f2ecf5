#pragma once

#include <array>
#include <string>
#include <vector>

/// Corrections to the text of the STEP files that OpenCASCADE writes.
namespace lamella::datasets {

/// Names in the encoding of ISO 10303-21 instead of raw UTF-8, densities in g/cm^3 with the exponents 1 and -3
/// instead of the 3 and 2 that OpenCASCADE writes, and one context for all curves in parameter space instead of one
/// each.
[[nodiscard]] std::string normalised(std::string step_text);

/// Adds one surface colour for each body, bodies in the order of the file; sRGB, rounded to 8 bits. Throws
/// std::runtime_error unless there are as many bodies as colours.
[[nodiscard]] std::string with_colors(const std::string& step_text, const std::vector<std::array<double, 3>>& colors);

/// Turns the placement of the named instance, which must be a pure shift, into a mirror image in x followed by that
/// shift: OpenCASCADE can't write it. Throws std::runtime_error when there is no such instance.
[[nodiscard]] std::string with_mirrored_instance(const std::string& step_text, const std::string& instance,
                                                 const std::array<double, 3>& shift);

}  // namespace lamella::datasets
