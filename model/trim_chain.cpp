#include "model/trim_chain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/tolerances.h"
#include "model/evaluate.h"

namespace lamella {
namespace {

constexpr double kNowhere = std::numeric_limits<double>::infinity();

/// A chain that runs once round the surface along `axis`.
struct Ring {
  Chain chain;
  int axis = 0;
  bool region_above = false;  ///< the region lies towards larger values of the other coordinate
  double level = 0.0;         ///< middle of the other coordinate
};

/// Nothing for a chain that closes, or winds in a way no face does.
std::optional<Ring> as_ring(const Face& face, const Chain& chain) {
  const Vec2 period = periods(face.surface);
  const Vec2 begin = begin_of(chain.front());
  const Vec2 end = end_of(chain.back());
  const Vec2 jump = whole_periods(begin, end, period);
  const int axis = std::abs(jump[0]) > 0.0 ? 0 : 1;
  const bool once = std::abs(jump[axis]) == period[axis] && jump[1 - axis] == 0.0;
  if (jump.isZero(0.0) || !once || is_degenerate_step(face, begin, jump)) return std::nullopt;
  Box2 box;
  for (const BezierCurve2& piece : chain) box.extend(control_box(piece));
  // Left of a run along +u is +v, left of one along +v is -u.
  const bool above = (jump[axis] > 0.0) == (axis == 0);
  return Ring{chain, axis, above, box.center()[1 - axis]};
}

/// How far `upper` lies above `lower`, over as many periods as it takes; infinite if they can't bound one region.
double distance_above(const Ring& lower, const Ring& upper, const Vec2& period) {
  if (upper.axis != lower.axis || upper.region_above) return kNowhere;
  const double distance = upper.level - lower.level;
  if (distance > 0.0) return distance;
  const double other = period[1 - lower.axis];
  return other > 0.0 ? distance + other * (1.0 + std::floor(-distance / other)) : kNowhere;
}

/// Joins two rings by a seam that is run through in both senses, a period apart.
Chain join(Ring lower, Ring upper, const Vec2& period) {
  const double distance = distance_above(lower, upper, period);
  Vec2 offset = Vec2::Zero();
  offset[1 - lower.axis] = lower.level + distance - upper.level;
  const int axis = lower.axis;
  const double gap = end_of(lower.chain.back())[axis] - begin_of(upper.chain.front())[axis];
  offset[axis] = period[axis] * std::round(gap / period[axis]);
  move_by(upper.chain, offset);
  Chain chain = std::move(lower.chain);
  bridge(chain, begin_of(upper.chain.front()));
  chain.insert(chain.end(), upper.chain.begin(), upper.chain.end());
  return chain;
}

/// Where the region of an unpaired ring ends: at a pole or an apex, else at the face's bounds, if they lie beyond it.
std::optional<double> natural_end(const Face& face, const Ring& ring) {
  const double side = ring.region_above ? 1.0 : -1.0;
  std::vector<double> ends;
  if (std::holds_alternative<Sphere>(face.surface)) ends.push_back(side * 0.5 * kPi);
  if (const auto* cone = std::get_if<Cone>(&face.surface)) ends.push_back(-cone->radius / std::sin(cone->half_angle));
  if (!face.uv_bounds.isEmpty()) {
    const int other = 1 - ring.axis;
    ends.push_back(ring.region_above ? face.uv_bounds.max()[other] : face.uv_bounds.min()[other]);
  }
  for (const double end : ends) {
    if (std::isfinite(end) && side * (end - ring.level) > 0.0) return end;
  }
  return std::nullopt;
}

Chain close_alone(const Face& face, Ring ring) {
  const Vec2 begin = begin_of(ring.chain.front());
  if (const auto end = natural_end(face, ring)) {
    Vec2 corner = end_of(ring.chain.back());
    corner[1 - ring.axis] = *end;
    bridge(ring.chain, corner);
    corner[ring.axis] = begin[ring.axis];
    bridge(ring.chain, corner);
  }
  bridge(ring.chain, begin);
  return std::move(ring.chain);
}

/// Index of the nearest ring above `lower`, or rings.size().
std::size_t nearest_above(const std::vector<Ring>& rings, const Ring& lower, const Vec2& period) {
  std::size_t best = rings.size();
  double least = kNowhere;
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const double distance = distance_above(lower, rings[i], period);
    if (distance < least) {
      least = distance;
      best = i;
    }
  }
  return best;
}

std::vector<Chain> close_rings(const Face& face, std::vector<Ring> rings) {
  const Vec2 period = periods(face.surface);
  std::vector<Chain> closed;
  for (auto lower = rings.begin(); lower != rings.end();) {
    const std::size_t upper = lower->region_above ? nearest_above(rings, *lower, period) : rings.size();
    if (upper == rings.size()) {
      ++lower;
      continue;
    }
    closed.push_back(join(*lower, rings[upper], period));
    bridge(closed.back(), begin_of(closed.back().front()));
    const auto [first, second] = std::minmax({static_cast<std::size_t>(lower - rings.begin()), upper});
    rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(second));
    rings.erase(rings.begin() + static_cast<std::ptrdiff_t>(first));
    lower = rings.begin();
  }
  for (Ring& ring : rings) closed.push_back(close_alone(face, std::move(ring)));
  return closed;
}

}  // namespace

Vec2 begin_of(const BezierCurve2& piece) { return piece.net.front().head<2>() / piece.net.front()[2]; }

Vec2 end_of(const BezierCurve2& piece) { return piece.net.back().head<2>() / piece.net.back()[2]; }

BezierCurve2 straight(const Vec2& begin, const Vec2& end) {
  return {{0.0, 1.0}, {Vec3(begin[0], begin[1], 1.0), Vec3(end[0], end[1], 1.0)}};
}

void bridge(Chain& chain, const Vec2& to) {
  const Vec2 from = end_of(chain.back());
  if (from != to) chain.push_back(straight(from, to));
}

void move_by(Chain& chain, const Vec2& offset) {
  if (offset.isZero(0.0)) return;
  for (BezierCurve2& piece : chain) {
    for (Vec3& point : piece.net) point.head<2>() += point[2] * offset;
  }
}

Vec2 whole_periods(const Vec2& from, const Vec2& to, const Vec2& period) {
  Vec2 result = Vec2::Zero();
  for (int i = 0; i < 2; ++i) {
    if (period[i] > 0.0) result[i] = period[i] * std::round((to[i] - from[i]) / period[i]);
  }
  return result;
}

bool is_degenerate_step(const Face& face, const Vec2& at, const Vec2& step) {
  const SurfacePoint point = evaluate(face.surface, at);
  const double length = (point.du * step[0] + point.dv * step[1]).norm();
  return length <= std::max(face.tolerance, tolerance::kMinGap);
}

std::vector<Chain> close_chains(const Face& face, std::vector<Chain> chains) {
  std::vector<Chain> closed;
  std::vector<Ring> rings;
  for (Chain& chain : chains) {
    if (auto ring = as_ring(face, chain)) {
      rings.push_back(std::move(*ring));
    } else {
      bridge(chain, begin_of(chain.front()));
      closed.push_back(std::move(chain));
    }
  }
  for (Chain& chain : close_rings(face, std::move(rings))) closed.push_back(std::move(chain));
  return closed;
}

}  // namespace lamella
