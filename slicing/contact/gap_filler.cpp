#include "slicing/contact/gap_filler.h"

#include <algorithm>
#include <array>
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

/// Rows of a layer beside a patch. The height of a row's points over the patch's quadric is a + b x + c x^2, x along
/// the row from the point nearest to the patch's centre; a is a quadratic and b linear in t, the row's place across
/// from the centre.
class RowsOverPatch {
 public:
  /// `height` (mm) leads from the centre up to the layer.
  RowsOverPatch(const ContactPatch& patch, double tolerance, double height, const RowLattice& lattice)
      : reach_(kBeyond * patch.radius) {
    const Vec3 along(lattice.along.x(), lattice.along.y(), 0.0);
    const Vec3 across(lattice.across.x(), lattice.across.y(), 0.0);
    const Vec3 up(0.0, 0.0, height);
    const auto form = [&](const Vec3& d, const Vec3& e) { return d.dot(patch.form * e); };
    a_ = {patch.normal.dot(up) - form(up, up), patch.normal.dot(across) - 2.0 * form(across, up),
          -form(across, across)};
    b_ = {patch.normal.dot(along) - 2.0 * form(along, up), -2.0 * form(along, across)};
    c_ = -form(along, along);
    // What isn't a quadric grows with the cube of the distance.
    limit_ = kBeyond * kBeyond * kBeyond * kBendSlack * patch.bend + tolerance;
  }

  /// Goes to a row; false if it certainly stays away from the patch.
  bool go_to(double t) {
    a_here_ = a_[0] + t * (a_[1] + t * a_[2]);
    b_here_ = b_[0] + t * b_[1];
    return !(std::abs(a_here_) > limit_ + reach_ * (std::abs(b_here_) + reach_ * std::abs(c_)));
  }

  /// A place of a stretch of the row that may lie within the tolerance of the patch: the first of those where the
  /// height is least, which are the point next to the centre, zeros, the extremum and the stretch's ends.
  [[nodiscard]] std::optional<double> find_near(const Interval& stretch) const {
    const double root = std::sqrt(b_here_ * b_here_ - 4.0 * a_here_ * c_);
    const std::array<double, 7> places{std::clamp(0.0, stretch.lo, stretch.hi),
                                       0.5 * (-b_here_ - root) / c_,
                                       0.5 * (-b_here_ + root) / c_,
                                       -a_here_ / b_here_,
                                       -0.5 * b_here_ / c_,
                                       stretch.lo,
                                       stretch.hi};
    for (const double x : places) {
      // Some may be NaN or infinite.
      if (stretch.contains(x) && std::abs(a_here_ + x * (b_here_ + x * c_)) <= limit_) return x;
    }
    return std::nullopt;
  }

 private:
  double reach_;
  std::array<double, 3> a_{};
  std::array<double, 2> b_{};
  double c_ = 0.0;
  double limit_ = 0.0;
  double a_here_ = 0.0;
  double b_here_ = 0.0;
};

/// Calls visit(part) for the parts of an interval that no span covers, `spans` ascending by begin. What is open for no
/// longer than kMinGap is filled in any case.
template <class Visit>
void for_each_open(std::span<const Span> spans, const Interval& interval, const Visit& visit) {
  double end = interval.lo;
  for (const Span& span : spans) {
    if (end >= interval.hi) return;
    if (span.begin > end + tolerance::kMinGap) visit(Interval{end, std::min(span.begin, interval.hi)});
    end = std::max(end, span.end);
  }
  if (end < interval.hi) visit(Interval{end, interval.hi});
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
      const double start = std::clamp(candidate.along, part.lo, part.hi);
      if (!is_in_gap(start, candidate.owner)) continue;
      const Interval gap{reach(candidate.step, start, stretch.lo), reach(candidate.step, start, stretch.hi)};
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
    // Boxes nearly always tell that one of the two is far.
    if (!filler_.distances_.may_come_within(far_solid, point, limit)) return false;
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
  const auto touch_index = static_cast<std::uint32_t>(&touch - touches_.data());
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
    RowsOverPatch over(*it, contact.tolerance, local_z - it->center.z(), lattice);
    for (double number = low; number <= high; number += 1.0) {
      if (!over.go_to((number + 0.5) * lattice.spacing - across)) continue;
      const auto row = static_cast<std::size_t>(number - first_row);
      for_each_open(spans.row(row), {middle - radius, middle + radius}, [&](const Interval& part) {
        const auto place = over.find_near({part.lo - middle, part.hi - middle});
        if (place) out.push_back({row, touch_index, middle + *place, part, it->radius, {}});
      });
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
