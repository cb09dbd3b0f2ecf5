#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/assembly.h"
#include "materials/machine.h"
#include "slicing/layer_plan.h"
#include "slicing/orient/orientations.h"

namespace lamella::apps {

/// What `lamella orient` and `slice --orient` were asked for.
struct OrientRequest {
  OrientationWeights weights;
  std::optional<std::string> down;             ///< faces, one of which is to lie on the plate
  std::optional<std::string> unsupported;      ///< faces that support must not touch
  double critical_angle = 45.0 / 180.0 * kPi;  ///< radians
  std::optional<AxisScan> scan;                ///< the paper's scheme
  LeastWidthLimits limits;
  std::size_t samples = 20'000;
  std::size_t count = 5;
  PlanOptions plan;                    ///< of which the layer height counts
  std::optional<std::string> machine;  ///< file
};

/// What came of it.
struct OrientOutcome {
  LeastWidth least;
  std::optional<AxisScanResult> scan;
  Orientations found;
  double layer_height = 0.0;
  double present_height = 0.0;  ///< as the assembly is
  std::optional<Machine> machine;
  std::shared_ptr<const SupportFunction> support;
  std::shared_ptr<const OrientationJudge> judge;
  std::vector<Finding> findings;
};

/// Weights from "height", "height=1,support=2,cusp": names with weights, 1 where none is given. Throws UsageError.
[[nodiscard]] OrientationWeights parse_weights(const char* option, const std::string& text);
/// The weights that aren't zero, by their names.
[[nodiscard]] std::vector<std::pair<const char*, double>> named_weights(const OrientationWeights& weights);

/// Adds --down, --unsupported and --critical-angle.
void add_orient_options(CLI::App& verb);
/// Reads them and the weights. Throws UsageError.
[[nodiscard]] OrientRequest read_orient_options(const CLI::App& verb, const char* option, const std::string& weights);
/// Throws UsageError when one of them was given without --orient.
void refuse_orient_options(const CLI::App& verb);

/// Finds orientations of a measured assembly. Throws InputError for faces that aren't there and when no orientation
/// keeps them as they are wanted; Cancelled.
[[nodiscard]] OrientOutcome find_orientation(const Session& session, const Assembly& assembly,
                                             const OrientRequest& request);

/// Turns the assembly by the best orientation, about the machine's origin, and says so. Measures are void afterwards.
[[nodiscard]] Mat3 orient_assembly(const Session& session, Assembly& assembly, const OrientRequest& request);

}  // namespace lamella::apps
