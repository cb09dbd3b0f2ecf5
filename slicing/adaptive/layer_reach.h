#pragma once

#include <vector>

#include "slicing/adaptive/slant_profile.h"

namespace lamella {

/// How far apart the middles of two neighbouring layers may be: what the profile lets layers have there.
class LayerReach {
 public:
  /// Layers are at most `thickest` mm thick and deviate by at most `deviation` mm. The profile must be finished.
  LayerReach(const SlantProfile& profile, double deviation, double thickest);

  /// Largest distance in mm between the middles of a layer that has one of these heights and a neighbour.
  [[nodiscard]] double at(const Interval& z) const;
  [[nodiscard]] double largest() const { return largest_; }

 private:
  double bottom_;
  double width_;
  double largest_ = 0.0;
  std::vector<double> reach_;  ///< mm, of each bin
};

}  // namespace lamella
