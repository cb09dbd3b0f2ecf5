#pragma once

#include <vector>

#include "model/scene.h"

/// Private to model/step.
namespace lamella::step {

/// Puts the half-edges of one wire head to tail, by shared vertices and, where several offer themselves, by the
/// distance in (u, v): so a seam's two uses and the two ends of a closed edge stay apart. Keeps the order of the file
/// where that is a chain already. Every half-edge is in the result; a wire that holds several chains becomes several.
[[nodiscard]] std::vector<std::vector<HalfEdge>> order_loops(std::vector<HalfEdge> wire, const Scene& scene);

}  // namespace lamella::step
