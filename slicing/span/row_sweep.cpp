#include "slicing/span/row_sweep.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace lamella::span {

namespace {

/// Hits of one solid may come in the wrong order over this length, whatever the file states: ten times the accuracy of
/// an arc between its exact points.
constexpr double kLeastTolerance = 1e-6;  // mm

/// Rows looked at together after the order has changed; twice as many each time that it doesn't.
constexpr std::size_t kLookAhead = 8;

/// Of more columns that begin on one row, each is no longer carried to its place past all that it precedes.
constexpr std::size_t kFewColumns = 8;

bool precedes(const Span& a, const Span& b) {
  return std::tie(a.begin, a.end, a.solid) < std::tie(b.begin, b.end, b.solid);
}

/// Whether a[i] < b[i] for all i.
bool is_below(const double* a, const double* b, std::size_t count) {
  std::int64_t others = 0;
  for (std::size_t i = 0; i < count; ++i) others |= a[i] < b[i] ? 0 : 1;
  return others == 0;
}

}  // namespace

double order_tolerance(const Solid& solid) { return std::max(kLeastTolerance, solid.info.max_tolerance); }

RowSweep::RowSweep(const Scene& scene) : solids_(scene.solids.size()) {
  for (const SolidId id : scene.solids.ids()) solids_[id.value()].tolerance = order_tolerance(scene.solids[id]);
}

void RowSweep::sweep(const RowColumns& columns, SpanRows& rows, LayerSpans& out) {
  start(columns, rows);
  const auto count = static_cast<std::uint32_t>(columns.rows());
  for (std::uint32_t row = 0; row < count;) {
    end_columns(row);
    sort_crossings(begin_columns(columns, row));
    find_bounds();
    const std::uint32_t end = next_change(row);
    write_run(row, end, rows.row_start.data() + row + 1, out);
    row = end;
  }
  rows.spans.assign(spans_.begin(), spans_.begin() + static_cast<std::ptrdiff_t>(span_count_));
}

void RowSweep::start(const RowColumns& columns, SpanRows& rows) {
  rows.row_start.resize(columns.rows() + 1);
  rows.row_start[0] = 0;
  crossings_.clear();
  span_count_ = 0;
  begins_at_.assign(columns.rows(), 0);
  begins_too_.resize(columns.columns().size());
  std::size_t entries = 0;
  for (std::uint32_t i = 0; i < begins_too_.size(); ++i) {
    const Column& column = columns.columns()[i];
    begins_too_[i] = std::exchange(begins_at_[column.first_row], i + 1);
    if (!column.is_exit()) entries += column.rows();
  }
  if (spans_.size() < entries) spans_.resize(entries);
}

void RowSweep::end_columns(std::uint32_t row) {
  std::erase_if(crossings_, [&](const Crossing& crossing) { return crossing.column->last_row == row; });
}

/// Returns how many.
std::size_t RowSweep::begin_columns(const RowColumns& columns, std::uint32_t row) {
  const std::size_t before = crossings_.size();
  for (std::uint32_t i = begins_at_[row]; i != 0; i = begins_too_[i - 1]) {
    const Column& column = columns.columns()[i - 1];
    crossings_.push_back({columns.xs(column), &column});
  }
  return crossings_.size() - before;
}

/// The next row on which a column ends or begins.
std::uint32_t RowSweep::next_change(std::uint32_t row) const {
  auto end = static_cast<std::uint32_t>(begins_at_.size());
  for (const Crossing& crossing : crossings_) end = std::min(end, crossing.column->last_row);
  for (++row; row < end && begins_at_[row] == 0;) ++row;
  return row;
}

/// The last `added` crossings are new, the others nearly in order.
void RowSweep::sort_crossings(std::size_t added) {
  Crossing* const first = crossings_.data();
  Crossing* const last = first + crossings_.size();
  const bool few = added <= kFewColumns;
  Crossing* const middle = few ? last : last - added;
  for (Crossing* i = first; i < middle; ++i) {
    const Crossing crossing = *i;
    Crossing* j = i;
    for (; j > first && crossing.is_before(j[-1]); --j) *j = j[-1];
    *j = crossing;
  }
  if (few) return;
  const auto before = [](const Crossing& a, const Crossing& b) { return a.is_before(b); };
  std::stable_sort(middle, last, before);
  std::inplace_merge(first, middle, last, before);
}

/// Finds which crossings bound each solid's spans on the current row.
void RowSweep::find_bounds() {
  bounds_.clear();
  is_regular_ = true;
  for (std::uint32_t i = 0; i < crossings_.size(); ++i) {
    const Column& column = *crossings_[i].column;
    SolidState& solid = solids_[column.solid.value()];
    is_regular_ &= solid.winding == (column.is_exit() ? 1 : 0);
    if (!is_regular_) break;
    solid.winding = 1 - solid.winding;
    if (column.is_exit()) {
      bounds_[solid.open].leaves = i;
    } else {
      solid.open = bounds_.size();
      bounds_.push_back({i, i});
    }
  }
  is_regular_ &= 2 * bounds_.size() == crossings_.size();
  if (!is_regular_) {
    bounds_.clear();
    for (const Crossing& crossing : crossings_) solids_[crossing.column->solid.value()].winding = 0;
  }
  find_order();
}

/// Finds which crossings must keep their order for bounds_ to stay right, or the windings if there are none.
void RowSweep::find_order() {
  order_.clear();
  ++searches_;
  for (std::uint32_t i = 0; i < crossings_.size(); ++i) {
    SolidState& solid = solids_[crossings_[i].column->solid.value()];
    if (solid.met == searches_) order_.push_back({solid.last, i});
    solid.met = searches_;
    solid.last = i;
  }
  for (std::size_t k = 1; k < bounds_.size(); ++k) {
    const Order entries{bounds_[k - 1].enters, bounds_[k].enters};
    const bool is_known = crossings_[entries.before].column->solid == crossings_[entries.after].column->solid;
    if (!is_known) order_.push_back(entries);
  }
}

