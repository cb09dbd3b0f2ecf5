#include "slicing/reference/face_patches.h"

#include <algorithm>
#include <cmath>

#include "model/evaluate.h"

namespace lamella::reference {

namespace {

/// The least widening, as a share of the bounds: rounding of the pcurves.
constexpr double kLeastPad = 1e-9;
/// The largest, for faces that are short in a direction or degenerate.
constexpr double kLargestPad = 0.05;
constexpr double kLargestExtension = 1e-3;
constexpr double kWholePeriod = 1.0 - 1e-9;

/// Mean |S_u| and |S_v| over the bounds, mm per unit of parameter.
Vec2 mean_speed(const Face& face) {
  constexpr int kSamples = 4;
  Vec2 sum = Vec2::Zero();
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const Vec2 share((i + 0.5) / kSamples, (j + 0.5) / kSamples);
      const Vec2 uv = face.uv_bounds.min() + face.uv_bounds.sizes().cwiseProduct(share);
      const SurfacePoint point = evaluate(face.surface, uv);
      sum += Vec2(point.du.norm(), point.dv.norm());
    }
  }
  return sum / (kSamples * kSamples);
}

Box2 padded_bounds(const Face& face, double margin) {
  const Vec2 speed = mean_speed(face);
  const Vec2 period = periods(face.surface);
  Box2 bounds = face.uv_bounds;
  for (int k = 0; k < 2; ++k) {
    const double width = bounds.sizes()[k];
    if (period[k] > 0.0 && width >= kWholePeriod * period[k]) continue;
    double pad = speed[k] > 0.0 ? margin / speed[k] : 0.0;
    pad = std::clamp(pad, kLeastPad * width, kLargestPad * width);
    if (period[k] > 0.0) pad = std::min(pad, 0.5 * (period[k] - width));
    bounds.min()[k] -= pad;
    bounds.max()[k] += pad;
  }
  return bounds;
}

/// Extends the patches at the ends of a coordinate to `wanted`, by extrapolating their polynomials.
template <class SplitFn>
void extend(std::vector<BezierPatch>& patches, Interval BezierPatch::*side, const Interval& wanted, SplitFn split) {
  double lo = (patches.front().*side).lo;
  double hi = (patches.front().*side).hi;
  for (const BezierPatch& patch : patches) {
    lo = std::min(lo, (patch.*side).lo);
    hi = std::max(hi, (patch.*side).hi);
  }
  for (BezierPatch& patch : patches) {
    const double most = kLargestExtension * (patch.*side).length();
    if ((patch.*side).lo == lo && wanted.lo < lo) patch = split(patch, std::max(wanted.lo, lo - most)).second;
    if ((patch.*side).hi == hi && wanted.hi > hi) patch = split(patch, std::min(wanted.hi, hi + most)).first;
  }
}

}  // namespace

RationalForm padded_form(const Face& face, double margin) {
  const Box2 bounds = padded_bounds(face, margin);
  RationalForm form = rational_form(face.surface, bounds);
  if (form.patches.empty()) return form;
  if (form.map_u == RationalForm::Map::same) {
    extend(form.patches, &BezierPatch::u, {bounds.min().x(), bounds.max().x()}, split_u);
  }
  if (form.map_v == RationalForm::Map::same) {
    extend(form.patches, &BezierPatch::v, {bounds.min().y(), bounds.max().y()}, split_v);
  }
  return form;
}

}  // namespace lamella::reference
