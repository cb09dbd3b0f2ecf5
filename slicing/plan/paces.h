#pragma once

#include <string>
#include <vector>

#include "materials/machine.h"

namespace lamella {

/// How a tool moves while it lays a material down, and on the way to the next track of it.
struct Pace {
  RampedMotion depositing;
  RampedMotion traveling;

  bool operator==(const Pace&) const = default;
};

/// At which paces a machine can lay a material down: those of the tools that can hold it, each once. What is measured
/// of a layer's tracks is measured for each, because the tool isn't chosen yet.
struct Paces {
  std::vector<Pace> all;
  std::vector<std::size_t> of_tool;  ///< in `all`; of tools that can't hold the material its size
};

/// Of a material with this name. Machines without tracks have none: of_tool is 0 everywhere.
[[nodiscard]] Paces paces_of(const Machine& machine, const std::string& material);

}  // namespace lamella
