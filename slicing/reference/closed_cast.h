#pragma once

#include "slicing/reference/solid_model.h"

namespace lamella::reference {

/// Closed spans of one solid on one ray (docs/methods/reference-engine.md, "Closing a ray").
///
/// The ray itself is taken if its crossings alternate and none is in doubt. Otherwise it is cast again, moved aside
/// along `up` and, a hundredth as far, along up x direction: first by 1e-8 to 1e-6 of the solid's size, which decides
/// exact ties by the half-open rule, then by the size of the edge zones that raised the doubt and in other directions.
/// Depths are put back onto the ray itself. What never alternates is repaired by dropping hits, and counted.
void cast_closed(const SolidModel& model, SolidId solid, const Ray& ray, const Vec3& up, CastScratch& scratch,
                 SolidCast& out, CastCounters& counters);

}  // namespace lamella::reference
