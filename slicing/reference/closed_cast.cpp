#include "slicing/reference/closed_cast.h"

#include <algorithm>
#include <array>
#include <optional>

namespace lamella::reference {

namespace {

/// Steps that break exact ties, times SolidModel::smallest_step() (1e-8 of the solid's size).
constexpr std::array kTieSteps{1.0, 10.0, 100.0};
/// Sideways part of a tie step: small, so that `up` decides first, as in "z + 0, then y + 0".
constexpr double kTieSide = 0.01;
/// Steps out of the zones about inexact edges, times the zone's radius.
constexpr std::array kZoneSteps{1.2, 2.4, 4.8, 9.6};
/// Directions of those steps in (up, up x direction): none along an axis, where edges like to run.
constexpr std::array<std::array<double, 2>, 4> kZoneDirections{{{1.0, 0.3}, {-0.3, 1.0}, {-1.0, -0.3}, {0.3, -1.0}}};

/// A crossing found on a moved ray may be put back by the step times this over |n.d|: contacts up to this order.
constexpr double kMaxContact = 8.0;
/// Crossings of the same place on two rays at a distance `step` differ by step / |n.d| for a plane; twice that for a
/// face that bends.
constexpr double kMaxShift = 2.0;
/// And never by more than this share of the solid's size.
constexpr double kMaxMove = 0.1;

/// How far one cast can be trusted, best first.
enum class Grade { clean, doubtful, broken };

/// The crossings of one attempt that count: decided, in an order that alternates if there is one.
struct Attempt {
  Grade grade = Grade::broken;
  Vec3 offset = Vec3::Zero();
  std::vector<Crossing> crossings;
  std::vector<Crossing> tangencies;
  double doubt = 0.0;  ///< mm, largest zone that raised doubt
};

/// Puts crossings of equal depth into the order that alternates, where faces or shells touch. Depths within
/// `same_depth` count as equal.
void order_ties(std::vector<Crossing>& crossings, double same_depth) {
  Sense wanted = Sense::entry;
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    std::size_t next = k;
    while (next < crossings.size() && crossings[next].sense != wanted &&
           crossings[next].t - crossings[k].t <= same_depth) {
      ++next;
    }
    if (next < crossings.size() && crossings[next].t - crossings[k].t <= same_depth) {
      std::rotate(crossings.begin() + static_cast<std::ptrdiff_t>(k),
                  crossings.begin() + static_cast<std::ptrdiff_t>(next),
                  crossings.begin() + static_cast<std::ptrdiff_t>(next) + 1);
    }
    wanted = crossings[k].sense == Sense::entry ? Sense::exit : Sense::entry;
  }
}

bool alternates(const std::vector<Crossing>& crossings) {
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    if (crossings[k].sense != (k % 2 == 0 ? Sense::entry : Sense::exit)) return false;
  }
  return crossings.size() % 2 == 0;
}

Attempt attempt(const SolidModel& model, const Ray& ray, const Vec3& offset, CastScratch& scratch,
                CastCounters& counters) {
  Attempt result;
  result.offset = offset;
  result.doubt = model.find_crossings({ray.origin + offset, ray.direction}, scratch, counters);
  for (const Crossing& crossing : scratch.crossings) {
    (crossing.sense == Sense::edge ? result.tangencies : result.crossings).push_back(crossing);
  }
  order_ties(result.crossings, model.merge_distance());
  if (alternates(result.crossings)) result.grade = result.doubt > 0.0 ? Grade::doubtful : Grade::clean;
  return result;
}

/// Unit vectors across the ray: `up` without its part along the ray, and up x direction.
struct Across {
  Vec3 up;
  Vec3 side;
};

Across across(const Ray& ray, const Vec3& up) {
  Vec3 u = up - up.dot(ray.direction) * ray.direction;
  if (!(u.norm() > 1e-6)) u = ray.direction.unitOrthogonal();
  u.normalize();
  return {u, u.cross(ray.direction)};
}

