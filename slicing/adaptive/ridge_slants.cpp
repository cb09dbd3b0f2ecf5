#include "slicing/adaptive/ridge_slants.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lamella {

namespace {

constexpr int kMaxDepth = 14;
constexpr std::size_t kMaxPieces = 20000;
/// Radians. Wider cones, of normals that turn about the line's axis say, don't tell by their axes how the edge is.
constexpr double kNarrow = 0.05;

/// A part of the line.
struct Piece {
  Interval share{0.0, 1.0};
  int depth = 0;
};

/// A bound and how much of it may be due to the length of the piece.
struct Bound {
  double slant = 1.0;
  double doubt = 0.0;
};

Bound slant_of(const NormalCone& a, const NormalCone& b) {
  const double bound = largest_slant_between(a, b);
  return {bound, bound - largest_slant_between({a.axis, 0.0}, {b.axis, 0.0})};
}

/// Faces less slanted than that, about a degree, look neither up nor down.
constexpr double kUpright = 0.02;

/// Whether one face looks up and the other down.
bool is_wedge(const NormalCone& a, const NormalCone& b) {
  return a.axis.z() * b.axis.z() < 0.0 && std::min(std::abs(a.axis.z()), std::abs(b.axis.z())) > kUpright;
}

/// The same for cones of any width: false is certain.
bool may_be_wedge(const NormalCone& a, const NormalCone& b) {
  if (std::min(largest_slant(a), largest_slant(b)) <= kUpright) return false;
  const auto looks_one_way = [](const NormalCone& cone) {
    return cone.half_angle < 0.5 * kPi && std::abs(cone.axis.z()) > std::sin(cone.half_angle);
  };
  return !(looks_one_way(a) && looks_one_way(b) && a.axis.z() * b.axis.z() > 0.0);
}

/// Whether the tip of a wedge recedes by more than is allowed in whatever layers. A tip beside a level face recedes
/// along the other.
bool is_too_sharp(const NormalCone& a, const NormalCone& b, const WedgeRule& rule) {
  const auto recedes_too_far = [&](const NormalCone& cone) {
    return std::abs(cone.axis.z()) < kLevel && receding_rate(largest_slant(cone)) > rule.steepest;
  };
  return recedes_too_far(a) || recedes_too_far(b);
}

}  // namespace

double receding_rate(double slant) {
  return slant < 1.0 ? slant / std::sqrt(1.0 - slant * slant) : std::numeric_limits<double>::infinity();
}

EdgeSlants ridge_slants(const RidgeLine& line, const SlantProfile& known, const WedgeRule& wedges) {
  EdgeSlants out;
  std::vector<Piece> open{{}};
  std::size_t pieces = 0;
  while (!open.empty()) {
    const Piece piece = open.back();
    open.pop_back();
    ++pieces;
    if (line.is_outside && line.is_outside(piece.share)) continue;
    const Interval z = heights_of(line.box(piece.share));
    const NormalCone a = line.first(piece.share);
    const NormalCone b = line.second(piece.share);
    const Bound bound = slant_of(a, b);
    const bool is_narrow = std::max(a.half_angle, b.half_angle) <= kNarrow;
    const bool is_blunt = is_narrow ? !is_wedge(a, b) : !may_be_wedge(a, b);
    const bool tells_nothing = bound.slant <= known.least_slant(z) + kSlantAccuracy && is_blunt;
    // Without doubt the normals are nearly the same all along the piece, and so is the slant.
    const bool is_done = tells_nothing || (is_narrow && bound.doubt <= kSlantAccuracy);
    if (is_done || piece.depth >= kMaxDepth || pieces + open.size() > kMaxPieces) {
      out.parts.push_back({z, bound.slant});
      if (is_wedge(a, b) && is_too_sharp(a, b, wedges)) out.is_too_sharp = true;
      continue;
    }
    const double middle = piece.share.middle();
    open.push_back({{piece.share.lo, middle}, piece.depth + 1});
    open.push_back({{middle, piece.share.hi}, piece.depth + 1});
  }
  return out;
}

}  // namespace lamella
