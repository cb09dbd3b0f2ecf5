#include "slicing/span/monotone_pieces.h"

#include <algorithm>
#include <cmath>

#include "model/curve_extrema.h"
#include "model/evaluate.h"

namespace lamella::span {

namespace {

/// Extrema that stand out by less are rounding.
constexpr double kProminence = 1e-9;  // mm

struct Sample {
  double t;
  double z;
};

/// Drops inner samples where the curve doesn't turn.
void drop_passages(std::vector<Sample>& samples) {
  std::vector<Sample> kept{samples.front()};
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    if ((samples[i].z - kept.back().z) * (samples[i + 1].z - samples[i].z) < 0.0) kept.push_back(samples[i]);
  }
  kept.push_back(samples.back());
  samples = std::move(kept);
}

/// Removes one turn of too little prominence; false if there is none.
bool drop_shallow_turn(std::vector<Sample>& samples) {
  for (std::size_t i = 0; i + 1 < samples.size() && samples.size() > 2; ++i) {
    if (std::abs(samples[i + 1].z - samples[i].z) > kProminence) continue;
    const auto first = samples.begin() + static_cast<std::ptrdiff_t>(i == 0 ? 1 : i);
    const bool both = i > 0 && i + 2 < samples.size();
    samples.erase(first, first + (both ? 2 : 1));
    return true;
  }
  return false;
}

}  // namespace

std::vector<MonotonePiece> monotone_pieces(const Curve3& curve, Interval range, double z_begin, double z_end) {
  std::vector<double> parameters = critical_parameters(curve, range, Vec3::UnitZ());
  std::sort(parameters.begin(), parameters.end());
  std::vector<Sample> samples{{range.lo, z_begin}};
  for (const double t : parameters) {
    if (t > samples.back().t) samples.push_back({t, evaluate<3>(curve, t).point.z()});
  }
  samples.push_back({range.hi, z_end});
  drop_passages(samples);
  while (drop_shallow_turn(samples)) drop_passages(samples);
  std::vector<MonotonePiece> pieces;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    pieces.push_back({samples[i].t, samples[i + 1].t, samples[i].z, samples[i + 1].z});
  }
  return pieces;
}

Crossing find_crossing(const SectionCurve<3>& curve, const MonotonePiece& piece, double z, double guess) {
  if (const Line<3>* line = curve.line()) {
    const double slope = line->direction.z();
    const double t = std::clamp(slope == 0.0 ? piece.t0 : (z - line->origin.z()) / slope, piece.t0, piece.t1);
    return {t, {line->origin + t * line->direction, line->direction}};
  }
  const double sign = piece.rises() ? 1.0 : -1.0;
  double lo = piece.t0;
  double hi = piece.t1;
  const double smallest = 4e-16 * std::max(std::abs(lo), std::abs(hi));
  double t = guess > lo && guess < hi ? guess : lo + (hi - lo) * (z - piece.z0) / (piece.z1 - piece.z0);
  double last_step = 0.0;
  double step_before = hi - lo;
  // Newton's iteration, kept in a shrinking bracket: the curve's own heights rise (times sign) from lo to hi. Over a
  // knot it may go to and fro for ever: steps must become shorter, or the bracket is halved.
  for (int i = 0; i < 200; ++i) {
    const CurvePoint2<3> at = curve.evaluate(t);
    const double excess = sign * (at.point.z() - z);
    // Rounding of the curve's own coordinates: a few ulp.
    if (std::abs(excess) <= 4e-16 * (1.0 + std::abs(z))) return {t, {at.point, at.dt}};
    (excess < 0.0 ? lo : hi) = t;
    double next = t - sign * excess / at.dt.z();
    const bool is_newton = next > lo && next < hi && 2.0 * std::abs(next - t) <= std::abs(step_before);
    if (!is_newton) next = 0.5 * (lo + hi);
    const double step = next - t;
    t = next;
    step_before = i == 0 ? step_before : last_step;
    // What is left after a step of Newton's shrinks with its square: the last two foretell the next one.
    const double ratio = step / last_step;
    last_step = step;
    const bool is_last = is_newton && std::abs(step) * ratio * ratio <= smallest;
    if (is_last || std::abs(step) <= smallest || !(hi - lo > smallest)) {
      return {t, {at.point + step * (at.dt + 0.5 * step * at.dtt), at.dt + step * at.dtt}};
    }
  }
  const CurvePoint2<3> at = curve.evaluate(t);
  return {t, {at.point, at.dt}};
}

}  // namespace lamella::span
