#include "slicing/report.h"

#include <algorithm>

#include "core/tolerances.h"

namespace lamella {

bool SliceReport::within_budget() const {
  const bool all_sound =
      std::all_of(solids.begin(), solids.end(), [](const SolidReport& solid) { return solid.status == "ok"; });
  // A ray that could not be closed is worse than a repaired one and counts like it.
  const double repaired = static_cast<double>(cast.repaired_rays + cast.unclosed_rays);
  const double uncertain = static_cast<double>(cast.uncertain_hits);
  return all_sound && repaired <= tolerance::kRepairedBudget * static_cast<double>(rays) &&
         uncertain <= tolerance::kUncertainBudget * static_cast<double>(cast.hits);
}

}  // namespace lamella
