#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/outputs.h"
#include "materials/material_table.h"
#include "slicing/layer_plan.h"
#include "slicing/slicer.h"

namespace lamella::apps {

/// All that `lamella slice` was asked for.
struct SliceRequest {
  std::vector<std::string> files;
  std::optional<std::string> materials;
  std::string build;            ///< the store's folder
  std::vector<Output> outputs;  ///< the store first, then the formats asked for
  FormatOptions format;
  PlanOptions plan;
  OverlapPolicy policy = OverlapPolicy::priority;
  SliceOptions slice;
  bool dry_run = false;
};

/// Adds the options of the verb but for the files.
void add_slice_options(CLI::App& verb);

/// Throws UsageError on numbers that make no sense and on options that lack the one they need.
[[nodiscard]] SliceRequest read_slice_request(const CLI::App& verb, const std::vector<std::string>& files);

}  // namespace lamella::apps
