#include "slicing/combine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "slicing/interface_policy.h"

namespace lamella {

namespace {

/// `value` to seven significant digits; what is not a number counts as infinitely large.
double rounded_volume(double value) {
  if (!std::isfinite(value)) return std::numeric_limits<double>::infinity();
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 6.0);
  return std::round(value / unit) * unit;
}

/// Bounds as one sortable value; an empty or undefined box becomes zeros.
std::array<double, 6> corners(const Box3& box) {
  if (!box.min().allFinite() || !box.max().allFinite()) return {};
  return {box.min().x(), box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z()};
}

/// A span's begin or end on the row.
struct Event {
  double x = 0.0;
  std::uint32_t span = 0;
  bool is_begin = false;
};

/// Walks the elementary intervals of a row from left to right.
class RowSweep {
 public:
  RowSweep(std::span<const Span> spans, const CombineRules& rules) : spans_(spans), rules_(rules) {
    events_.reserve(2 * spans.size());
    for (std::uint32_t i = 0; i < spans.size(); ++i) {
      events_.push_back({spans[i].begin, i, true});
      events_.push_back({spans[i].end, i, false});
    }
    std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) { return a.x < b.x; });
  }

  /// Calls on_interval(x0, x1, active spans) for x0 < x1 with at least one active span, and on_gap(x0, x1, left, right)
  /// for each uncovered interval between the spans of highest rank that end and begin there.
  template <class OnInterval, class OnGap>
  void run(const OnInterval& on_interval, const OnGap& on_gap) {
    std::uint32_t last_ended = kNone;
    double gap_begin = 0.0;
    for (std::size_t i = 0; i < events_.size();) {
      const double x = events_[i].x;
      const bool was_empty = active_.empty();
      std::uint32_t ended = kNone;
      std::uint32_t begun = kNone;
      for (; i < events_.size() && events_[i].x == x; ++i) apply(events_[i], begun, ended);
      if (was_empty && last_ended != kNone && begun != kNone) on_gap(gap_begin, x, spans_[last_ended], spans_[begun]);
      if (active_.empty()) {
        last_ended = ended;
        gap_begin = x;
      } else {
        on_interval(x, events_[i].x, std::span<const std::uint32_t>(active_));
      }
    }
  }

  [[nodiscard]] int rank(std::uint32_t span) const { return rules_.rank[spans_[span].solid]; }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  void apply(const Event& event, std::uint32_t& begun, std::uint32_t& ended) {
    std::uint32_t& best = event.is_begin ? begun : ended;
    if (best == kNone || rank(event.span) > rank(best)) best = event.span;
    if (event.is_begin) {
      active_.push_back(event.span);
    } else {
      std::erase(active_, event.span);
    }
  }

  std::span<const Span> spans_;
  const CombineRules& rules_;
  std::vector<Event> events_;
  std::vector<std::uint32_t> active_;
};

/// Adds a run, merging it with a neighbour of equal material and solid.
void append(std::vector<Segment>& segments, double begin, double end, MaterialId material, SolidId solid) {
  if (!segments.empty()) {
    Segment& last = segments.back();
    if (last.x_end == begin && last.material == material && last.solid == solid) {
      last.x_end = end;
      return;
    }
  }
  segments.push_back({begin, end, material, solid});
}

void add_pair(std::vector<PairLength>& pairs, SolidId a, SolidId b, double length) {
  pairs.push_back({std::min(a, b), std::max(a, b), length});
}

/// Distance within which the face `left` leaves by and the one `right` enters by touch: the larger of their own.
double gap_tolerance(const Span& left, const Span& right, const CombineRules& rules) {
  double widest = rules.gap_tolerance;
  for (const FaceId face : {left.face_out, right.face_in}) {
    if (face.valid() && face.value() < rules.face_tolerance.size()) {
      widest = std::max(widest, rules.face_tolerance[face]);
    }
  }
  return widest;
}

