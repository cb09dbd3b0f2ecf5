#include "slicing/span/row_columns.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/bernstein_roots.h"

namespace lamella::span {

namespace {

/// Accepted residual of a row's y, mm; rows are solved to rounding, this only catches what failed.
constexpr double kRowResidual = 1e-9;

/// Bernstein coefficients of y'(t) on [0, 1].
std::array<double, 5> slope_net(const std::array<double, 6>& y) {
  const double a = y[1], b = 2.0 * y[2], c = 3.0 * y[3], d = 4.0 * y[4], e = 5.0 * y[5];
  return {a, a + b / 4.0, a + b / 2.0 + c / 6.0, a + 0.75 * b + c / 2.0 + d / 4.0, a + b + c + d + e};
}

/// Whether no two coefficients have opposite signs: then the polynomial has no root in (0, 1).
bool keeps_sign(const std::array<double, 5>& net) {
  const double least = std::min(std::min(std::min(net[0], net[1]), std::min(net[2], net[3])), net[4]);
  const double most = std::max(std::max(std::max(net[0], net[1]), std::max(net[2], net[3])), net[4]);
  return least >= 0.0 || most <= 0.0;
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
  if (keeps_sign(net)) return 0;
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

void RowColumns::find(const Scene& scene, const Section& section, const RowLattice& lattice) {
  lay_rows(lattice);
  turn_pieces(section, lattice);
  collect(scene, section, lattice);
  solve();
}

void RowColumns::lay_rows(const RowLattice& lattice) {
  rows_.resize(lattice.rows());
  // RowLattice::position with its sum of integers done in floating point, where it is exact as well and makes vectors.
  const auto first = static_cast<double>(lattice.first_row);
  const auto count = static_cast<std::int32_t>(rows_.size());
  for (std::int32_t r = 0; r < count; ++r) {
    rows_[static_cast<std::size_t>(r)] = lattice.anchor + (first + r + 0.5) * lattice.spacing;
  }
  inverse_spacing_ = 1.0 / lattice.spacing;
}

void RowColumns::turn_pieces(const Section& section, const RowLattice& lattice) {
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

std::uint32_t RowColumns::first_row_at(double y) const {
  if (rows_.empty()) return 0;
  const double guess = std::clamp((y - rows_.front()) * inverse_spacing_, 0.0, static_cast<double>(rows_.size()));
  auto row = static_cast<std::uint32_t>(guess);
  while (row > 0 && rows_[row - 1] >= y) --row;
  while (row < rows_.size() && rows_[row] < y) ++row;
  return row;
}

/// The stretch runs from a y whose first row is `from_row` to one whose first row is `to_row`: rows are half open
/// whichever way it runs.
void RowColumns::add_stretch(const Source& source, std::uint32_t from_row, std::uint32_t to_row, Stretch stretch) {
  if (from_row == to_row) return;
  const bool rises = from_row < to_row;
  stretch.first_row = rises ? from_row : to_row;
  stretch.last_row = rises ? to_row : from_row;
  const std::uint32_t tag = 2 * source.arc + (rises ? 1 : 0);
  const bool goes_on = columns_.size() > source.first_column && columns_.back().tag == tag &&
                       (rises ? columns_.back().last_row : columns_.back().first_row) == from_row;
  if (goes_on) {
    (rises ? columns_.back().last_row : columns_.back().first_row) = to_row;
  } else {
    columns_.push_back({tag, stretch.first_row, stretch.last_row, 0, 0, source.solid, source.face});
  }
  stretch.column = static_cast<std::uint32_t>(columns_.size() - 1);
  stretches_.push_back(stretch);
  (stretch.shape == Shape::quintic ? quintic_rows_ : other_rows_) += stretch.last_row - stretch.first_row;
}

void RowColumns::collect_pieces(const SectionArc& arc, const Source& source, const RowLattice& lattice) {
  const Shape shape = arc.straight ? Shape::straight : Shape::quintic;
  std::uint32_t row = first_row_at(lattice.across.dot(arc.begin));
  for (std::uint32_t i = 0; i < arc.piece_count; ++i) {
    const std::uint32_t number = arc.first_piece + i;
    const ArcPiece& piece = pieces_[number];
    const bool is_last = i + 1 == arc.piece_count;
    double t = 0.0;
    std::array<double, 4> turns;
    const std::size_t turn_count = arc.straight ? 0 : find_turns(piece.y, turns);
    for (std::size_t k = 0; k < turn_count; ++k) {
      const std::uint32_t turn_row = first_row_at(value_at(piece.y, turns[k]));
      add_stretch(source, row, turn_row, {0, number, 0, 0, t, turns[k], shape});
      row = turn_row;
      t = turns[k];
    }
    const std::uint32_t end_row = first_row_at(is_last ? lattice.across.dot(arc.end) : value_at(piece.y, 1.0));
    add_stretch(source, row, end_row, {0, number, 0, 0, t, 1.0, shape});
    row = end_row;
  }
}

void RowColumns::collect_ellipse(const SectionArc& arc, const EllipseArc& part, const Source& source,
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
  std::uint32_t row = first_row_at(lattice.across.dot(arc.begin));
  const double bulge = task.bulge;
  for (double half = forward ? std::floor(a / kPi) : std::ceil(a / kPi) - 1.0;; half += forward ? 1.0 : -1.0) {
    const double turn = (forward ? half + 1.0 : half) * kPi;
    const bool is_last = forward ? turn >= last : turn <= last;
    const bool is_even_turn = std::fmod(std::abs(forward ? half + 1.0 : half), 2.0) == 0.0;
    const double y_end =
        is_last ? lattice.across.dot(arc.end) : task.center_y + (is_even_turn ? task.reach : -task.reach);
    const std::uint32_t end_row = first_row_at(y_end);
    task.bulge = std::fmod(std::abs(half), 2.0) == 0.0 ? bulge : -bulge;
    add_stretch(source, row, end_row, {0, static_cast<std::uint32_t>(rounds_.size()), 0, 0, 0.0, 1.0, Shape::round});
    if (end_row != row) rounds_.push_back(task);
    if (is_last) return;
    row = end_row;
  }
}

void RowColumns::collect(const Scene& scene, const Section& section, const RowLattice& lattice) {
  stretches_.clear();
  rounds_.clear();
  columns_.clear();
  quintic_rows_ = 0;
  other_rows_ = 0;
  for (std::uint32_t i = 0; i < section.arcs.size(); ++i) {
    const SectionArc& arc = section.arcs[i];
    const Source source{i, scene.solid_of(arc.face), arc.face, columns_.size()};
    if (arc.ellipse >= 0) {
      collect_ellipse(arc, section.ellipses[static_cast<std::size_t>(arc.ellipse)], source, lattice);
    } else {
      collect_pieces(arc, source, lattice);
    }
  }
}

void RowColumns::solve() {
  xs_.resize(quintic_rows_ + other_rows_);
  tasks_.clear();
  task_columns_.clear();
  std::size_t next_quintic = 0;
  std::size_t next_other = quintic_rows_;
  for (std::size_t begin = 0; begin < stretches_.size();) {
    const std::uint32_t number = stretches_[begin].column;
    std::size_t end = begin + 1;
    while (end < stretches_.size() && stretches_[end].column == number) ++end;
    Column& column = columns_[number];
    const std::span<const Stretch> parts(stretches_.data() + begin, end - begin);
    if (parts.front().shape == Shape::quintic) {
      column.first_x = next_quintic;
      next_quintic += column.rows();
      add_tasks(parts, column);
    } else {
      column.first_x = next_other;
      next_other += column.rows();
      for (const Stretch& part : parts) solve_directly(part, column);
    }
    begin = end;
  }
  depth_kernel().solve(tasks_.data(), tasks_.size(), kRowResidual, xs_.data());
  for (std::size_t i = 0; i < tasks_.size(); ++i) {
    columns_[task_columns_[i]].failed += static_cast<std::uint32_t>(tasks_[i].failed);
  }
}

/// In ascending order of the rows: the kernel puts the xs of all tasks one after the other.
void RowColumns::add_tasks(std::span<const Stretch> parts, const Column& column) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Stretch& part = parts[column.is_exit() ? i : parts.size() - 1 - i];
    const ArcPiece& piece = pieces_[part.piece];
    const std::size_t count = part.last_row - part.first_row;
    tasks_.push_back({piece.x.data(), piece.y.data(), part.t_begin, part.t_end, rows_.data() + part.first_row, count});
    task_columns_.push_back(part.column);
  }
}

void RowColumns::solve_directly(const Stretch& part, const Column& column) {
  const double* rows = rows_.data() + part.first_row;
  const std::size_t count = part.last_row - part.first_row;
  double* xs = xs_.data() + column.first_x + (part.first_row - column.first_row);
  if (part.shape == Shape::round) {
    depth_kernel().round(rounds_[part.piece], rows, count, xs);
  } else {
    const ArcPiece& piece = pieces_[part.piece];
    depth_kernel().line({piece.x[0], piece.x[1], piece.y[0], piece.y[1]}, rows, count, xs);
  }
}

}  // namespace lamella::span
