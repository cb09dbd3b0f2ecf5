#include "slicing/combine.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>

#include "slicing/interface_policy.h"
#include "slicing/slivers.h"

namespace lamella {

namespace {

/// Comparisons are written so that NaN fails. An infinite end makes the length infinite or NaN.
bool is_usable(const Span& span) { return span.begin < span.end && std::isfinite(span.end - span.begin); }

void add_pair(std::vector<PairLength>& pairs, SolidId a, SolidId b, double length) {
  pairs.push_back({std::min(a, b), std::max(a, b), length});
}

/// Writes the segments of one row behind those of the rows before it.
class Labeller {
 public:
  Labeller(const CombineRules& rules, std::vector<Segment>& segments, std::vector<PairLength>& gaps)
      : rules_(rules),
        segments_(segments),
        gaps_(gaps),
        row_begin_(segments.size()),
        short_(rules.widest_tolerance()) {}

  /// Adds a run, merging it with a neighbour of equal material and solid.
  void add_run(double begin, double end, SolidId solid) {
    const MaterialId material = rules_.table->assignments[solid].material;
    has_short_run_ = has_short_run_ || end - begin <= short_;
    if (segments_.size() > row_begin_) {
      Segment& last = segments_.back();
      if (last.x_end == begin && last.material == material && last.solid == solid) {
        last.x_end = end;
        return;
      }
    }
    segments_.push_back({begin, end, material, solid});
  }

  /// Fills the uncovered stretch between two spans if it is a gap between two solids that touch.
  void add_gap(const Span& left, const Span& right) {
    // A slot within one solid is a feature, not a gap between two.
    if (left.solid == right.solid) return;
    const double length = right.begin - left.end;
    const double tolerance = std::max(rules_.tolerance_at(left.face_out), rules_.tolerance_at(right.face_in));
    if (!(length <= tolerance)) return;
    add_run(left.end, right.begin, rules_.rank[left.solid] > rules_.rank[right.solid] ? left.solid : right.solid);
    add_pair(gaps_, left.solid, right.solid, length);
  }

  /// Whether a run was added that may be a sliver.
  [[nodiscard]] bool has_short_run() const { return has_short_run_; }

  /// Forgets the row.
  void start_again() {
    segments_.resize(row_begin_);
    gaps_.clear();
    has_short_run_ = false;
  }

 private:
  const CombineRules& rules_;
  std::vector<Segment>& segments_;
  std::vector<PairLength>& gaps_;
  std::size_t row_begin_;
  double short_;  ///< mm
  bool has_short_run_ = false;
};

/// Labels spans that ascend and share no point: nearly all rows of most assemblies. Returns false, with nothing
/// labelled, if they don't.
bool label_disjoint(std::span<const Span> spans, Labeller& labeller) {
  double end = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < spans.size(); ++i) {
    const Span& span = spans[i];
    if (!(end <= span.begin && is_usable(span))) {
      labeller.start_again();
      return false;
    }
    if (i > 0 && end < span.begin) labeller.add_gap(spans[i - 1], span);
    labeller.add_run(span.begin, span.end, span.solid);
    end = span.end;
  }
  return true;
}

/// Leaves one entry a pair, ids ascending, with the sum of its lengths in the order in which they came.
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

}  // namespace

/// The covered part of a row from left to right. Of the spans over a point only those can ever be seen that end behind
/// all of higher rank. They are a staircase: ends fall as ranks rise, so that the one on top is seen and ends first.
class RowCombiner::Staircase {
 public:
  /// `steps` has room for every span.
  Staircase(const CombineRules& rules, Step* steps, Labeller& labeller)
      : rules_(rules), steps_(steps), labeller_(labeller) {}

  /// `spans` usable, ascending by begin.
  void label(std::span<const Span> spans) {
    for (std::size_t i = 0; i < spans.size(); ++i) {
      descend_to(spans[i].begin);
      if (count_ == 0) cross_gap(spans.subspan(i));
      climb({&spans[i], spans[i].end, rules_.rank[spans[i].solid]});
    }
    descend_to(std::numeric_limits<double>::infinity());
  }

 private:
  /// Labels and removes what ends up to `x`.
  void descend_to(double x) {
    while (count_ > 0 && steps_[count_ - 1].end <= x) {
      last_ = steps_[count_ - 1].span;
      show_top(last_->end);
      --count_;
    }
  }

  void show_top(double end) {
    if (at_ < end) labeller_.add_run(at_, end, steps_[count_ - 1].span->solid);
    at_ = end;
  }

  /// What ended last was the highest of those that ended there; so must be what begins first.
  void cross_gap(std::span<const Span> rest) {
    const Span* first = rest.data();
    for (const Span& span : rest) {
      if (span.begin != first->begin) break;
      if (rules_.rank[span.solid] > rules_.rank[first->solid]) first = &span;
    }
    if (last_ != nullptr && last_->end < first->begin) labeller_.add_gap(*last_, *first);
    at_ = first->begin;
  }

  void climb(const Step& step) {
    if (count_ == 0 || step.rank >= steps_[count_ - 1].rank) {
      if (count_ > 0) show_top(step.span->begin);
      while (count_ > 0 && steps_[count_ - 1].end <= step.end) --count_;
      steps_[count_++] = step;
      return;
    }
    if (steps_[count_ - 1].end < step.end) insert_below(step);
  }