/// How many of the next `count` rows have their crossings in order.
std::size_t RowSweep::rows_in_order(std::size_t count) {
  has_ties_ = false;
  for (const Order& order : order_) {
    const Crossing& a = crossings_[order.before];
    const Crossing& b = crossings_[order.after];
    if (is_below(a.xs, b.xs, count)) continue;
    const bool may_tie = a.column->tag <= b.column->tag;
    std::size_t row = 0;
    for (; row < count && (a.xs[row] < b.xs[row] || (may_tie && a.xs[row] == b.xs[row])); ++row) {
      has_ties_ |= a.xs[row] == b.xs[row];
    }
    count = row;
  }
  return count;
}

/// Writes rows [row, end), between which no column begins or ends. `row_end` is where to put the end of the first
/// row's spans.
void RowSweep::write_run(std::uint32_t row, std::uint32_t end, std::uint64_t* row_end, LayerSpans& out) {
  std::size_t left = end - row;
  std::size_t look_ahead = left;
  for (bool is_sorted = true; left > 0;) {
    const std::size_t looked_at = std::min(left, look_ahead);
    std::size_t count = rows_in_order(looked_at);
    // A row that has been sorted is in order, unless its xs aren't numbers; it must be written all the same.
    if (is_sorted) count = std::max<std::size_t>(count, 1);
    write_rows(count, row_end, out);
    row_end += count;
    left -= count;
    look_ahead *= 2;
    is_sorted = count < looked_at;
    if (!is_sorted) continue;
    look_ahead = kLookAhead;
    sort_crossings(0);
    find_bounds();
  }
}

/// Writes the next `count` rows, which have their crossings in order.
void RowSweep::write_rows(std::size_t count, std::uint64_t* row_end, LayerSpans& out) {
  if (is_regular_) {
    write_bounded(count, row_end);
    for (Crossing& crossing : crossings_) crossing.xs += count;
    return;
  }
  for (std::size_t i = 0; i < count; ++i) {
    write_by_winding(row_end + i, out);
    for (Crossing& crossing : crossings_) ++crossing.xs;
  }
}

void RowSweep::write_bounded(std::size_t count, std::uint64_t* row_end) {
  const std::size_t width = bounds_.size();
  Span* const first = spans_.data() + span_count_;
  for (std::size_t k = 0; k < width; ++k) {
    const Crossing enters = crossings_[bounds_[k].enters];
    const Crossing leaves = crossings_[bounds_[k].leaves];
    const SolidId solid = enters.column->solid;
    const FaceId face_in = enters.column->face;
    const FaceId face_out = leaves.column->face;
    Span* span = first + k;
    for (std::size_t i = 0; i < count; ++i, span += width) {
      *span = {enters.xs[i], leaves.xs[i], solid, face_in, face_out};
    }
  }
  for (std::size_t i = 0; i < count; ++i) row_end[i] = span_count_ += width;
  // Entries that tie are in the order of their arcs.
  if (!has_ties_) return;
  for (Span* row = first; row < first + count * width; row += width) {
    if (!std::is_sorted(row, row + width, precedes)) std::sort(row, row + width, precedes);
  }
}

/// `before`: the winding of the column's solid before the crossing at x.
void RowSweep::note_winding(const Column& column, std::int32_t before, double x, LayerSpans& out) {
  SolidState& solid = solids_[column.solid.value()];
  const auto is_off = [](std::int32_t winding) { return winding < 0 || winding > 1; };
  if (!is_off(before) && is_off(solid.winding)) {
    solid.off_since = x;
  } else if (is_off(before) && !is_off(solid.winding) && x - solid.off_since > solid.tolerance) {
    ++out.cast.repaired_rays;
    note_failed(out.failed, {Check::winding, column.solid, column.face, 1, x - solid.off_since});
  }
}

/// Writes the current row: a span of a solid is where its winding is one or more.
void RowSweep::write_by_winding(std::uint64_t* row_end, LayerSpans& out) {
  Span* const first = spans_.data() + span_count_;
  for (const Crossing& crossing : crossings_) {
    const Column& column = *crossing.column;
    const double x = *crossing.xs;
    SolidState& solid = solids_[column.solid.value()];
    const std::int32_t before = std::exchange(solid.winding, solid.winding + (column.is_exit() ? -1 : 1));
    note_winding(column, before, x, out);
    if (!column.is_exit() && solid.winding == 1) {
      solid.open = span_count_;
      spans_[span_count_++] = {x, x, column.solid, column.face, {}};
    } else if (column.is_exit() && solid.winding == 0) {
      Span& span = spans_[solid.open];
      span.end = x;
      span.face_out = column.face;
    }
  }
  close_solids(out);
  *row_end = span_count_;
  Span* const last = spans_.data() + span_count_;
  if (!std::is_sorted(first, last, precedes)) std::sort(first, last, precedes);
}

/// Solids that the current row enters more or less often than it leaves them.
void RowSweep::close_solids(LayerSpans& out) {
  for (const Crossing& crossing : crossings_) {
    const SolidId solid = crossing.column->solid;
    if (std::exchange(solids_[solid.value()].winding, 0) == 0) continue;
    ++out.cast.unclosed_rays;
    note_failed(out.failed, {Check::closure, solid, {}, 1});
  }
}

}  // namespace lamella::span