/// Pairs of different material by their common length. A length within the gap tolerance is two faces that touch.
void measure_overlaps(std::vector<Span>& spans, const CombineRules& rules, CombinedRow& out) {
  const auto key = [&](const Span& span) { return std::tuple(span.begin, span.end, rules.rank[span.solid]); };
  std::sort(spans.begin(), spans.end(), [&](const Span& a, const Span& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < spans.size(); ++i) {
    for (std::size_t j = i + 1; j < spans.size() && spans[j].begin < spans[i].end; ++j) {
      if (rules.table->assignments[spans[i].solid].material == rules.table->assignments[spans[j].solid].material)
        continue;
      const Span& first_out = spans[i].end <= spans[j].end ? spans[i] : spans[j];
      const double length = first_out.end - spans[j].begin;
      if (!(length > gap_tolerance(first_out, spans[j], rules))) continue;
      add_pair(out.overlaps, spans[i].solid, spans[j].solid, length);
    }
  }
  collect_pairs(out.overlaps);
}

/// Collects what is found along the row.
class Labeller {
 public:
  Labeller(const CombineRules& rules, CombinedRow& out) : rules_(rules), out_(out) {}

  void add_run(double begin, double end, SolidId solid) {
    append(out_.segments, begin, end, rules_.table->assignments[solid].material, solid);
  }

  /// Fills the uncovered stretch between two spans if it is a gap between two solids that touch.
  void add_gap(double begin, double end, const Span& left, const Span& right) {
    // A slot within one solid is a feature, not a gap between two.
    if (left.solid == right.solid || !(end - begin <= gap_tolerance(left, right, rules_))) return;
    add_run(begin, end, rules_.rank[left.solid] > rules_.rank[right.solid] ? left.solid : right.solid);
    add_pair(out_.gaps, left.solid, right.solid, end - begin);
  }

 private:
  const CombineRules& rules_;
  CombinedRow& out_;
};

/// Whether the spans ascend and no two share a point: nearly all rows of most assemblies.
bool are_disjoint(std::span<const Span> spans) {
  for (std::size_t i = 1; i < spans.size(); ++i) {
    if (!(spans[i - 1].end <= spans[i].begin)) return false;
  }
  return true;
}

void label_disjoint(std::span<const Span> spans, Labeller& labeller) {
  for (std::size_t i = 0; i < spans.size(); ++i) {
    if (i > 0 && spans[i - 1].end < spans[i].begin) {
      labeller.add_gap(spans[i - 1].end, spans[i].begin, spans[i - 1], spans[i]);
    }
    labeller.add_run(spans[i].begin, spans[i].end, spans[i].solid);
  }
}

void label_by_rank(std::span<const Span> spans, const CombineRules& rules, Labeller& labeller) {
  RowSweep sweep(spans, rules);
  const auto by_rank = [&](std::uint32_t a, std::uint32_t b) { return sweep.rank(a) < sweep.rank(b); };
  sweep.run(
      [&](double begin, double end, std::span<const std::uint32_t> active) {
        labeller.add_run(begin, end, spans[*std::max_element(active.begin(), active.end(), by_rank)].solid);
      },
      [&](double begin, double end, const Span& left, const Span& right) {
        labeller.add_gap(begin, end, left, right);
      });
}

/// Comparisons are written so that NaN fails.
bool is_usable(const Span& span) {
  return std::isfinite(span.begin) && std::isfinite(span.end) && span.begin < span.end;
}

}  // namespace

IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                   const IdVector<SolidId, SolidMeasure>& measures) {
  std::vector<SolidId> order;
  for (const SolidId solid : scene.solids.ids()) order.push_back(solid);
  const auto loses_to = [&](SolidId a, SolidId b) {
    const int priority_a = table.assignments[a].priority;
    const int priority_b = table.assignments[b].priority;
    if (priority_a != priority_b) return priority_a < priority_b;
    const double volume_a = rounded_volume(measures[a].volume);
    const double volume_b = rounded_volume(measures[b].volume);
    if (volume_a != volume_b) return volume_a > volume_b;
    const int paths = scene.solids[a].info.path.compare(scene.solids[b].info.path);
    if (paths != 0) return paths > 0;
    const auto corners_a = corners(measures[a].bounds);
    const auto corners_b = corners(measures[b].bounds);
    if (corners_a != corners_b) return corners_a > corners_b;
    return a > b;
  };
  std::sort(order.begin(), order.end(), loses_to);
  IdVector<SolidId, int> rank(scene.solids.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<int>(i);
  return rank;
}

void collect_pairs(std::vector<PairLength>& pairs) {
  if (pairs.size() < 2) return;
  std::stable_sort(pairs.begin(), pairs.end(), [](const PairLength& a, const PairLength& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  std::size_t kept = 0;
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (pairs[i].first == pairs[kept].first && pairs[i].second == pairs[kept].second) {
      pairs[kept].length += pairs[i].length;
    } else {
      pairs[++kept] = pairs[i];
    }
  }
  pairs.resize(kept + 1);
}

void combine_row(std::span<const Span> spans, const CombineRules& rules, CombinedRow& out) {
  out.segments.clear();
  out.overlaps.clear();
  out.gaps.clear();
  std::vector<Span> usable;
  usable.reserve(spans.size());
  std::copy_if(spans.begin(), spans.end(), std::back_inserter(usable), is_usable);
  if (usable.empty()) return;
  if (usable.size() > 1) measure_overlaps(usable, rules, out);
  if (!out.overlaps.empty()) {
    apply_interface_policy(usable, rules);
    std::erase_if(usable, [](const Span& span) { return !is_usable(span); });
  }
  Labeller labeller(rules, out);
  if (are_disjoint(usable)) {
    label_disjoint(usable, labeller);
  } else {
    label_by_rank(usable, rules, labeller);
  }
  collect_pairs(out.gaps);
}

}  // namespace lamella