/// Crossings that alternate once the odd ones are dropped: of a run of entries the first counts, of a run of exits the
/// last; what surrounds the dropped ones is uncertain.
std::vector<Crossing> repaired(const std::vector<Crossing>& crossings) {
  std::vector<Crossing> kept;
  for (const Crossing& crossing : crossings) {
    if (crossing.sense == Sense::entry) {
      if (kept.size() % 2 == 0) kept.push_back(crossing);
    } else if (kept.size() % 2 == 1) {
      kept.push_back(crossing);
    } else if (!kept.empty()) {
      kept.back() = crossing;
    }
  }
  if (kept.size() % 2 == 1) kept.pop_back();
  for (Crossing& crossing : kept) crossing.flags |= kUncertain;
  return kept;
}

/// Puts one crossing found on a ray moved aside back onto the ray itself; false where the ray itself has none nearby.
bool put_back(const SolidModel& model, const Ray& ray, double step, Crossing& crossing) {
  Vec2 uv = crossing.uv;
  double t = crossing.t;
  if (!model.refine_crossing(ray, crossing.face, uv, t)) return false;
  // Newton must not have gone to another sheet. A crossing moves by step / |n.d|; where the ray itself touches the face
  // with a contact of order p, x^p = c step and |n.d| = p c x^(p-1), so that it moves by p step / |n.d|.
  const double farthest = std::min(kMaxContact * step / model.steepness(ray, crossing), kMaxMove * model.size());
  if (!(std::abs(t - crossing.t) <= farthest)) return false;
  crossing.t = t;
  crossing.uv = uv;
  return true;
}

/// Two crossings of one face around a place where the ray itself only touches it are what moving the ray made of that
/// touch: on the ray itself they are one point.
void close_on_tangency(Crossing& first, Crossing& second, const std::vector<Crossing>& tangencies) {
  for (const Crossing& tangency : tangencies) {
    if (tangency.face != first.face) continue;
    if (tangency.t + tangency.half_t < first.t || tangency.t - tangency.half_t > second.t) continue;
    first.t = second.t = std::clamp(tangency.t, first.t, second.t);
    return;
  }
}

/// Depths on the ray itself of crossings found on a ray moved aside. Where the ray itself has no crossing nearby, the
/// moved one's depth stays: off by at most offset / |n.d|.
void put_back(const SolidModel& model, const Ray& ray, const Attempt& from, const std::vector<Crossing>& tangencies,
              std::vector<Crossing>& crossings) {
  std::vector<bool> placed;
  for (Crossing& crossing : crossings) {
    crossing.flags |= kDisplaced;
    placed.push_back(put_back(model, ray, from.offset.norm(), crossing));
  }
  for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
    if (placed[k] || placed[k + 1] || crossings[k].face != crossings[k + 1].face) continue;
    close_on_tangency(crossings[k], crossings[k + 1], tangencies);
    placed[k] = placed[k + 1] = true;
  }
  // The order of the moved ray is the right one; depths of tangencies may have met or passed each other.
  for (std::size_t k = 1; k < crossings.size(); ++k) crossings[k].t = std::max(crossings[k].t, crossings[k - 1].t);
}

/// How far along the ray a crossing may lie from one on a ray moved aside by `step`.
double allowance(const SolidModel& model, const Ray& ray, double step, const Crossing& crossing) {
  return std::min(kMaxShift * step / model.steepness(ray, crossing), kMaxMove * model.size());
}

/// Whether two lists that alternate differ only as crossings differ that were moved by `step`: every interval that
/// exactly one of them has inside is as short as the crossings at its ends allow.
bool consistent(const SolidModel& model, const Ray& ray, double step, const std::vector<Crossing>& a,
                const std::vector<Crossing>& b) {
  std::size_t i = 0;
  std::size_t j = 0;
  const Crossing* last = nullptr;
  while (i < a.size() || j < b.size()) {
    const bool from_a = j == b.size() || (i < a.size() && a[i].t <= b[j].t);
    const Crossing& next = from_a ? a[i] : b[j];
    const bool differ = i % 2 != j % 2;
    if (differ) {
      const double allowed = std::max(allowance(model, ray, step, *last), allowance(model, ray, step, next));
      if (next.t - last->t > allowed) return false;
    }
    last = &next;
    ++(from_a ? i : j);
  }
  return true;
}

