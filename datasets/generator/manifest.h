#pragma once

#include <string>
#include <vector>

#include "datasets/generator/assembly.h"

namespace lamella::datasets {

/// datasets/manifest.json: what each file holds and the exact volumes, see datasets/README.md.
[[nodiscard]] std::string manifest_json(const std::vector<DataSet>& sets);

}  // namespace lamella::datasets
