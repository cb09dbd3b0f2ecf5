#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "model/step/part21.h"

/// Private to model/step: what a file says about itself, read from its entities.
namespace lamella::step {

/// "AP203", "AP214", "AP242", "AP209", "AP238" for the known schemas (any edition, any case), else the schema's own
/// word.
[[nodiscard]] std::string application_protocol(const std::string& schema);

struct LengthUnit {
  std::string name;  ///< "millimetre", or the name of a conversion based unit as written
  double in_mm = 1.0;
  int entity = 0;
};

/// Length units of the contexts that shapes are given in, in the file's order, each once. Entities that contradict
/// themselves (a conversion onto itself, a factor that is zero or not finite) give none.
[[nodiscard]] std::vector<LengthUnit> length_units(const Part21& file);

struct StepMaterial {
  std::string name;
  std::optional<double> density;  ///< g/cm^3
};

/// Materials by the number of the PRODUCT_DEFINITION they belong to.
///
/// Densities are computed here from value and unit: OpenCASCADE loses factors. The unit "g^3 cm^2", which OpenCASCADE
/// writes by mistake, is read as g/cm^3. Implausible values are left out and named in `findings`.
[[nodiscard]] std::map<int, StepMaterial> materials(const Part21& file, std::vector<Finding>& findings);

}  // namespace lamella::step
