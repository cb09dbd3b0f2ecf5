#include "slicing/contact/gap_filler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>

#include "core/tolerances.h"

namespace lamella {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Patches are looked for a little beyond their pieces, so that what a piece whose middle lies outside the contact
/// would have covered is covered by its neighbours.
constexpr double kBeyond = 2.0;
constexpr double kBendSlack = 1.5;

/// A row that crosses a face leaves it at a hit, at which its gap is found. Only where a row is as good as parallel to
/// a face, by the sine of the angle, can it run within the gap and meet neither. Little beside it meets one of them
/// within seven tolerances.
constexpr double kGrazing = 0.15;

/// Where a gap opens to the outside, a row may enter it for as long as a few tolerances: what is seen there is a
/// rounded corner, no gap, and filling it would make slivers.
constexpr double kMouth = 8.0;

/// The end of a gap along a row is found to this part of the tolerance.
constexpr double kEndAccuracy = 1e-3;

/// Distances add up to the tolerance but for rounding.
constexpr double kSlack = 1e-9;

/// Where a row may run along a patch: within its radius of the centre, and near the plane through it. `offset` leads
/// from the centre to the nearest point of the row, `middle` is that point along it; lo > hi if nowhere.
Interval along_patch(const ContactPatch& patch, double tolerance, const Vec3& offset, double middle,
                     const Vec2& along) {
  const Interval within{middle - kBeyond * patch.radius, middle + kBeyond * patch.radius};
  // What is bent grows with the square of the distance.
  const double limit = kBeyond * kBeyond * kBendSlack * patch.bend + tolerance;
  const double aside = patch.normal.dot(offset);
  const double slope = patch.normal.head<2>().dot(along);
  if (std::abs(slope) * patch.radius * kBeyond <= limit) {
    return std::abs(aside) <= limit + std::abs(slope) * patch.radius * kBeyond ? within : Interval{1.0, 0.0};
  }
  const auto [low, high] = std::minmax({(-limit - aside) / slope, (limit - aside) / slope});
  return {std::max(within.lo, middle + low), std::min(within.hi, middle + high)};
}

/// Whether one span after the other covers an interval, `spans` ascending by begin. Gaps that are no longer along the
/// row than kMinGap are filled in any case.
bool covers(std::span<const Span> spans, const Interval& interval) {
  double end = interval.lo;
  for (const Span& span : spans) {
    if (span.begin > end + tolerance::kMinGap) return false;
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

  /// Fills what of the gap at a candidate the row leaves open, and takes it out of what is open.
  void try_candidate(const Candidate& candidate, std::vector<GapFill>& out) {
    touch_ = &filler_.touches_[candidate.touch];
    tolerance_ = touch_->contact->tolerance;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const Interval stretch = open_[i];
      if (stretch.hi < candidate.near.lo || stretch.lo > candidate.near.hi) continue;
      const Interval part{std::max(stretch.lo, candidate.near.lo), std::min(stretch.hi, candidate.near.hi)};
      const auto start = find_start(candidate, part);
      if (!start) continue;
      const Interval gap{reach(candidate.step, *start, stretch.lo), reach(candidate.step, *start, stretch.hi)};
      if (!is_worth(gap, stretch)) continue;
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

  /// Whether a point that lies in no solid lies between the two within the tolerance. `owner` is the one that it lies
  /// on, if that is known: the other is asked first, for it is nearly always far, which costs little to tell.
  [[nodiscard]] bool is_in_gap(double along, SolidId owner = {}) const {
    const Vec3 point = point_at(along);
    const double limit = tolerance_ * (1.0 + kSlack);
    const bool is_owned_by_first = owner == touch_->first;
    const SolidId near_solid = is_owned_by_first ? touch_->second : touch_->first;
    const SolidId far_solid = is_owned_by_first ? touch_->first : touch_->second;
    const auto first = filler_.distances_.find(near_solid, point, limit + kSlack * limit);
    if (!first) return false;
    const auto second = filler_.distances_.find(far_solid, point, limit - first->distance + kSlack * limit);
    if (!second) return false;
    const double own = touching_distance(filler_.distances_.scene(), first->face, second->face, filler_.gap_tolerance_);
    if (first->distance + second->distance > own * (1.0 + kSlack)) return false;
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

  /// A point of the gap on a part of an open stretch: that at which it is looked for, or the part's middle.
  [[nodiscard]] std::optional<double> find_start(const Candidate& candidate, const Interval& part) const {
    const double along = std::clamp(candidate.along, part.lo, part.hi);
    if (is_in_gap(along, candidate.owner)) return along;
    const double middle = part.lo + 0.5 * (part.hi - part.lo);
    if (middle != along && is_in_gap(middle)) return middle;
    return std::nullopt;
  }

  /// How far the gap goes on from `from` towards `end` of the open stretch.
  [[nodiscard]] double reach(double step_size, double from, double end) const {
    const double step = std::copysign(std::max(step_size, tolerance_), end - from);
    double inside = from;
    for (;;) {
      const bool is_last = std::abs(end - inside) <= std::abs(step);
      const double next = is_last ? end : inside + step;
      if (!is_in_gap(next)) return bisect(inside, next);
      inside = next;
      if (is_last) return end;
    }
  }

  [[nodiscard]] double bisect(double inside, double outside) const {
    while (std::abs(outside - inside) > kEndAccuracy * tolerance_) {
      const double middle = inside + 0.5 * (outside - inside);
      if (middle == inside || middle == outside) break;
      (is_in_gap(middle) ? inside : outside) = middle;
    }
    return inside;
  }

  /// A gap between two solids, or a long one that the row runs into from outside; not the mouth of one.
  [[nodiscard]] bool is_worth(const Interval& gap, const Interval& stretch) const {
    const bool is_closed = gap.lo == stretch.lo && gap.hi == stretch.hi;
    return gap.length() > (is_closed ? 0.0 : kMouth * tolerance_);
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
  double tolerance_ = 0.0;  ///< of the touch, mm
  double z_;
  const RowLattice& lattice_;
  std::size_t row_ = 0;
  double across_ = 0.0;
  std::vector<Interval> open_;
};

GapFiller::GapFiller(const SolidDistances& distances, std::span<const Contact> contacts,
                     const IdVector<SolidId, int>& rank, const std::optional<double>& gap_tolerance)
    : distances_(distances), gap_tolerance_(gap_tolerance) {
  for (const Contact& contact : contacts) {
    if (!contact.patches) continue;
    const bool is_first = rank[contact.first] > rank[contact.second];
    Touch touch{&contact, is_first ? contact.first : contact.second, is_first ? contact.second : contact.first};
    for (const ContactPatch& patch : *contact.patches)
      touch.largest_radius = std::max(touch.largest_radius, patch.radius);
    touches_.push_back(touch);
  }
  if (touches_.empty()) return;
  std::sort(touches_.begin(), touches_.end(), [&](const Touch& a, const Touch& b) {
    return std::pair(rank[a.first], rank[a.second]) > std::pair(rank[b.first], rank[b.second]);
  });
  touches_begin_.assign(distances.scene().faces.size() + 1, 0);
  for (const Touch& touch : touches_) {
    for (const FaceId face : touch.contact->faces) ++touches_begin_[face.value() + 1];
  }
  for (std::size_t i = 1; i < touches_begin_.size(); ++i) touches_begin_[i] += touches_begin_[i - 1];
  touches_of_face_.resize(touches_begin_.back());
  std::vector<std::uint32_t> at = touches_begin_;
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    for (const FaceId face : touches_[i].contact->faces) {
      touches_of_face_[at[face.value()]++] = static_cast<std::uint32_t>(i);
    }
  }
}

void GapFiller::find_grazed(const Touch& touch, double z, const RowLattice& lattice, const SpanRows& spans,
                            std::vector<Candidate>& out) const {
  const Contact& contact = *touch.contact;
  const double beyond = kBeyond * touch.largest_radius;
  const double local_z = z - contact.offset.z();
  const auto begin = std::lower_bound(contact.patches->begin(), contact.patches->end(), local_z - beyond,
                                      [](const ContactPatch& p, double height) { return p.center.z() < height; });
  for (auto it = begin; it != contact.patches->end() && it->center.z() <= local_z + beyond; ++it) {
    const double radius = kBeyond * it->radius;
    if (std::abs(it->center.z() - local_z) > radius) continue;
    if (std::abs(it->normal.head<2>().dot(lattice.along)) > kGrazing) continue;
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
      const Vec2 to_row = ((number + 0.5) * lattice.spacing - across) * lattice.across;
      const Interval near = along_patch(*it, contact.tolerance, {to_row.x(), to_row.y(), local_z - it->center.z()},
                                        middle, lattice.along);
      if (!(near.lo <= near.hi) || covers(spans.row(row), near)) continue;
      out.push_back({row, static_cast<std::uint32_t>(&touch - touches_.data()), middle, near, it->radius, {}});
    }
  }
}

void GapFiller::add_end(std::size_t row, SolidId solid, FaceId face, double along, std::vector<Candidate>& out) const {
  // An id that refers to nothing is larger than any size.
  if (face.value() + std::size_t{1} >= touches_begin_.size()) return;
  for (std::uint32_t i = touches_begin_[face.value()]; i < touches_begin_[face.value() + 1]; ++i) {
    const std::uint32_t touch = touches_of_face_[i];
    out.push_back({row, touch, along, {along, along}, touches_[touch].largest_radius, solid});
  }
}

/// What is open for so little along a row between two solids is filled when the row is combined: where faces coincide
/// that is half of all crossings.
double GapFiller::narrow_gap(const Span& left, const Span& right) const {
  const std::size_t faces = distances_.scene().faces.size();
  if (left.solid == right.solid || left.face_out.value() >= faces || right.face_in.value() >= faces) return 0.0;
  return touching_distance(distances_.scene(), left.face_out, right.face_in, gap_tolerance_);
}

/// The ends of what rows leave open, where they are on faces that touch another solid somewhere.
void GapFiller::find_ends(const SpanRows& spans, std::vector<Candidate>& out) const {
  for (std::size_t r = 0; r < spans.rows(); ++r) {
    const auto row = spans.row(r);
    const Span* last = nullptr;
    for (const Span& span : row) {
      if (last == nullptr || span.begin > last->end + narrow_gap(*last, span)) {
        if (last != nullptr) add_end(r, last->solid, last->face_out, last->end, out);
        add_end(r, span.solid, span.face_in, span.begin, out);
      }
      if (last == nullptr || span.end > last->end) last = &span;
    }
    if (last != nullptr) add_end(r, last->solid, last->face_out, last->end, out);
  }
}

void GapFiller::fill(double z, const RowLattice& lattice, const SpanRows& spans, std::vector<GapFill>& out) const {
  out.clear();
  if (touches_.empty()) return;
  std::vector<Candidate> candidates;
  for (const Touch& touch : touches_) {
    const Box3& box = touch.contact->box;
    const double beyond = kBeyond * touch.largest_radius;
    if (z < box.min().z() - beyond || z > box.max().z() + beyond) continue;
    find_grazed(touch, z, lattice, spans, candidates);
  }
  find_ends(spans, candidates);
  // Touches are in the order of ranks, and ids decide about nothing.
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tuple(a.row, a.touch, a.along, a.step) < std::tuple(b.row, b.touch, b.along, b.step);
  });
  RowSearch search(*this, z, lattice);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const std::size_t row = candidates[i].row;
    if (i == 0 || candidates[i - 1].row != row) search.begin_row(row, spans.row(row));
    search.try_candidate(candidates[i], out);
  }
  std::sort(out.begin(), out.end(), [](const GapFill& a, const GapFill& b) {
    return std::pair(a.row, a.span.begin) < std::pair(b.row, b.span.begin);
  });
}

}  // namespace lamella
