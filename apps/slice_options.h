#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/orientation.h"
#include "apps/outputs.h"
#include "apps/session.h"
#include "materials/material_table.h"
#include "model/step/read_step.h"
#include "slicing/adaptive/layer_rules.h"
#include "slicing/layer_plan.h"
#include "slicing/slicer.h"

namespace lamella::apps {

/// All that `lamella slice` was asked for.
struct SliceRequest {
  std::vector<StepPart> parts;
  std::optional<std::string> job;  ///< the file that named them
  std::optional<std::string> materials;
  std::optional<std::string> machine;
  std::optional<std::string> build;  ///< the store's folder; nothing: only the other outputs are written
  std::vector<Output> outputs;       ///< the store first, then the formats asked for
  FormatOptions format;
  PlanOptions plan;
  std::optional<double> accuracy;  ///< mm; then the plan gets pitch and layer height when the model is known, but for
                                   ///< adaptive layers
  std::optional<AdaptiveOptions> adaptive;    ///< with the machine, if any
  std::optional<std::string> adaptive_chart;  ///< file of the drawing
  OverlapPolicy policy = OverlapPolicy::priority;
  SliceOptions slice;
  std::optional<OrientRequest> orient;  ///< how to turn the assembly first
  bool dry_run = false;
};

/// Adds the options of the verb but for the files.
void add_slice_options(CLI::App& verb);

/// The parts are `files`, else those of --job, whose options count where the command line has none.
/// Throws UsageError on numbers that make no sense, on options that lack the one they need and when there is nothing to
/// slice or no place for it; InputError on a job that can't be used.
[[nodiscard]] SliceRequest read_slice_request(CLI::App& verb, const std::vector<std::string>& files,
                                              CommonOptions& common);

}  // namespace lamella::apps
