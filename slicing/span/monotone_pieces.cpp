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

double find_crossing(const Curve3& curve, const MonotonePiece& piece, double z, double guess) {
  if (const auto* line = std::get_if<Line<3>>(&curve)) {
    const double slope = line->direction.z();
    const double t = slope == 0.0 ? piece.t0 : (z - line->origin.z()) / slope;
    return std::clamp(t, piece.t0, piece.t1);
  }
  const double sign = piece.rises() ? 1.0 : -1.0;
  double lo = piece.t0;
  double hi = piece.t1;
  double t = guess > lo && guess < hi ? guess : lo + (hi - lo) * (z - piece.z0) / (piece.z1 - piece.z0);
  // Newton's iteration, kept in a shrinking bracket: the curve's own heights rise (times sign) from lo to hi.
  for (int i = 0; i < 100; ++i) {
    const CurvePoint<3> at = evaluate<3>(curve, t);
    const double excess = sign * (at.point.z() - z);
    // Rounding of the curve's own coordinates: a few ulp.
    if (std::abs(excess) <= 4e-16 * (1.0 + std::abs(z))) return t;
    (excess < 0.0 ? lo : hi) = t;
    double next = t - sign * excess / at.dt.z();
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    const double step = std::abs(next - t);
    t = next;
    if (step <= 4e-16 * std::max(std::abs(lo), std::abs(hi))) break;
    if (!(hi - lo > 1e-15 * std::max(std::abs(lo), std::abs(hi)))) break;
  }
  return t;
}

}  // namespace lamella::span
