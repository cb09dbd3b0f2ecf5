#include "slicing/mixer.h"

#include <algorithm>
#include <cmath>

#include "slicing/compensated_sum.h"

namespace lamella {

namespace {

/// At first knots lie at most this part of the assembly's diagonal apart; what is between is looked at in quarters.
constexpr double kFirstPart = 1.0 / 16.0;

/// mm: a jump of the field becomes a ramp no longer than this.
constexpr double kShortest = 1e-3;

/// Of the tolerance: what the knots may be off between samples, and what leaving some out may add. A quarter is the
/// field's own (FieldProbe::start_row).
constexpr double kShare = 0.375;

/// A segment has no more knots: a formula of noise must not fill the memory.
constexpr std::size_t kMostKnots = 4096;

}  // namespace

MixFaults& MixFaults::operator+=(const MixFaults& other) {
  samples += other.samples;
  repaired += other.repaired;
  largest_repair = std::max(largest_repair, other.largest_repair);
  unresolved += other.unresolved;
  return *this;
}

/// An interval between two knots and its middle.
struct Mixer::Part {
  Workspace::Knot from;
  Workspace::Knot middle;
  Workspace::Knot to;
};

Mixer::Mixer(const Compositions& compositions, const Box3& bounds, double tolerance)
    : compositions_(compositions), tolerance_(tolerance), longest_(kFirstPart * bounds.diagonal().norm()) {}

Mixer::Workspace::Knot Mixer::Workspace::take(double x, MixFaults& faults) {
  const Knot knot{x, samples_.size()};
  samples_.resize(samples_.size() + components_);
  const double repair = probe_.sample(origin_ + x * along_, std::span(samples_).last(components_));
  ++faults.samples;
  if (repair > kFractionSlack) ++faults.repaired;
  faults.largest_repair = std::max(faults.largest_repair, repair);
  return knot;
}

double Mixer::Workspace::bend(const Knot& from, const Knot& knot, const Knot& to) const {
  const double part = (knot.x - from.x) / (to.x - from.x);
  double most = 0.0;
  for (std::size_t c = 0; c < components_; ++c) {
    const double straight = (1.0 - part) * at(from)[c] + part * at(to)[c];
    most = std::max(most, std::abs(at(knot)[c] - straight));
  }
  return most;
}

/// Appends knots behind `part.from` so that the quarters of every interval lie within their share of the tolerance of
/// the straight line. False when the knots ran out.
bool Mixer::refine(const Part& part, Workspace& workspace, MixFaults& faults) const {
  const auto middle_of = [](const auto& a, const auto& b) { return 0.5 * (a.x + b.x); };
  const Part first{part.from, workspace.take(middle_of(part.from, part.middle), faults), part.middle};
  const Part second{part.middle, workspace.take(middle_of(part.middle, part.to), faults), part.to};
  const double bend =
      std::max({workspace.bend(part.from, first.middle, part.to), workspace.bend(part.from, part.middle, part.to),
                workspace.bend(part.from, second.middle, part.to)});
  const bool is_straight = bend <= kShare * tolerance_;
  const bool is_full = workspace.knots_.size() >= kMostKnots;
  if (is_straight || is_full || part.to.x - part.from.x <= kShortest) {
    workspace.knots_.push_back(part.to);
    return is_straight || !is_full;
  }
  const bool is_first_met = refine(first, workspace, faults);
  return refine(second, workspace, faults) && is_first_met;
}

void Mixer::lay_knots(const Segment& segment, Workspace& workspace, MixFaults& faults) const {
  const double detail = compositions_.detail(segment.solid);
  const double step = detail > 0.0 ? std::min(detail, longest_) : longest_;
  const double length = segment.x_end - segment.x_begin;
  const double count = std::clamp(std::ceil(length / step), 1.0, static_cast<double>(kMostKnots / 2));
  workspace.samples_.clear();
  workspace.knots_.assign(1, workspace.take(segment.x_begin, faults));
  Workspace::Knot from = workspace.knots_.front();
  bool is_met = true;
  for (double i = 0.0; i < count; ++i) {
    const double x = i + 1.0 < count ? segment.x_begin + length * (i + 1.0) / count : segment.x_end;
    const auto middle = workspace.take(0.5 * (from.x + x), faults);
    const auto to = workspace.take(x, faults);
    is_met = refine({from, middle, to}, workspace, faults) && is_met;
    from = to;
  }
  if (!is_met) ++faults.unresolved;
}

/// Leaves out knots that lie within their share of the tolerance of the line between those that stay: from each that
/// stays as far as the slopes to all in between allow.
void Mixer::thin_out(Workspace& workspace) const {
  auto& knots = workspace.knots_;
  const std::size_t components = workspace.components_;
  const double slack = kShare * tolerance_;
  std::vector<Interval> slopes(components);
  std::size_t kept = 0;
  for (std::size_t anchor = 0; anchor + 1 < knots.size();) {
    std::fill(slopes.begin(), slopes.end(), Interval{-HUGE_VAL, HUGE_VAL});
    std::size_t farthest = anchor + 1;
    for (std::size_t next = anchor + 1; next < knots.size(); ++next) {
      const double way = knots[next].x - knots[anchor].x;
      bool is_reached = true;
      bool is_open = true;
      for (std::size_t c = 0; c < components; ++c) {
        const double rise = workspace.at(knots[next])[c] - workspace.at(knots[anchor])[c];
        is_reached = is_reached && slopes[c].contains(rise / way);
        slopes[c].lo = std::max(slopes[c].lo, (rise - slack) / way);
        slopes[c].hi = std::min(slopes[c].hi, (rise + slack) / way);
        is_open = is_open && slopes[c].lo <= slopes[c].hi;
      }
      if (is_reached) farthest = next;
      if (!is_open) break;
    }
    anchor = farthest;
    knots[++kept] = knots[anchor];
  }
  knots.resize(kept + 1);
  // A constant one needs a single knot.
  const bool is_constant = knots.size() == 2 && std::equal(workspace.at(knots[0]), workspace.at(knots[0]) + components,
                                                           workspace.at(knots[1]));
  if (is_constant) knots.resize(1);
}

void Mixer::mix(double z, const RowLattice& lattice, SegmentRows& rows, Workspace& workspace, MixFaults& faults) const {
  Mixtures& out = rows.mixtures;
  out.clear();
  if (compositions_.empty()) return;
  workspace.along_ << lattice.along, 0.0;
  for (std::size_t r = 0; r < rows.rows(); ++r) {
    workspace.origin_ << lattice.position(lattice.first_row + static_cast<std::int64_t>(r)) * lattice.across, z;
    for (std::uint64_t i = rows.row_start[r]; i < rows.row_start[r + 1]; ++i) {
      const Segment& segment = rows.segments[i];
      workspace.components_ = compositions_.components(segment.solid);
      if (workspace.components_ == 0) continue;
      workspace.probe_.start_row(segment.solid,
                                 {workspace.origin_, workspace.along_, {segment.x_begin, segment.x_end}});
      lay_knots(segment, workspace, faults);
      thin_out(workspace);
      out.segment.push_back(i);
      for (const auto& knot : workspace.knots_) {
        out.x.push_back(knot.x);
        for (std::size_t c = 0; c < workspace.components_; ++c) {
          out.fraction.push_back(static_cast<float>(workspace.at(knot)[c]));
        }
      }
      out.knot_start.push_back(out.x.size());
      out.fraction_start.push_back(out.fraction.size());
    }
  }
}

namespace {

/// The integral of component `c` of graded segment `g` over the segment.
double component_length(const Mixtures& mixtures, std::size_t g, const Segment& segment, std::size_t c) {
  const std::span<const double> x = mixtures.knots(g);
  const std::span<const float> all = mixtures.fractions(g);
  const std::size_t components = all.size() / x.size();
  const auto fraction = [&](std::size_t knot) { return static_cast<double>(all[knot * components + c]); };
  double sum = (x.front() - segment.x_begin) * fraction(0) + (segment.x_end - x.back()) * fraction(x.size() - 1);
  for (std::size_t k = 0; k + 1 < x.size(); ++k) sum += 0.5 * (x[k + 1] - x[k]) * (fraction(k) + fraction(k + 1));
  return sum;
}

}  // namespace

void add_component_lengths(const SegmentRows& rows, const IdVector<MaterialId, Material>& materials,
                           std::vector<double>& lengths) {
  if (rows.mixtures.empty()) return;
  std::vector<CompensatedSum> sums(lengths.size());
  for (std::size_t m = 0; m < lengths.size(); ++m) {
    if (!materials[MaterialId{m}].is_graded()) sums[m].add(lengths[m]);
  }
  for (std::size_t g = 0; g < rows.mixtures.segment.size(); ++g) {
    const Segment& segment = rows.segments[rows.mixtures.segment[g]];
    const std::vector<MaterialId>& components = materials[segment.material].components;
    for (std::size_t c = 0; c < components.size(); ++c) {
      sums[components[c].value()].add(component_length(rows.mixtures, g, segment, c));
    }
  }
  for (std::size_t m = 0; m < lengths.size(); ++m) lengths[m] = sums[m].value();
}

}  // namespace lamella
