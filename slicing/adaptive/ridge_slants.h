#pragma once

#include <functional>

#include "model/normal_cone.h"
#include "slicing/adaptive/slant_profile.h"

namespace lamella {

/// What thin places and wedges, where a face that looks up meets one that looks down, may lose: layers cut off their
/// tips.
struct WedgeRule {
  double deviation = 0.0;  ///< mm, that is allowed
  double steepest = 0.0;   ///< mm that a tip may recede by per mm of half a layer; what is beyond can't be kept
  double thickest = 0.0;   ///< mm, of layers
};

/// A line where two parts of a surface meet, both ends of it at shares 0 and 1. Shares are asked for as an interval.
struct RidgeLine {
  std::function<Box3(const Interval&)> box;           ///< mm
  std::function<NormalCone(const Interval&)> first;   ///< normals of one side
  std::function<NormalCone(const Interval&)> second;  ///< and of the other
  std::function<bool(const Interval&)> is_outside{};  ///< of what there is of the surface; none: never
};

struct EdgeSlants {
  std::vector<Slant> parts;
  bool is_too_sharp = false;  ///< a wedge of which more than the allowed deviation may be cut off
};

/// Faces more slanted than that are level.
inline constexpr double kLevel = 0.9999;

/// What recedes along a surface of this slant per mm of height: the tangent of its angle to the vertical, infinite
/// where it is level.
[[nodiscard]] double receding_rate(double slant);

/// Parts that cover the line, with bounds of the slant of what lies between the normals of its two sides. Where
/// `known`, the slants of the faces, has as much anyway, parts may be long and bounds coarse.
[[nodiscard]] EdgeSlants ridge_slants(const RidgeLine& line, const SlantProfile& known, const WedgeRule& wedges);

}  // namespace lamella
