#pragma once

#include <optional>
#include <string>
#include <vector>

#include "datasets/generator/assembly.h"

/// The shipped data sets, one function each.
namespace lamella::datasets {

[[nodiscard]] DataSet overmoulded_grip();
[[nodiscard]] DataSet nested_spheres();
[[nodiscard]] DataSet touching_boxes();
[[nodiscard]] DataSet interpenetrating_bodies();
[[nodiscard]] DataSet gradient_lens();
[[nodiscard]] DataSet connector();
[[nodiscard]] DataSet pcb_stack();
[[nodiscard]] DataSet bone_screw();
[[nodiscard]] DataSet mould_insert();
[[nodiscard]] DataSet lattice_in_shell();
[[nodiscard]] DataSet mirrored_brackets();
[[nodiscard]] DataSet turbine_blade_16();
[[nodiscard]] DataSet housing_102();
[[nodiscard]] DataSet impeller_135();

/// Their names, in the order of the manifest.
[[nodiscard]] std::vector<std::string> catalog_names();

/// The one of that name, nothing if there is none.
[[nodiscard]] std::optional<DataSet> make_data_set(const std::string& name);

/// All of them, in the order of the manifest.
[[nodiscard]] std::vector<DataSet> catalog();

}  // namespace lamella::datasets
