#include "export/uniform_z.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"

namespace lamella {

namespace {

constexpr double kDisplaced = 1e-6;  // of a slice; no voxel is displaced by more than that
constexpr int kMostParts = 100;      // that the thinnest layer is divided into
constexpr double kMostSlices = 1e7;

double thinnest(const LayerPlan& plan) {
  double least = plan.layers.front().z_top - plan.layers.front().z_bottom;
  for (const LayerSpan& span : plan.layers) least = std::min(least, span.z_top - span.z_bottom);
  return least;
}

}  // namespace

UniformZ::UniformZ(const LayerPlan& plan, std::optional<double> z_pitch, std::string_view format)
    : bottom_(plan.layers.empty() ? plan.grid.origin.z() : plan.layers.front().z_bottom),
      pitch_(z_pitch.value_or(plan.grid.pitch.z())) {
  first_.assign(1, 0);
  if (plan.layers.empty()) return;
  if (z_pitch) {
    sample(plan, format);
  } else {
    divide(plan, format);
  }
  count_ = std::max(count_, first_.back());
}

void UniformZ::divide(const LayerPlan& plan, std::string_view format) {
  const double least = thinnest(plan);
  const double nominal = plan.grid.pitch.z();
  if (std::abs(least - nominal) <= kDisplaced * nominal && fits(plan, nominal)) return;
  for (int parts = 1; parts <= kMostParts; ++parts) {
    // A quantum that is off by rounding would add up over the layers.
    const double slices = std::round((plan.layers.back().z_top - bottom_) / (least / parts));
    if (fits(plan, (plan.layers.back().z_top - bottom_) / slices)) return;
  }
  throw UsageError("layers of different thickness do not fit the uniform slices of " + std::string(format), "--z-pitch",
                   "give the thickness of slices with --z-pitch, or slice with a uniform --layer-height");
}

/// Sets the slices of each layer if all borders are multiples of `quantum` above the bottom.
bool UniformZ::fits(const LayerPlan& plan, double quantum) {
  if (!((plan.layers.back().z_top - bottom_) / quantum <= kMostSlices)) return false;
  pitch_ = quantum;
  first_.assign(1, 0);
  for (const LayerSpan& span : plan.layers) {
    const double border = (span.z_top - bottom_) / pitch_;
    if (!(std::abs(border - std::round(border)) <= kDisplaced)) return false;
    first_.push_back(static_cast<std::int64_t>(std::round(border)));
    if (first_.back() <= first_[first_.size() - 2]) return false;
  }
  return true;
}

void UniformZ::sample(const LayerPlan& plan, std::string_view format) {
  const double height = plan.layers.back().z_top - bottom_;
  const double slices = std::max(1.0, std::ceil(height / pitch_ - kDisplaced));
  if (!(pitch_ > 0.0 && std::isfinite(pitch_) && slices <= kMostSlices)) {
    throw UsageError("the slices of " + std::string(format) + " must have a thickness that gives at most 10^7 of them",
                     "--z-pitch", "give a thickness in mm");
  }
  count_ = static_cast<std::int64_t>(slices);
  for (const LayerSpan& span : plan.layers) {
    const double middles = std::ceil((span.z_top - bottom_) / pitch_ - 0.5);  // of so many slices lie below
    first_.push_back(std::clamp(static_cast<std::int64_t>(middles), first_.back(), count_));
  }
}

}  // namespace lamella
