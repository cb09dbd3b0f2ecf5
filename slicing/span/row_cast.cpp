#include "slicing/span/row_cast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "model/bernstein_roots.h"
#include "slicing/span/arc_balance.h"

namespace lamella::span {

namespace {

/// Accepted residual of a row's y, mm; rows are solved to rounding, this only catches what failed.
constexpr double kRowResidual = 1e-9;

/// Hits of one solid may come in the wrong order over this length, whatever the file states: ten times the accuracy of
/// an arc between its exact points.
constexpr double kLeastTolerance = 1e-6;  // mm

/// Bernstein coefficients of y'(t) on [0, 1].
std::array<double, 5> slope_net(const std::array<double, 6>& y) {
  const double a = y[1], b = 2.0 * y[2], c = 3.0 * y[3], d = 4.0 * y[4], e = 5.0 * y[5];
  return {a, a + b / 4.0, a + b / 2.0 + c / 6.0, a + 0.75 * b + c / 2.0 + d / 4.0, a + b + c + d + e};
}

/// Sign changes in a row of Bernstein coefficients: no fewer than the polynomial has roots in (0, 1), and as many if
/// there is none or one (Descartes' rule).
int sign_changes(const std::array<double, 5>& net) {
  int changes = 0;
  double last = 0.0;
  for (const double value : net) {
    if (value == 0.0) continue;
    if (value * last < 0.0) ++changes;
    last = value;
  }
  return changes;
}

/// The one root of y'(t) in (0, 1).
double single_turn(const std::array<double, 6>& y, double at_begin) {
  double lo = 0.0;
  double hi = 1.0;
  double t = 0.5;
  for (int i = 0; i < 60 && hi - lo > 1e-16; ++i) {
    const double slope = y[1] + t * (2.0 * y[2] + t * (3.0 * y[3] + t * (4.0 * y[4] + t * 5.0 * y[5])));
    const double bend = 2.0 * y[2] + t * (6.0 * y[3] + t * (12.0 * y[4] + t * 20.0 * y[5]));
    (slope * at_begin > 0.0 ? lo : hi) = t;
    double next = t - slope / bend;
    if (!(next > lo && next < hi)) next = 0.5 * (lo + hi);
    if (std::abs(next - t) < 1e-15) return next;
    t = next;
  }
  return t;
}

/// Parameters in (0, 1) where y turns, ascending.
std::size_t find_turns(const std::array<double, 6>& y, std::array<double, 4>& turns) {
  const std::array<double, 5> net = slope_net(y);
  const int changes = sign_changes(net);
  if (changes == 0) return 0;
  if (changes == 1) {
    const double begin = *std::find_if(net.begin(), net.end(), [](double value) { return value != 0.0; });
    turns[0] = single_turn(y, begin);
    return 1;
  }
  const std::vector<double> roots = bernstein_roots(net, 0.0);
  const std::size_t count = std::min(roots.size(), turns.size());
  std::copy_n(roots.begin(), count, turns.begin());
  return count;
}

double value_at(const std::array<double, 6>& c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

}  // namespace

RowCast::RowCast(const Scene& scene)
    : scene_(&scene),
      winding_(scene.solids.size(), 0),
      open_span_(scene.solids.size(), 0),
      off_since_(scene.solids.size(), 0.0) {
  tolerance_.reserve(scene.solids.size());
  for (const Solid& solid : scene.solids) tolerance_.push_back(std::max(kLeastTolerance, solid.info.max_tolerance));
}

void RowCast::cast(const Section& section, const RowLattice& lattice, std::size_t number, LayerSpans& out) {
  lay_rows(lattice);
  turn_pieces(section, lattice);
  collect(section, lattice);
  check_balance(section, lattice);
  fill(section, out);
  emit(section, out.lattices[number], out);
}

void RowCast::lay_rows(const RowLattice& lattice) {
  rows_.resize(static_cast<std::size_t>(lattice.last_row - lattice.first_row));
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    rows_[r] = lattice.position(lattice.first_row + static_cast<std::int64_t>(r));
  }
  inverse_spacing_ = 1.0 / lattice.spacing;
  row_begin_.assign(rows_.size() + 2, 0);
}

void RowCast::turn_pieces(const Section& section, const RowLattice& lattice) {
  pieces_ = section.pieces.data();
  if (lattice.along == Vec2::UnitX()) return;
  turned_.resize(section.pieces.size());
  for (std::size_t i = 0; i < turned_.size(); ++i) {
    const ArcPiece& from = section.pieces[i];
    for (int k = 0; k < 6; ++k) {
      turned_[i].x[k] = lattice.along.x() * from.x[k] + lattice.along.y() * from.y[k];
      turned_[i].y[k] = lattice.across.x() * from.x[k] + lattice.across.y() * from.y[k];
    }
  }
  pieces_ = turned_.data();
}

std::uint32_t RowCast::first_row_at(double y) const {
  if (rows_.empty()) return 0;
  const double guess = std::clamp((y - rows_.front()) * inverse_spacing_, 0.0, static_cast<double>(rows_.size()));
  auto row = static_cast<std::uint32_t>(guess);
  while (row > 0 && rows_[row - 1] >= y) --row;
  while (row < rows_.size() && rows_[row] < y) ++row;
  return row;
}

void RowCast::add_stretch(std::uint32_t arc, std::uint32_t piece, double y_begin, double y_end, double t_begin,
                          double t_end) {
  const bool rises = y_begin < y_end;
  const std::uint32_t first = first_row_at(rises ? y_begin : y_end);
  const std::uint32_t last = first_row_at(rises ? y_end : y_begin);
  if (first == last) return;
  stretches_.push_back({arc, piece, first, last, t_begin, t_end, rises});
  ++row_begin_[first + 1];
  --row_begin_[last + 1];
}

void RowCast::collect_arc(const SectionArc& arc, std::uint32_t index, const RowLattice& lattice) {
  double y = lattice.across.dot(arc.begin);
  const double y_last = lattice.across.dot(arc.end);
  for (std::uint32_t i = 0; i < arc.piece_count; ++i) {
    const std::uint32_t number = arc.first_piece + i;
    const ArcPiece& piece = pieces_[number];
    const bool is_last = i + 1 == arc.piece_count;
    double t = 0.0;
    std::array<double, 4> turns;
    const std::size_t turn_count = arc.straight ? 0 : find_turns(piece.y, turns);
    for (std::size_t k = 0; k < turn_count; ++k) {
      const double y_turn = value_at(piece.y, turns[k]);
      add_stretch(index, number, y, y_turn, t, turns[k]);
      y = y_turn;
      t = turns[k];
    }
    const double y_end = is_last ? y_last : value_at(piece.y, 1.0);
    add_stretch(index, number, y, y_end, t, 1.0);
    y = y_end;
  }
}

void RowCast::collect_ellipse(const SectionArc& arc, const EllipseArc& part, std::uint32_t index,
                              const RowLattice& lattice) {
  const PlaneEllipse& ellipse = part.ellipse;
  const double cos_y = lattice.across.dot(ellipse.cosine);
  const double sin_y = lattice.across.dot(ellipse.sine);
  const double cos_x = lattice.along.dot(ellipse.cosine);
  const double sin_x = lattice.along.dot(ellipse.sine);
  // With a the angle from the turn at the top: y = center + reach cos a, x = center + slant cos a + bulge sin a.
  RoundTask task;
  task.center_x = lattice.along.dot(ellipse.center);
  task.center_y = lattice.across.dot(ellipse.center);
  task.reach = std::hypot(cos_y, sin_y);
  if (task.reach > 0.0) {
    task.slant = (cos_x * cos_y + sin_x * sin_y) / task.reach;
    task.bulge = (sin_x * cos_y - cos_x * sin_y) / task.reach;
  }
  double a = part.begin - std::atan2(sin_y, cos_y);
  a -= kTwoPi * std::floor(a / kTwoPi);
  const double last = a + part.sweep;
  const bool forward = part.sweep > 0.0;
  double y = lattice.across.dot(arc.begin);
  const double bulge = task.bulge;
  for (double half = forward ? std::floor(a / kPi) : std::ceil(a / kPi) - 1.0;; half += forward ? 1.0 : -1.0) {
    const double turn = (forward ? half + 1.0 : half) * kPi;
    const bool is_last = forward ? turn >= last : turn <= last;
    const bool is_even_turn = std::fmod(std::abs(forward ? half + 1.0 : half), 2.0) == 0.0;
    const double y_end =
        is_last ? lattice.across.dot(arc.end) : task.center_y + (is_even_turn ? task.reach : -task.reach);
    task.bulge = std::fmod(std::abs(half), 2.0) == 0.0 ? bulge : -bulge;
    const std::size_t before = stretches_.size();
    add_stretch(index, static_cast<std::uint32_t>(rounds_.size()), y, y_end, 0.0, 1.0);
    if (stretches_.size() > before) {
      stretches_.back().is_round = true;
      rounds_.push_back(task);
    }
    if (is_last) return;
    y = y_end;
  }
}

void RowCast::collect(const Section& section, const RowLattice& lattice) {
  stretches_.clear();
  rounds_.clear();
  solid_of_arc_.resize(section.arcs.size());
  for (std::uint32_t i = 0; i < section.arcs.size(); ++i) {
    solid_of_arc_[i] = scene_->solid_of(section.arcs[i].face);
    const SectionArc& arc = section.arcs[i];
    if (arc.ellipse >= 0) {
      collect_ellipse(arc, section.ellipses[static_cast<std::size_t>(arc.ellipse)], i, lattice);
    } else {
      collect_arc(arc, i, lattice);
    }
  }
  // From differences to the number of hits a row to where its hits begin.
  std::uint32_t hits = 0;
  std::uint32_t total = 0;
  for (std::size_t r = 0; r < row_begin_.size(); ++r) {
    hits += row_begin_[r];
    total += hits;
    row_begin_[r] = total;
  }
}

void RowCast::fill_straight(const Stretch& stretch, double* xs) const {
  const ArcPiece& piece = pieces_[stretch.piece];
  const double rise = piece.y[1];
  const double per_rise = rise == 0.0 ? 0.0 : 1.0 / rise;
  const double* rows = rows_.data() + stretch.first_row;
  const std::size_t count = stretch.last_row - stretch.first_row;
  for (std::size_t i = 0; i < count; ++i) {
    const double t = (rows[i] - piece.y[0]) * per_rise;
    xs[i] = piece.x[0] + std::min(std::max(t, 0.0), 1.0) * piece.x[1];
  }
}

std::size_t RowCast::solve(const Stretch& stretch, bool straight, double* xs) const {
  const double* rows = rows_.data() + stretch.first_row;
  const std::size_t count = stretch.last_row - stretch.first_row;
  const DepthKernel& kernel = depth_kernel();
  if (straight) {
    fill_straight(stretch, xs);
    return 0;
  }
  if (stretch.is_round) {
    kernel.round(rounds_[stretch.piece], rows, count, xs);
    return 0;
  }
  const ArcPiece& piece = pieces_[stretch.piece];
  return kernel.solve({piece.x.data(), piece.y.data(), stretch.t_begin, stretch.t_end}, rows, count, kRowResidual, xs);
}

void RowCast::check_balance(const Section& section, const RowLattice& lattice) {
  is_unbalanced_.assign(section.arcs.size(), 0);
  for (std::size_t i = 0; i < section.arcs.size(); ++i) {
    const double tolerance = tolerance_[solid_of_arc_[i].value()];
    if (!keeps_balance(section.arcs[i], section, lattice, tolerance)) is_unbalanced_[i] = 1;
  }
}

void RowCast::fill(const Section& section, LayerSpans& out) {
  const std::uint32_t total = row_begin_[rows_.size()];
  hits_.resize(total);
  cursor_.assign(row_begin_.begin(), row_begin_.end());
  for (const Stretch& stretch : stretches_) {
    const std::size_t count = stretch.last_row - stretch.first_row;
    if (xs_.size() < count) xs_.resize(count);
    const SectionArc& arc = section.arcs[stretch.arc];
    const std::size_t failed = solve(stretch, arc.straight, xs_.data());
    const bool is_doubtful = arc.doubtful || is_unbalanced_[stretch.arc] != 0;
    if (is_doubtful || failed > 0) {
      const Check check = arc.doubtful ? Check::arcs : (is_doubtful ? Check::balance : Check::depth);
      const std::size_t doubts = is_doubtful ? count : failed;
      out.cast.uncertain_hits += doubts;
      note_failed(out.failed, {check, solid_of_arc_[stretch.arc], arc.face, doubts});
    }
    const std::uint32_t tag = 2 * stretch.arc + (stretch.rises ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) hits_[cursor_[stretch.first_row + i]++] = {xs_[i], tag};
  }
  out.cast.hits += total;
}

void RowCast::emit(const Section& section, SpanRows& rows, LayerSpans& out) {
  rows.row_start.clear();
  rows.spans.clear();
  rows.row_start.reserve(rows_.size() + 1);
  rows.spans.reserve(hits_.size() / 2);
  rows.row_start.push_back(0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    emit_row(section, hits_.data() + row_begin_[r], hits_.data() + row_begin_[r + 1], rows, out);
    rows.row_start.push_back(rows.spans.size());
  }
}

void RowCast::note_winding(SolidId solid, FaceId face, std::int32_t before, double x, LayerSpans& out) {
  const std::int32_t now = winding_[solid.value()];
  const auto is_off = [](std::int32_t winding) { return winding < 0 || winding > 1; };
  if (!is_off(before) && is_off(now)) {
    off_since_[solid.value()] = x;
  } else if (is_off(before) && !is_off(now) && x - off_since_[solid.value()] > tolerance_[solid.value()]) {
    ++out.cast.repaired_rays;
    note_failed(out.failed, {Check::winding, solid, face, 1, x - off_since_[solid.value()]});
  }
}

void RowCast::emit_row(const Section& section, RowHit* first, RowHit* last, SpanRows& rows, LayerSpans& out) {
  const auto before = [](const RowHit& a, const RowHit& b) { return a.x != b.x ? a.x < b.x : a.tag < b.tag; };
  for (RowHit* i = first + 1; i < last; ++i) {
    const RowHit hit = *i;
    RowHit* j = i;
    for (; j > first && before(hit, j[-1]); --j) *j = j[-1];
    *j = hit;
  }
  const std::size_t row_first = rows.spans.size();
  for (const RowHit* hit = first; hit < last; ++hit) {
    const std::uint32_t arc = hit->tag >> 1;
    const SolidId solid = solid_of_arc_[arc];
    std::int32_t& winding = winding_[solid.value()];
    const bool is_exit = (hit->tag & 1) != 0;
    winding += is_exit ? -1 : 1;
    if (winding < 0 || winding > 1 || winding == (is_exit ? 1 : 0)) {
      note_winding(solid, section.arcs[arc].face, is_exit ? winding + 1 : winding - 1, hit->x, out);
    }
    if (!is_exit) {
      if (winding != 1) continue;
      open_span_[solid.value()] = rows.spans.size();
      rows.spans.push_back({hit->x, hit->x, solid, section.arcs[arc].face, {}});
    } else if (winding == 0) {
      Span& span = rows.spans[open_span_[solid.value()]];
      span.end = hit->x;
      span.face_out = section.arcs[arc].face;
    }
  }
  for (const RowHit* hit = first; hit < last; ++hit) {
    const SolidId solid = solid_of_arc_[hit->tag >> 1];
    std::int32_t& winding = winding_[solid.value()];
    if (winding == 0) continue;
    ++out.cast.unclosed_rays;
    note_failed(out.failed, {Check::closure, solid, {}, 1});
    winding = 0;
  }
  const auto order = [](const Span& a, const Span& b) {
    return std::tie(a.begin, a.end, a.solid) < std::tie(b.begin, b.end, b.solid);
  };
  const auto begin = rows.spans.begin() + static_cast<std::ptrdiff_t>(row_first);
  if (!std::is_sorted(begin, rows.spans.end(), order)) std::sort(begin, rows.spans.end(), order);
}

}  // namespace lamella::span