void emit(const SolidModel& model, SolidId solid, const std::vector<Crossing>& crossings, SolidCast& out,
          CastCounters& counters) {
  const auto hit = [&](const Crossing& crossing) {
    return Hit{crossing.t, solid, model.face_id(crossing.face), crossing.sense, crossing.flags, crossing.uv};
  };
  for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
    const Hit in = hit(crossings[k]);
    const Hit exit = hit(crossings[k + 1]);
    // The half-open [t, t) is empty: a ray that only touches.
    if (!(in.t < exit.t)) continue;
    out.hits.push_back(in);
    out.hits.push_back(exit);
    out.spans.push_back({in.t, exit.t, solid, in.face, exit.face});
    counters.hits += 2;
    for (const Hit& one : {in, exit}) counters.uncertain_hits += (one.flags & kUncertain) != 0 ? 1 : 0;
  }
}

/// The answer that most doubtful attempts give, by the number of crossings; the earliest of them.
const Attempt* most_common(const std::vector<Attempt>& attempts) {
  const Attempt* best = nullptr;
  std::ptrdiff_t most = 0;
  for (const Attempt& one : attempts) {
    if (one.grade != Grade::doubtful) continue;
    const auto same = std::count_if(attempts.begin(), attempts.end(), [&](const Attempt& other) {
      return other.grade == Grade::doubtful && other.crossings.size() == one.crossings.size();
    });
    if (same > most) {
      most = same;
      best = &one;
    }
  }
  return best;
}

/// All attempts in turn, up to the first clean one. The first is the ray itself.
std::vector<Attempt> all_attempts(const SolidModel& model, const Ray& ray, const Vec3& up, CastScratch& scratch,
                                  CastCounters& counters, std::size_t& ties) {
  std::vector<Attempt> attempts;
  const auto try_offset = [&](const Vec3& offset) {
    attempts.push_back(attempt(model, ray, offset, scratch, counters));
    return attempts.back().grade == Grade::clean;
  };
  ties = 0;
  if (try_offset(Vec3::Zero())) return attempts;
  const Across axes = across(ray, up);
  for (const double step : kTieSteps) {
    ++ties;
    if (try_offset(step * model.smallest_step() * (axes.up + kTieSide * axes.side))) return attempts;
  }
  double zone = kTieSteps.back() * model.smallest_step();
  for (const Attempt& one : attempts) zone = std::max(zone, one.doubt);
  for (const double step : kZoneSteps) {
    for (const auto& [a, b] : kZoneDirections) {
      if (try_offset(step * zone * (a * axes.up + b * axes.side))) return attempts;
    }
  }
  return attempts;
}

}  // namespace

void cast_closed(const SolidModel& model, SolidId solid, const Ray& ray, const Vec3& up, CastScratch& scratch,
                 SolidCast& out, CastCounters& counters) {
  out.solid = solid;
  out.hits.clear();
  out.spans.clear();
  if (!model.meets_box(ray)) return;
  ++counters.rays;
  std::size_t ties = 0;
  std::vector<Attempt> attempts = all_attempts(model, ray, up, scratch, counters, ties);
  const std::size_t last = attempts.size() - 1;
  const Attempt* chosen = &attempts[last];
  const Attempt& first = attempts.front();
  if (chosen->grade == Grade::clean) {
    if (last > 0) ++(last <= ties ? counters.tie_rays : counters.tolerance_rays);
    // Confirmed by a clean ray nearby, the crossings of the ray itself are the more exact ones. Not after a tie step,
    // whose side is the rule.
    if (last > ties && first.grade == Grade::doubtful &&
        consistent(model, ray, chosen->offset.norm(), first.crossings, chosen->crossings)) {
      chosen = &first;
    }
  } else if (const Attempt* common = most_common(attempts)) {
    ++counters.tolerance_rays;
    chosen = common;
  } else {
    chosen = &attempts.front();
  }
  std::vector<Crossing> crossings = chosen->crossings;
  if (chosen->grade == Grade::broken) {
    crossings = repaired(crossings);
    ++(crossings.empty() ? counters.unclosed_rays : counters.repaired_rays);
  }
  if (!chosen->offset.isZero(0.0)) put_back(model, ray, *chosen, first.tangencies, crossings);
  emit(model, solid, crossings, out, counters);
}

}  // namespace lamella::reference
