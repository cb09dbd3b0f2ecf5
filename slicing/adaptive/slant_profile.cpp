#include "slicing/adaptive/slant_profile.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lamella {

namespace {

/// mm. Parts reach no farther into a bin than heights are rounded: the bound is good to that.
constexpr double kTouch = 1e-9;
/// Of a bin: thinner parts are levels.
constexpr double kThin = 1e-3;

}  // namespace

SlantProfile::SlantProfile(double bottom, double width, std::size_t count)
    : bottom_(bottom), width_(width), bins_(count, 0.0), upper_(count, 0.0), lower_(count, 0.0) {}

std::size_t SlantProfile::bin_of(double z) const {
  const double bin = std::floor((z - bottom_) / width_);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(bins_.size() - 1)));
}

void SlantProfile::add(const Slant& part) {
  const double top = height(bins_.size());
  if (bins_.empty() || part.z.hi < bottom_ || part.z.lo > top) return;
  if (part.z.length() <= kThin * width_) {
    levels_.push_back(part);
    return;
  }
  raise(bins_, part);
}

void SlantProfile::add_thin(const Slant& part, LayerHalf half) {
  const double top = height(bins_.size());
  if (bins_.empty() || part.z.hi < bottom_ || part.z.lo > top) return;
  raise(half == LayerHalf::upper ? upper_ : lower_, part);
}

void SlantProfile::raise(std::vector<double>& bins, const Slant& part) const {
  const double lo = part.z.lo + kTouch;
  const double hi = part.z.hi - kTouch;
  const std::size_t last = bin_of(std::max(lo, hi));
  for (std::size_t bin = bin_of(lo); bin <= last; ++bin) bins[bin] = std::max(bins[bin], part.slant);
}

void SlantProfile::finish() {
  const auto lower = [](const Slant& a, const Slant& b) {
    return a.z.lo != b.z.lo ? a.z.lo < b.z.lo : a.z.hi != b.z.hi ? a.z.hi < b.z.hi : a.slant > b.slant;
  };
  std::sort(levels_.begin(), levels_.end(), lower);
  // Of levels at one height the most slanted counts.
  const auto same = [](const Slant& a, const Slant& b) { return a.z.lo == b.z.lo && a.z.hi == b.z.hi; };
  levels_.erase(std::unique(levels_.begin(), levels_.end(), same), levels_.end());
  std::vector<Slant> telling;
  for (const Slant& level : levels_) {
    if (level.slant > bins_[bin_of(level.z.lo)] || level.slant > bins_[bin_of(level.z.hi)]) telling.push_back(level);
  }
  levels_ = std::move(telling);
  first_level_.assign(bins_.size() + 1, 0);
  for (const Slant& level : levels_) ++first_level_[bin_of(level.z.lo) + 1];
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) first_level_[bin + 1] += first_level_[bin];
}

double SlantProfile::slant(std::size_t bin) const {
  double most = bins_[bin];
  for (std::size_t l = first_level_[bin]; l < first_level_[bin + 1]; ++l) most = std::max(most, levels_[l].slant);
  return most;
}

double SlantProfile::least_slant(const Interval& z) const {
  if (bins_.empty()) return 0.0;
  double least = 1.0;
  const std::size_t last = bin_of(std::max(z.lo, z.hi - kTouch));
  for (std::size_t bin = bin_of(std::min(z.hi, z.lo + kTouch)); bin <= last; ++bin) least = std::min(least, bins_[bin]);
  return least;
}

double SlantProfile::least_rate(const Interval& z, LayerHalf half) const {
  if (bins_.empty()) return 0.0;
  const std::vector<double>& thin = half == LayerHalf::upper ? upper_ : lower_;
  double least = std::numeric_limits<double>::infinity();
  const std::size_t last = bin_of(std::max(z.lo, z.hi - kTouch));
  for (std::size_t bin = bin_of(std::min(z.hi, z.lo + kTouch)); bin <= last; ++bin) {
    least = std::min(least, std::max(bins_[bin], thin[bin]));
  }
  return least;
}

/// From the middle up, the distance to the surface grows by at most the largest slant met since (eq. 2).
double SlantProfile::upward(std::size_t begin, std::size_t end) const {
  double grown = 0.0;
  double most = 0.0;
  for (std::size_t bin = begin; bin < end; ++bin) {
    if (bin >= bins_.size()) {
      grown += most * width_ * static_cast<double>(end - bin);
      break;
    }
    double z = height(bin);
    most = std::max({most, bins_[bin], upper_[bin]});
    for (std::size_t l = first_level_[bin]; l < first_level_[bin + 1]; ++l) {
      const double at = std::clamp(levels_[l].z.lo, z, height(bin + 1));
      grown += most * (at - z);
      z = at;
      most = std::max(most, levels_[l].slant);
    }
    grown += most * (height(bin + 1) - z);
  }
  return grown;
}

/// The same from bin `end` - 1 down to `begin`.
double SlantProfile::downward(std::size_t begin, std::size_t end) const {
  double grown = 0.0;
  double most = 0.0;
  for (std::size_t bin = std::min(end, bins_.size()); bin-- > begin;) {
    double z = height(bin + 1);
    most = std::max({most, bins_[bin], lower_[bin]});
    for (std::size_t l = first_level_[bin + 1]; l-- > first_level_[bin];) {
      const double at = std::clamp(levels_[l].z.hi, height(bin), z);
      grown += most * (z - at);
      z = at;
      most = std::max(most, levels_[l].slant);
    }
    grown += most * (z - height(bin));
  }
  return grown;
}

double SlantProfile::layer_deviation(std::size_t begin, std::size_t end) const {
  const std::size_t middle = begin + (end - begin) / 2;
  return std::max(upward(middle, end), downward(begin, middle));
}

}  // namespace lamella
