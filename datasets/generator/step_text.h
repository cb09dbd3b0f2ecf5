#pragma once

#include <array>
#include <string>

/// Corrections to the text of the STEP files that OpenCASCADE writes.
namespace lamella::datasets {

/// Names in the encoding of ISO 10303-21 instead of raw UTF-8, densities in g/cm^3 with the exponents 1 and -3
/// instead of the 3 and 2 that OpenCASCADE writes, and one context for all curves in parameter space instead of one
/// each.
[[nodiscard]] std::string normalised(std::string step_text);

/// Turns the placement of the named instance, which must be a pure shift, into a mirror image in x followed by that
/// shift: OpenCASCADE can't write it. Throws std::runtime_error when there is no such instance.
[[nodiscard]] std::string with_mirrored_instance(const std::string& step_text, const std::string& instance,
                                                 const std::array<double, 3>& shift);

}  // namespace lamella::datasets
