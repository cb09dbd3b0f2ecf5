#include "slicing/contact/gap_filler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace lamella {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Patches are looked for a little beyond their pieces, so that what a piece whose middle lies outside the contact
/// would have covered is covered by its neighbours.
constexpr double kBeyond = 2.0;
constexpr double kBendSlack = 1.5;

/// Where a gap opens to the outside, a row may enter it for as long as a few tolerances: what is seen there is a
/// rounded corner, no gap, and filling it would make slivers.
constexpr double kMouth = 8.0;

/// The end of a gap along a row is found to this part of the tolerance.
constexpr double kEndAccuracy = 1e-3;

/// Distances add up to the tolerance but for rounding.
constexpr double kSlack = 1e-9;

/// Where a row may run along a patch: within its radius of the centre, and near the plane through it. `offset` leads
/// from the centre to the nearest point of the row, `middle` is that point along it; lo > hi if nowhere.
Interval along_patch(const ContactPatch& patch, const Vec3& offset, double middle, const Vec2& along) {
  const Interval within{middle - kBeyond * patch.radius, middle + kBeyond * patch.radius};
  // What is bent grows with the square of the distance.
  const double limit = kBeyond * kBeyond * kBendSlack * patch.bend + patch.tolerance;
  const double aside = patch.normal.dot(offset);
  const double slope = patch.normal.head<2>().dot(along);
  if (std::abs(slope) * patch.radius * kBeyond <= limit) {
    return std::abs(aside) <= limit + std::abs(slope) * patch.radius * kBeyond ? within : Interval{1.0, 0.0};
  }
  const auto [low, high] = std::minmax({(-limit - aside) / slope, (limit - aside) / slope});
  return {std::max(within.lo, middle + low), std::min(within.hi, middle + high)};
}

/// Whether one span after the other covers an interval, `spans` ascending by begin.
bool covers(std::span<const Span> spans, const Interval& interval) {
  double end = interval.lo;
  for (const Span& span : spans) {
    if (span.begin > end) return false;
    end = std::max(end, span.end);
    if (end >= interval.hi) return true;
  }
  return false;
}

/// What no span of a row covers, ascending, unbounded at both ends.
void uncovered(std::span<const Span> spans, std::vector<Interval>& out) {
  out.clear();
  double end = -kFar;
  for (const Span& span : spans) {
    if (span.begin > end) out.push_back({end, span.begin});
    end = std::max(end, span.end);
  }
  out.push_back({end, kFar});
}

}  // namespace

/// One row of a layer.
class GapFiller::RowSearch {
 public:
  RowSearch(const GapFiller& filler, double z, const RowLattice& lattice) : filler_(filler), z_(z), lattice_(lattice) {}

  void begin_row(std::size_t row, std::span<const Span> spans) {
    row_ = row;
    across_ = lattice_.position(lattice_.first_row + static_cast<std::int64_t>(row));
    uncovered(spans, open_);
  }

