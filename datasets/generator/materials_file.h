#pragma once

#include <string>

#include "datasets/generator/assembly.h"

namespace lamella::datasets {

/// materials.xml (schemas/materials.xsd): the materials in the order of their first use, assigned by STEP material.
[[nodiscard]] std::string materials_xml(const DataSet& set);

}  // namespace lamella::datasets
