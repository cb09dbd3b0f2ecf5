#include "apps/machine_options.h"

#include "core/error.h"
#include "core/xml.h"
#include "materials/machine.h"

namespace lamella::apps {

void apply_machine(const std::optional<std::string>& file, PlanOptions& plan,
                   std::optional<AdaptiveOptions>& adaptive) {
  if (!file) return;
  const Machine machine = read_machine(*file);
  if (!plan.pitch) plan.pitch = machine.pitch;
  if (adaptive) {
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

}  // namespace lamella::apps
