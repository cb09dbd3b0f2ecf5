#pragma once

#include <cstdint>
#include <vector>

#include "slicing/span/section.h"
#include "slicing/span/span_engine.h"

namespace lamella::span {

/// For each loop (arcs by index, with its polygon and area) the index of the smallest loop of the other orientation
/// around it, or -1. Decided on the arcs themselves, not on the polygons, which may cross where walls are thinner than
/// the chord error.
[[nodiscard]] std::vector<std::int32_t> find_parents(const Section& section,
                                                     const std::vector<std::vector<std::uint32_t>>& arcs,
                                                     const std::vector<SectionLoop>& loops, double chord_error);

}  // namespace lamella::span
