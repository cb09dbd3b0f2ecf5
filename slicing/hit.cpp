#include "slicing/hit.h"

namespace lamella {

CastCounters& CastCounters::operator+=(const CastCounters& other) {
  rays += other.rays;
  hits += other.hits;
  tie_rays += other.tie_rays;
  tolerance_rays += other.tolerance_rays;
  repaired_rays += other.repaired_rays;
  unclosed_rays += other.unclosed_rays;
  uncertain_hits += other.uncertain_hits;
  candidates += other.candidates;
  iterations += other.iterations;
  return *this;
}

}  // namespace lamella
