#pragma once

#include <ostream>

#include "slicing/plan/build_plan.h"

namespace lamella {

/// Writes a build plan as one HTML page that needs nothing else and no network: totals, materials, tools, findings,
/// and charts of area, time and tools over the height. Light or dark as the reader's system is.
void write_plan_page(const BuildPlan& plan, const BuildInfo& info, std::ostream& stream);

}  // namespace lamella
