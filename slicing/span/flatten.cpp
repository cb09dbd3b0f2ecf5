#include "slicing/span/flatten.h"

#include <algorithm>
#include <cmath>

#include "slicing/span/quintic.h"

namespace lamella::span {

namespace {

/// Bound against chord errors near zero.
constexpr int kMaxChords = 1 << 20;

/// The polynomial s -> c(t0 + s width), by Taylor's shift.
Quintic restricted(Quintic c, double t0, double width) {
  for (int k = 0; k < 5; ++k) {
    for (int i = 4; i >= k; --i) c[i] += t0 * c[i + 1];
  }
  double power = 1.0;
  for (double& coefficient : c) {
    coefficient *= power;
    power *= width;
  }
  return c;
}

/// Whether the stretch runs forward along its chord all the way, so that no point lies beyond the chord's ends.
bool runs_forward(const ArcPiece& part, const Vec2& chord) {
  const auto x = slope_net(part.x);
  const auto y = slope_net(part.y);
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(chord.dot(Vec2(x[i], y[i])) >= 0.0)) return false;
  }
  return true;
}

}  // namespace

double chord_distance(const ArcPiece& piece, double t0, double t1) {
  const ArcPiece part{restricted(piece.x, t0, t1 - t0), restricted(piece.y, t0, t1 - t0)};
  const auto x = bend_net(part.x);
  const auto y = bend_net(part.y);
  const Vec2 chord = part.at(1.0) - part.at(0.0);
  const double length = chord.norm();
  const bool forward = length > 0.0 && runs_forward(part, chord);
  const Vec2 normal = forward ? Vec2(Vec2(-chord.y(), chord.x()) / length) : Vec2(Vec2::Zero());
  // What vanishes at 0 and 1 is at most 1/8 of its largest second derivative: this holds for the distance from the
  // chord's line, and where the stretch turns back for the distance from the chord's point of the same parameter.
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec2 bend(x[i], y[i]);
    largest = std::max(largest, forward ? std::abs(normal.dot(bend)) : bend.norm());
  }
  return largest / 8.0;
}

void flatten(const ArcPiece& piece, double chord_error, std::vector<Vec2>& points) {
  const auto holds = [&](int count) {
    for (int i = 0; i < count; ++i) {
      const double step = 1.0 / count;
      if (chord_distance(piece, i * step, (i + 1) * step) > chord_error) return false;
    }
    return true;
  };
  // The distance falls with the square of the number of chords, once they are short.
  const double whole = std::sqrt(chord_distance(piece, 0.0, 1.0) / chord_error);
  int count = std::max(1, static_cast<int>(std::ceil(std::min(whole, static_cast<double>(kMaxChords)))));
  while (count < kMaxChords && !holds(count)) count += 1 + count / 8;
  for (int i = 1; i < count; ++i) points.push_back(piece.at(static_cast<double>(i) / count));
}

}  // namespace lamella::span
