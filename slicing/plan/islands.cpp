#include "slicing/plan/islands.h"

#include <algorithm>
#include <numeric>

namespace lamella {

namespace {

/// Touching segments of one material on a row.
struct Run {
  double begin = 0.0;
  double end = 0.0;
  MaterialId material;
};

/// A piece of one material, as far as it has been seen.
struct Piece {
  MaterialId material;
  double area = 0.0;
  double x_min = 0.0;
  double x_max = 0.0;
  std::size_t first_row = 0;
  std::size_t last_row = 0;
};

/// Pieces joined by union-find: the root of each tree holds what is known of the whole.
class Pieces {
 public:
  std::size_t add(const Run& run, std::size_t row, double pitch) {
    parent_.push_back(parent_.size());
    pieces_.push_back({run.material, (run.end - run.begin) * pitch, run.begin, run.end, row, row});
    return parent_.size() - 1;
  }
  void join(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    if (a == b) return;
    if (b < a) std::swap(a, b);
    parent_[b] = a;
    Piece& into = pieces_[a];
    const Piece& from = pieces_[b];
    into.area += from.area;
    into.x_min = std::min(into.x_min, from.x_min);
    into.x_max = std::max(into.x_max, from.x_max);
    into.first_row = std::min(into.first_row, from.first_row);
    into.last_row = std::max(into.last_row, from.last_row);
  }
  template <class Visit>
  void each(const Visit& visit) const {
    for (std::size_t i = 0; i < parent_.size(); ++i) {
      if (parent_[i] == i) visit(pieces_[i]);
    }
  }

 private:
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  std::vector<std::size_t> parent_;
  std::vector<Piece> pieces_;
};

void find_runs(std::span<const Segment> row, std::vector<Run>& runs) {
  runs.clear();
  for (const Segment& segment : row) {
    const bool goes_on =
        !runs.empty() && runs.back().end == segment.x_begin && runs.back().material == segment.material;
    if (goes_on) {
      runs.back().end = segment.x_end;
    } else {
      runs.push_back({segment.x_begin, segment.x_end, segment.material});
    }
  }
}

void count_run(const Run& run, double pitch, double width, MaterialStatistics& into) {
  const double length = run.end - run.begin;
  into.shortest = into.shortest > 0.0 ? std::min(into.shortest, length) : length;
  if (length < width) into.thin += length * pitch;
}

}  // namespace

void measure_islands(const SegmentRows& raster, double pitch, double width,
                     std::vector<MaterialStatistics>& by_material) {
  Pieces pieces;
  std::vector<Run> above;
  std::vector<Run> runs;
  std::size_t above_first = 0;
  for (std::size_t j = 0; j < raster.rows(); ++j) {
    find_runs(raster.row(j), runs);
    std::size_t first = 0;
    std::size_t start = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const std::size_t piece = pieces.add(runs[i], j, pitch);
      if (i == 0) first = piece;
      count_run(runs[i], pitch, width, by_material[runs[i].material.value()]);
      while (start < above.size() && above[start].end <= runs[i].begin) ++start;
      for (std::size_t a = start; a < above.size() && above[a].begin < runs[i].end; ++a) {
        if (above[a].material == runs[i].material) pieces.join(above_first + a, piece);
      }
    }
    above_first = first;
    above.swap(runs);
  }
  pieces.each([&](const Piece& piece) {
    MaterialStatistics& into = by_material[piece.material.value()];
    ++into.islands;
    into.smallest = into.islands == 1 ? piece.area : std::min(into.smallest, piece.area);
    const double height = static_cast<double>(piece.last_row - piece.first_row + 1) * pitch;
    if (std::min(piece.x_max - piece.x_min, height) < width) ++into.specks;
  });
}

}  // namespace lamella
