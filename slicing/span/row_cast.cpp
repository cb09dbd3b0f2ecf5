#include "slicing/span/row_cast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "model/bernstein_roots.h"
#include "slicing/span/depth_kernel.h"

namespace lamella::span {

namespace {

/// Accepted residual of a row's y, mm; rows are solved to rounding, this only catches what failed.
constexpr double kRowResidual = 1e-9;

/// Bernstein coefficients of y'(t) on [0, 1].
std::array<double, 5> slope_net(const std::array<double, 6>& y) {
  const double a = y[1], b = 2.0 * y[2], c = 3.0 * y[3], d = 4.0 * y[4], e = 5.0 * y[5];
  return {a, a + b / 4.0, a + b / 2.0 + c / 6.0, a + 0.75 * b + c / 2.0 + d / 4.0, a + b + c + d + e};
}

bool keeps_sign(const std::array<double, 5>& net) {
  const auto [lowest, highest] = std::minmax_element(net.begin(), net.end());
  return *lowest >= 0.0 || *highest <= 0.0;
}

double value_at(const std::array<double, 6>& c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

}  // namespace

RowCast::RowCast(const Scene& scene)
    : scene_(&scene), winding_(scene.solids.size(), 0), open_span_(scene.solids.size(), 0) {}

void RowCast::cast(const Section& section, const RowLattice& lattice, SpanRows& out, CastCounters& counters) {
  lay_rows(lattice);
  turn_pieces(section, lattice);
  collect(section, lattice);
  fill(section, counters);
  emit(section, out, counters);
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
    if (!arc.straight) {
      const std::array<double, 5> net = slope_net(piece.y);
      if (!keeps_sign(net)) {
        for (const double turn : bernstein_roots(net, 0.0)) {
          const double y_turn = value_at(piece.y, turn);
          add_stretch(index, number, y, y_turn, t, turn);
          y = y_turn;
          t = turn;
        }
      }
    }
    const double y_end = is_last ? y_last : value_at(piece.y, 1.0);
    add_stretch(index, number, y, y_end, t, 1.0);
    y = y_end;
  }
}

void RowCast::collect(const Section& section, const RowLattice& lattice) {
  stretches_.clear();
  solid_of_arc_.resize(section.arcs.size());
  for (std::uint32_t i = 0; i < section.arcs.size(); ++i) {
    solid_of_arc_[i] = scene_->solid_of(section.arcs[i].face);
    collect_arc(section.arcs[i], i, lattice);
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

void RowCast::fill(const Section& section, CastCounters& counters) {
  const std::uint32_t total = row_begin_[rows_.size()];
  hits_.resize(total);
  cursor_.assign(row_begin_.begin(), row_begin_.end());
  const DepthKernel& kernel = depth_kernel();
  for (const Stretch& stretch : stretches_) {
    const std::size_t count = stretch.last_row - stretch.first_row;
    if (xs_.size() < count) xs_.resize(count);
    const SectionArc& arc = section.arcs[stretch.arc];
    if (arc.straight) {
      fill_straight(stretch, xs_.data());
      if (arc.doubtful) counters.uncertain_hits += count;
    } else {
      const ArcPiece& piece = pieces_[stretch.piece];
      const DepthTask task{piece.x.data(), piece.y.data(), stretch.t_begin, stretch.t_end};
      counters.uncertain_hits += kernel.solve(task, rows_.data() + stretch.first_row, count, kRowResidual, xs_.data());
    }
    const std::uint32_t tag = 2 * stretch.arc + (stretch.rises ? 1 : 0);
    for (std::size_t i = 0; i < count; ++i) hits_[cursor_[stretch.first_row + i]++] = {xs_[i], tag};
  }
  counters.hits += total;
}

void RowCast::emit(const Section& section, SpanRows& out, CastCounters& counters) {
  out.row_start.clear();
  out.spans.clear();
  out.row_start.reserve(rows_.size() + 1);
  out.spans.reserve(hits_.size() / 2);
  out.row_start.push_back(0);
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    emit_row(section, hits_.data() + row_begin_[r], hits_.data() + row_begin_[r + 1], out, counters);
    out.row_start.push_back(out.spans.size());
  }
}

void RowCast::emit_row(const Section& section, RowHit* first, RowHit* last, SpanRows& out, CastCounters& counters) {
  const auto before = [](const RowHit& a, const RowHit& b) { return a.x != b.x ? a.x < b.x : a.tag < b.tag; };
  for (RowHit* i = first + 1; i < last; ++i) {
    const RowHit hit = *i;
    RowHit* j = i;
    for (; j > first && before(hit, j[-1]); --j) *j = j[-1];
    *j = hit;
  }
  const std::size_t row_first = out.spans.size();
  for (const RowHit* hit = first; hit < last; ++hit) {
    const std::uint32_t arc = hit->tag >> 1;
    const SolidId solid = solid_of_arc_[arc];
    std::int32_t& winding = winding_[solid.value()];
    if ((hit->tag & 1) == 0) {
      if (++winding != 1) continue;
      open_span_[solid.value()] = out.spans.size();
      out.spans.push_back({hit->x, hit->x, solid, section.arcs[arc].face, {}});
    } else if (--winding == 0) {
      Span& span = out.spans[open_span_[solid.value()]];
      span.end = hit->x;
      span.face_out = section.arcs[arc].face;
    }
  }
  for (const RowHit* hit = first; hit < last; ++hit) {
    std::int32_t& winding = winding_[solid_of_arc_[hit->tag >> 1].value()];
    if (winding == 0) continue;
    ++counters.unclosed_rays;
    winding = 0;
  }
  const auto order = [](const Span& a, const Span& b) {
    return std::tie(a.begin, a.end, a.solid) < std::tie(b.begin, b.end, b.solid);
  };
  const auto begin = out.spans.begin() + static_cast<std::ptrdiff_t>(row_first);
  if (!std::is_sorted(begin, out.spans.end(), order)) std::sort(begin, out.spans.end(), order);
}

}  // namespace lamella::span