  /// Fills what of the gap at a patch the row leaves open, and takes it out of what is open.
  void try_patch(const Candidate& candidate, std::vector<GapFill>& out) {
    touch_ = &filler_.touches_[candidate.touch];
    const ContactPatch& patch = *candidate.patch;
    const Interval near = candidate.near;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const Interval stretch = open_[i];
      if (stretch.hi < near.lo || stretch.lo > near.hi) continue;
      const Interval part{std::max(stretch.lo, near.lo), std::min(stretch.hi, near.hi)};
      const auto start = find_start(patch, candidate.middle, stretch, part);
      if (!start) continue;
      const Interval gap{reach(patch, *start, stretch.lo), reach(patch, *start, stretch.hi)};
      if (!is_worth(patch, gap, stretch)) continue;
      out.push_back(fill_of(gap));
      take(i, gap);
      return;
    }
  }

 private:
  [[nodiscard]] Vec3 point_at(double along) const {
    const Vec2 xy = along * lattice_.along + across_ * lattice_.across;
    return {xy.x(), xy.y(), z_};
  }

  /// Whether a point that lies in no solid lies between the two within the tolerance.
  [[nodiscard]] bool is_in_gap(const ContactPatch& patch, double along) const {
    const Vec3 point = point_at(along);
    const double limit = patch.tolerance * (1.0 + kSlack);
    const auto first = filler_.distances_.find(touch_->first, point, limit + kSlack * limit);
    if (!first) return false;
    const auto second = filler_.distances_.find(touch_->second, point, limit - first->distance + kSlack * limit);
    if (!second) return false;
    // Beyond the end of a gap the nearest points of both are on their borders.
    if (!is_over(*first, point, kSlack * limit) && !is_over(*second, point, kSlack * limit)) return false;
    // Between the two: they lie in opposite directions, unless the point lies on one of them.
    if (first->distance <= kSlack * limit || second->distance <= kSlack * limit) return true;
    return (first->point - point).dot(second->point - point) < 0.0;
  }

  /// Whether the face's normal at a nearest point goes through `point`.
  [[nodiscard]] bool is_over(const NearPoint& near, const Vec3& point, double on_it) const {
    if (near.distance <= on_it) return true;
    if (near.on_edge) return false;
    // The nearest point is found to the root of the rounding of its distance, which is little beside that.
    constexpr double kUpright = 0.99999;
    const Vec3 normal = outward_normal(filler_.distances_.scene(), near.face, near.uv);
    return std::abs(normal.dot(point - near.point)) >= kUpright * near.distance;
  }

  /// A point of the gap on a part of an open stretch: its ends, where a solid begins, or its middle.
  [[nodiscard]] std::optional<double> find_start(const ContactPatch& patch, double foot, const Interval& stretch,
                                                 const Interval& part) const {
    const double middle = part.lo + 0.5 * (part.hi - part.lo);
    for (const double along : {middle, part.lo, part.hi}) {
      const bool is_end = along == stretch.lo || along == stretch.hi;
      if ((is_end || along == middle) && is_in_gap(patch, along)) return along;
    }
    // The point of the row nearest to the patch, which a gap across the row has and the middle of a long part hasn't.
    foot = std::clamp(foot, part.lo, part.hi);
    if (is_in_gap(patch, foot)) return foot;
    return std::nullopt;
  }

  /// How far the gap goes on from `from` towards `end` of the open stretch.
  [[nodiscard]] double reach(const ContactPatch& patch, double from, double end) const {
    const double step = std::copysign(std::max(patch.radius, patch.tolerance), end - from);
    double inside = from;
    for (;;) {
      const bool is_last = std::abs(end - inside) <= std::abs(step);
      const double next = is_last ? end : inside + step;
      if (!is_in_gap(patch, next)) return bisect(patch, inside, next);
      inside = next;
      if (is_last) return end;
    }
  }

  [[nodiscard]] double bisect(const ContactPatch& patch, double inside, double outside) const {
    while (std::abs(outside - inside) > kEndAccuracy * patch.tolerance) {
      const double middle = inside + 0.5 * (outside - inside);
      if (middle == inside || middle == outside) break;
      (is_in_gap(patch, middle) ? inside : outside) = middle;
    }
    return inside;
  }

  /// A gap between two solids, or a long one that the row runs into from outside; not the mouth of one.
  [[nodiscard]] static bool is_worth(const ContactPatch& patch, const Interval& gap, const Interval& stretch) {
    const bool is_closed = gap.lo == stretch.lo && gap.hi == stretch.hi;
    return gap.length() > (is_closed ? 0.0 : kMouth * patch.tolerance);
  }

  [[nodiscard]] GapFill fill_of(const Interval& gap) const {
    GapFill fill;
    fill.row = row_;
    fill.span = {gap.lo, gap.hi, touch_->first, FaceId(), FaceId()};
    fill.gap = {std::min(touch_->first, touch_->second), std::max(touch_->first, touch_->second), gap.length()};
    return fill;
  }

  void take(std::size_t i, const Interval& gap) {
    const Interval stretch = open_[i];
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(i));
    if (gap.hi < stretch.hi) open_.insert(open_.begin() + static_cast<std::ptrdiff_t>(i), {gap.hi, stretch.hi});
    if (stretch.lo < gap.lo) open_.insert(open_.begin() + static_cast<std::ptrdiff_t>(i), {stretch.lo, gap.lo});
  }

  const GapFiller& filler_;
  const Touch* touch_ = nullptr;
  double z_;
  const RowLattice& lattice_;
  std::size_t row_ = 0;
  double across_ = 0.0;
  std::vector<Interval> open_;
};

