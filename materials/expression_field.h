#pragma once

#include <memory>
#include <string>
#include <vector>

#include "materials/field.h"

namespace lamella {

/// One formula and where it stands.
struct Formula {
  std::string text;
  std::string where;  ///< file:line
};

/// Fractions by formulas of x, y, z (part frame, mm), r = sqrt(x^2 + y^2) and d, the exact distance from the solid's
/// surface: one formula a component, or one less, and the last component is what is left to 1. `detail` is Field's.
/// Throws InputError for a formula that can't be understood.
[[nodiscard]] std::shared_ptr<const FieldSource> make_expression_field(std::vector<Formula> formulas,
                                                                       std::size_t components, double detail);

}  // namespace lamella
