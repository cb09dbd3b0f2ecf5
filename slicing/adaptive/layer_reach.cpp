#include "slicing/adaptive/layer_reach.h"

#include <algorithm>
#include <cmath>

namespace lamella {

namespace {

constexpr double kTouch = 1e-9;  // mm

/// For each bin the thickest layer, in bins, that has it.
std::vector<std::size_t> thickest_layers(const SlantProfile& profile, double deviation, double thickest) {
  const std::size_t count = profile.size();
  const auto most = static_cast<std::size_t>(std::max(0.0, std::floor(0.5 * thickest / profile.width() + 1e-6)));
  std::vector<std::size_t> out(count, 0);
  for (std::size_t middle = 1; middle < count; ++middle) {
    // Deviations grow with the thickness.
    std::size_t half = 0;
    std::size_t beyond = std::min(most, middle) + 1;
    while (beyond - half > 1) {
      const std::size_t next = half + (beyond - half) / 2;
      const bool keeps = profile.layer_deviation(middle - next, middle + next) <= deviation + kTouch;
      (keeps ? half : beyond) = next;
    }
    for (std::size_t bin = middle - half; bin < std::min(count, middle + half); ++bin) {
      out[bin] = std::max(out[bin], 2 * half);
    }
  }
  return out;
}

}  // namespace

LayerReach::LayerReach(const SlantProfile& profile, double deviation, double thickest)
    : bottom_(profile.bottom()), width_(profile.width()), reach_(profile.size(), 0.0) {
  if (!(deviation > 0.0)) return;
  const std::vector<std::size_t> thick = thickest_layers(profile, deviation, thickest);
  const std::size_t count = thick.size();
  for (std::size_t bin = 0; bin < count; ++bin) {
    // The neighbour begins where the layer ends, no farther than its thickness.
    std::size_t next = 0;
    for (std::size_t k = bin - std::min(bin, thick[bin]); k < std::min(count, bin + thick[bin] + 1); ++k) {
      next = std::max(next, thick[k]);
    }
    reach_[bin] = 0.5 * static_cast<double>(thick[bin] + next) * width_;
    largest_ = std::max(largest_, reach_[bin]);
  }
}

double LayerReach::at(const Interval& z) const {
  if (reach_.empty()) return 0.0;
  const auto bin = [&](double height) {
    return static_cast<std::size_t>(
        std::clamp(std::floor((height - bottom_) / width_), 0.0, static_cast<double>(reach_.size() - 1)));
  };
  const auto first = reach_.begin() + static_cast<std::ptrdiff_t>(bin(z.lo));
  return *std::max_element(first, reach_.begin() + static_cast<std::ptrdiff_t>(bin(z.hi)) + 1);
}

}  // namespace lamella