  /// Below the top, where nothing of `step` is seen yet.
  void insert_below(const Step& step) {
    std::size_t above = count_ - 1;
    while (above > 0 && steps_[above - 1].rank > step.rank) --above;
    if (steps_[above].end >= step.end) return;  // never seen
    std::size_t kept = above;
    while (kept > 0 && steps_[kept - 1].end <= step.end) --kept;
    // The new one takes the place of those between, of which there may be none.
    Step* const place = steps_ + kept;
    if (kept < above) {
      std::copy(steps_ + above, steps_ + count_, place + 1);
    } else {
      std::copy_backward(place, steps_ + count_, steps_ + count_ + 1);
    }
    *place = step;
    count_ -= above - kept;
    ++count_;
  }

  const CombineRules& rules_;
  Step* steps_;
  Labeller& labeller_;
  std::size_t count_ = 0;
  const Span* last_ = nullptr;  ///< what ended last
  double at_ = 0.0;             ///< labelled up to here
};

/// The usable spans in an order that neither ids nor the order of `spans` has part in; `spans` itself if that is it.
std::span<const Span> RowCombiner::sort_usable(std::span<const Span> spans, const CombineRules& rules) {
  const auto comes_before = [&rules](const Span& a, const Span& b) {
    if (a.begin != b.begin) return a.begin < b.begin;
    if (a.end != b.end) return a.end < b.end;
    return rules.rank[a.solid] < rules.rank[b.solid];
  };
  const auto is_in_place = [&](std::size_t i) {
    return is_usable(spans[i]) && (i == 0 || !comes_before(spans[i], spans[i - 1]));
  };
  std::size_t in_place = 0;
  while (in_place < spans.size() && is_in_place(in_place)) ++in_place;
  if (in_place == spans.size()) return spans;
  sorted_.clear();
  std::copy_if(spans.begin(), spans.end(), std::back_inserter(sorted_), is_usable);
  std::sort(sorted_.begin(), sorted_.end(), comes_before);
  return sorted_;
}

/// Pairs of different material by their common length. A length within the gap tolerance is two faces that touch.
void RowCombiner::measure_overlaps(std::span<const Span> spans, const CombineRules& rules) {
  if (open_.size() < spans.size()) open_.resize(spans.size());
  Open* const open = open_.data();
  std::size_t count = 0;
  for (const Span& span : spans) {
    const Open entered{span.end, rules.tolerance_at(span.face_out), span.solid,
                       rules.table->assignments[span.solid].material};
    const double tolerance_in = rules.tolerance_at(span.face_in);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < count; ++i) {
      if (open[i].end <= span.begin) continue;
      if (kept < i) open[kept] = open[i];
      const Open& other = open[kept++];
      if (other.material == entered.material) continue;
      const bool other_ends_first = other.end <= entered.end;
      const double length = (other_ends_first ? other.end : entered.end) - span.begin;
      const double tolerance_out = other_ends_first ? other.tolerance_out : entered.tolerance_out;
      if (length > std::max(tolerance_in, tolerance_out)) add_pair(overlaps_, other.solid, entered.solid, length);
    }
    open[kept] = entered;
    count = kept + 1;
  }
}

/// The spans clipped by the policy that the table names, if it has a say.
std::span<const Span> RowCombiner::clip(std::span<const Span> spans, const CombineRules& rules) {
  if (overlaps_.empty() || !has_interfaces(rules.table->policy)) return spans;
  clipped_.assign(spans.begin(), spans.end());
  apply_interface_policy(clipped_, rules);
  return sort_usable(clipped_, rules);
}

void RowCombiner::combine(std::span<const Span> spans, const CombineRules& rules, std::vector<Segment>& segments) {
  overlaps_.clear();
  gaps_.clear();
  const std::size_t row_begin = segments.size();
  Labeller labeller(rules, segments, gaps_);
  std::span<const Span> labelled = spans;
  if (!label_disjoint(spans, labeller)) {
    const std::span<const Span> usable = sort_usable(spans, rules);
    measure_overlaps(usable, rules);
    if (steps_.size() < spans.size()) steps_.resize(spans.size());
    labelled = clip(usable, rules);
    Staircase(rules, steps_.data(), labeller).label(labelled);
  }
  if (labeller.has_short_run()) join_slivers(labelled, rules, row_begin, segments);
}

void CombineRules::widen_at(const IdVector<FaceId, Face>& faces) {
  face_tolerance_.reserve(faces.size());
  for (const Face& face : faces) {
    face_tolerance_.push_back(face.tolerance);
    widest_ = std::max(widest_, face.tolerance);
  }
}

CombinedRow combine_row(std::span<const Span> spans, const CombineRules& rules) {
  CombinedRow out;
  RowCombiner combiner;
  combiner.combine(spans, rules, out.segments);
  out.overlaps.assign(combiner.overlaps().begin(), combiner.overlaps().end());
  out.gaps.assign(combiner.gaps().begin(), combiner.gaps().end());
  collect_pairs(out.overlaps);
  collect_pairs(out.gaps);
  return out;
}

}  // namespace lamella
