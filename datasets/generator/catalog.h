#pragma once

#include <vector>

#include "datasets/generator/assembly.h"

/// The shipped data sets, one function each.
namespace lamella::datasets {

[[nodiscard]] DataSet overmoulded_grip();
[[nodiscard]] DataSet nested_spheres();
[[nodiscard]] DataSet touching_boxes();
[[nodiscard]] DataSet interpenetrating_bodies();
[[nodiscard]] DataSet gradient_lens();

/// All of them, in the order of the manifest.
[[nodiscard]] std::vector<DataSet> catalog();

}  // namespace lamella::datasets
