#include "apps/machine_options.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/error.h"
#include "core/xml.h"
#include "materials/machine.h"

namespace lamella::apps {

void apply_machine(const std::optional<std::string>& file, PlanOptions& plan, AdaptiveOptions* adaptive) {
  if (!file) return;
  const Machine machine = read_machine(*file);
  if (!plan.pitch) plan.pitch = machine.pitch;
  if (adaptive != nullptr) {
    adaptive->machine = machine;
    return;
  }
  if (!plan.layer_height) {
    plan.layer_height = machine.layer_default;
    return;
  }
  const std::string fault = layer_height_fault(machine, *plan.layer_height);
  if (fault.empty()) return;
  throw UsageError("layers of " + format_double(*plan.layer_height) + " mm don't suit the machine: " + fault,
                   "--layer-height", "the machine's own is " + format_double(machine.layer_default) + " mm");
}

namespace {

void warn_of_tolerance(const Session& session, const accuracy::LatticeChoice& choice) {
  if (choice.file_tolerance <= choice.wanted) return;
  session.warn({{Severity::warning, "", "", "",
                 fmt::format("the STEP file states its edges to {:.3g} mm only, less accurately than the {:.3g} mm "
                             "asked for",
                             choice.file_tolerance, choice.wanted),
                 "lamella info lists the tolerances of the solids"}});
}

}  // namespace

accuracy::LatticeChoice apply_accuracy(const Session& session, const Assembly& assembly,
                                       std::span<const SolidId> solids, double accuracy,
                                       const std::optional<std::string>& machine, PlanOptions& plan) {
  std::optional<Machine> read;
  if (machine) read = read_machine(*machine);
  const accuracy::LatticeChoice choice =
      accuracy::choose_lattice(assembly.scene, assembly.measures, solids, accuracy, read ? &*read : nullptr);
  plan.pitch = choice.pitch.head<2>();
  plan.layer_height = choice.pitch.z();
  warn_of_tolerance(session, choice);
  return choice;
}

accuracy::LatticeChoice adaptive_accuracy(const Session& session, const Assembly& assembly,
                                          std::span<const SolidId> solids, double accuracy, const LayerPlan& plan,
                                          double deviation) {
  double thickest = 0.0;
  for (const LayerSpan& layer : plan.layers) thickest = std::max(thickest, layer.z_top - layer.z_bottom);
  const Vec2 pitch = plan.grid.pitch.head<2>();
  accuracy::LatticeChoice choice =
      accuracy::adaptive_guarantee(assembly.scene, assembly.measures, solids, accuracy, pitch, thickest, deviation);
  warn_of_tolerance(session, choice);
  if (choice.surface_bound > accuracy * (1.0 + 1e-9)) {
    session.warn(
        {{Severity::warning, "", "", "",
          fmt::format("voxels are within {:.4g} mm of the exact surface, not within the {:.4g} mm asked for: a "
                      "material may deviate by more",
                      choice.surface_bound, accuracy),
          "see the deviations in the material library"}});
  }
  return choice;
}

std::string accuracy_line(const accuracy::LatticeChoice& choice) {
  return fmt::format(
      "accuracy {:.4g} mm: voxels within {:.4g} mm of the exact surface, volumes within {:.4g} mm times the area; "
      "edges are known within {:.2g} mm",
      choice.wanted, choice.surface_bound, choice.offset_bound, choice.file_tolerance);
}

Json with_accuracy(Json object, const std::optional<accuracy::LatticeChoice>& choice) {
  if (choice) {
    object["accuracy"] = {{"wanted", choice->wanted},
                          {"surface_bound", choice->surface_bound},
                          {"offset_bound", choice->offset_bound},
                          {"file_tolerance", choice->file_tolerance}};
  }
  return object;
}

}  // namespace lamella::apps
