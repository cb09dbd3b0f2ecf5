#include "slicing/plan/paces.h"

#include <algorithm>

namespace lamella {

Paces paces_of(const Machine& machine, const std::string& material) {
  Paces paces;
  paces.of_tool.assign(machine.tools.size(), 0);
  if (machine.technology != Technology::extrusion && machine.technology != Technology::powder_bed) return paces;
  const MaterialSettings settings = machine.settings_of(material);
  const auto is_held = [&](ToolId tool) { return machine.can_hold(tool, material); };
  for (const ToolId tool : machine.tools.ids()) {
    if (!is_held(tool)) continue;
    const Pace pace{machine.depositing(tool, settings), machine.traveling(tool)};
    const auto found = std::find(paces.all.begin(), paces.all.end(), pace);
    paces.of_tool[tool.value()] = static_cast<std::size_t>(found - paces.all.begin());
    if (found == paces.all.end()) paces.all.push_back(pace);
  }
  for (const ToolId tool : machine.tools.ids()) {
    if (!is_held(tool)) paces.of_tool[tool.value()] = paces.all.size();
  }
  return paces;
}

}  // namespace lamella