GapFiller::GapFiller(const SolidDistances& distances, std::span<const Contact> contacts,
                     const IdVector<SolidId, int>& rank)
    : distances_(distances) {
  for (const Contact& contact : contacts) {
    if (!contact.patches) continue;
    const bool is_first = rank[contact.first] > rank[contact.second];
    Touch touch{&contact, is_first ? contact.first : contact.second, is_first ? contact.second : contact.first};
    for (const ContactPatch& patch : *contact.patches)
      touch.largest_radius = std::max(touch.largest_radius, patch.radius);
    touches_.push_back(touch);
  }
  std::sort(touches_.begin(), touches_.end(), [&](const Touch& a, const Touch& b) {
    return std::pair(rank[a.first], rank[a.second]) > std::pair(rank[b.first], rank[b.second]);
  });
}

void GapFiller::find_candidates(const Touch& touch, double z, const RowLattice& lattice, const SpanRows& spans,
                                std::vector<Candidate>& out) const {
  const Contact& contact = *touch.contact;
  const double beyond = kBeyond * touch.largest_radius;
  const double local_z = z - contact.offset.z();
  const auto begin = std::lower_bound(contact.patches->begin(), contact.patches->end(), local_z - beyond,
                                      [](const ContactPatch& p, double height) { return p.center.z() < height; });
  for (auto it = begin; it != contact.patches->end() && it->center.z() <= local_z + beyond; ++it) {
    const double radius = kBeyond * it->radius;
    if (std::abs(it->center.z() - local_z) > radius) continue;
    const Vec2 center = (it->center + contact.offset).head<2>();
    const double across = center.dot(lattice.across) - lattice.anchor;
    const double middle = center.dot(lattice.along);
    const auto first_row = static_cast<double>(lattice.first_row);
    // As numbers: a row's index may be out of an integer's range.
    const double low = std::max(std::ceil((across - radius) / lattice.spacing - 0.5), first_row);
    const double high =
        std::min(std::floor((across + radius) / lattice.spacing - 0.5), static_cast<double>(lattice.last_row - 1));
    for (double number = low; number <= high; number += 1.0) {
      const auto row = static_cast<std::size_t>(number - first_row);
      const double aside = (number + 0.5) * lattice.spacing - across;
      const Vec2 to_row = aside * lattice.across;
      const Interval near = along_patch(*it, {to_row.x(), to_row.y(), local_z - it->center.z()}, middle, lattice.along);
      if (!(near.lo <= near.hi) || covers(spans.row(row), near)) continue;
      out.push_back({row, static_cast<std::uint32_t>(&touch - touches_.data()), middle, near, &*it});
    }
  }
}

void GapFiller::fill(double z, const RowLattice& lattice, const SpanRows& spans, std::vector<GapFill>& out) const {
  out.clear();
  std::vector<Candidate> candidates;
  for (const Touch& touch : touches_) {
    const Box3& box = touch.contact->box;
    const double beyond = kBeyond * touch.largest_radius;
    if (z < box.min().z() - beyond || z > box.max().z() + beyond) continue;
    find_candidates(touch, z, lattice, spans, candidates);
  }
  // Touches are in the order of ranks and patches in that of their places, so that ids decide about nothing.
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.row < b.row; });
  RowSearch search(*this, z, lattice);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::size_t row = candidates[i].row;
    if (i == 0 || candidates[i - 1].row != row) search.begin_row(row, spans.row(row));
    search.try_patch(candidates[i], out);
  }
  std::sort(out.begin(), out.end(), [](const GapFill& a, const GapFill& b) {
    return std::pair(a.row, a.span.begin) < std::pair(b.row, b.span.begin);
  });
}

}  // namespace lamella
