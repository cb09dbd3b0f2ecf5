#include "model/trim.h"

#include <cmath>
#include <string>

#include "core/error.h"
#include "model/evaluate.h"
#include "model/trim_boundary.h"

namespace lamella {
namespace {

/// More turns than this in one face are not geometry, and each costs a query.
constexpr double kMaxTurns = 4096.0;

/// The whole periods by which `x` must be moved to come into [low, high].
struct Shifts {
  int first = 0;
  int last = 0;
};

Shifts shifts(double x, double low, double high, double period) {
  constexpr Shifts kNone{0, -1};
  if (!(period > 0.0)) return x >= low && x <= high ? Shifts{} : kNone;
  // So far away that a period is lost in rounding.
  if (std::abs(x - low) > 1e9 * period) return kNone;
  return {static_cast<int>(std::ceil((low - x) / period)), static_cast<int>(std::floor((high - x) / period))};
}

}  // namespace

TrimRegion::TrimRegion(const Scene& scene, FaceId face) : periods_(periods(scene.faces[face].surface)) {
  TrimBoundary boundary = trim_boundary(scene, face);
  tree_ = WindingTree(boundary.pieces, boundary.loop_begin);
  pieces_ = std::move(boundary.pieces);
  for (const BezierCurve2& piece : pieces_) bounds_.extend(control_box(piece));
  for (int i = 0; i < 2 && !pieces_.empty(); ++i) {
    if (periods_[i] > 0.0 && bounds_.sizes()[i] > kMaxTurns * periods_[i]) {
      throw GeometryError("a face that turns more than " + std::to_string(static_cast<int>(kMaxTurns)) + " times",
                          std::string("face #") + std::to_string(scene.faces[face].step_entity));
    }
  }
}

TrimRegion::Side TrimRegion::classify(const Vec2& uv, const Vec2& tolerance) const {
  return locate(uv, tolerance).side;
}

Vec2 TrimRegion::unwrap(const Vec2& uv, const Vec2& tolerance) const { return locate(uv, tolerance).uv; }

TrimRegion::Place TrimRegion::locate(const Vec2& uv, const Vec2& tolerance) const {
  Place place{Side::outside, uv};
  if (!uv.allFinite() || pieces_.empty()) return place;
  const Vec2 low = bounds_.min() - tolerance;
  const Vec2 high = bounds_.max() + tolerance;
  const Shifts u = shifts(uv[0], low[0], high[0], periods_[0]);
  const Shifts v = shifts(uv[1], low[1], high[1], periods_[1]);
  int winding = 0;
  for (int i = u.first; i <= u.last; ++i) {
    for (int j = v.first; j <= v.last; ++j) {
      const Vec2 moved = uv + Vec2(i * periods_[0], j * periods_[1]);
      const std::optional<int> turns = tree_.winding(moved, tolerance);
      if (!turns) return {Side::on_boundary, moved};
      if (*turns != 0) place.uv = moved;
      winding += *turns;
    }
  }
  // Summed over the periods, a hole that lies a period away from its outer loop still is one.
  if (winding == 0) return {Side::outside, uv};
  place.side = Side::inside;
  return place;
}

}  // namespace lamella
