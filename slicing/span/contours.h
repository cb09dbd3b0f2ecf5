#pragma once

#include "model/scene.h"
#include "slicing/span/section.h"
#include "slicing/span/span_engine.h"

namespace lamella::span {

struct ContourRequest {
  SolidId solid;
  double z = 0.0;            ///< mm, for messages
  double chord_error = 0.0;  ///< mm, at least kLeastChordError is taken
};

/// Finer polygons than this mean nothing in double precision.
inline constexpr double kLeastChordError = 1e-9;  // mm

/// Loops of a section of one solid, with areas, polygons and nesting.
[[nodiscard]] SectionContours assemble_contours(const Scene& scene, const Section& section,
                                                const ContourRequest& request);

/// Area of a section, mm^2: the sum over its arcs, in any order, without a search for loops.
[[nodiscard]] double section_area(const Section& section);

}  // namespace lamella::span
