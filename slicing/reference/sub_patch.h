#pragma once

#include <cstdint>
#include <vector>

#include "model/bezier.h"

namespace lamella::reference {

/// One rational Bezier sub-patch of a face, the unit of root finding (paper, step 2).
struct SubPatch {
  std::uint32_t id = 0;    ///< unique within the solid, in the order of refinement
  std::uint32_t face = 0;  ///< index in the solid's list of faces
  int level = 0;           ///< number of splits since the face's own Bezier piece
  BezierPatch patch;       ///< domain in the net parameters (s, t) of the face's RationalForm
  double max_weight = 1.0;
  double max_coordinate = 0.0;  ///< largest |w x|, |w y|, |w z| of the net
};

/// When refinement stops.
struct RefineLimits {
  double flatness = 0.1;              ///< mm, the paper's subdivision factor
  double relative_flatness = 1e300;   ///< the same as a share of the sub-patch's diagonal; the stricter of both counts
  int max_level = 12;                 ///< splits of one Bezier piece
  std::size_t max_patches = 200'000;  ///< per face
};

struct RefineResult {
  std::vector<SubPatch> patches;
  bool capped = false;  ///< a limit on level or number stopped refinement before the sub-patches were flat
};

/// Adaptive refinement of a face's Bezier pieces (paper, step 2): each is halved in the direction in which its net
/// bends more until flat. `face` is copied into the sub-patches; ids start at `first_id`.
[[nodiscard]] RefineResult refine(std::vector<BezierPatch> pieces, const RefineLimits& limits, std::uint32_t face,
                                  std::uint32_t first_id);

}  // namespace lamella::reference
