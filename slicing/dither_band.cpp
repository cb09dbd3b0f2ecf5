#include "slicing/dither_band.h"

#include <algorithm>

namespace lamella {

void DitherBand::begin() {
  runs_.clear();
  fractions_.clear();
  chosen_.clear();
}

std::size_t DitherBand::add(std::size_t mixture, const VoxelIndex& first, std::span<const float> fractions,
                            std::size_t count) {
  const std::size_t chosen = chosen_.size();
  chosen_.resize(chosen + count);
  dither_row(mask_, first, fractions, std::span(chosen_).subspan(chosen));
  runs_.push_back({mixture, first, count, count == 0 ? 0 : fractions.size() / count, fractions_.size(), chosen, false});
  fractions_.insert(fractions_.end(), fractions.begin(), fractions.end());
  return runs_.size() - 1;
}

void DitherBand::settle() {
  for (std::size_t run = 0; run < runs_.size(); ++run) {
    if (!runs_[run].is_settled) settle_mixture(run);
  }
}

void DitherBand::settle_mixture(std::size_t begin) {
  std::int64_t first = DitherTile::tile_of(runs_[begin].first.i);
  std::int64_t last = first;
  const auto is_of_it = [&](const Run& run) { return run.mixture == runs_[begin].mixture && run.count > 0; };
  const auto last_tile = [](const Run& run) {
    return DitherTile::tile_of(run.first.i + static_cast<std::int64_t>(run.count) - 1);
  };
  for (std::size_t r = begin; r < runs_.size(); ++r) {
    if (!is_of_it(runs_[r])) continue;
    first = std::min(first, DitherTile::tile_of(runs_[r].first.i));
    last = std::max(last, last_tile(runs_[r]));
  }
  const auto columns = static_cast<std::size_t>(last - first + 1);
  if (columns_.size() < columns) columns_.resize(columns);
  for (std::vector<std::size_t>& runs : columns_) runs.clear();
  for (std::size_t r = begin; r < runs_.size(); ++r) {
    if (!is_of_it(runs_[r])) continue;
    runs_[r].is_settled = true;
    for (std::int64_t c = DitherTile::tile_of(runs_[r].first.i); c <= last_tile(runs_[r]); ++c) {
      columns_[static_cast<std::size_t>(c - first)].push_back(r);
    }
  }
  const VoxelIndex& any = runs_[begin].first;
  for (std::size_t c = 0; c < columns; ++c) {
    const TileIndex at{first + static_cast<std::int64_t>(c), DitherTile::tile_of(any.j), any.k};
    settle_tile(at, runs_[begin].materials, columns_[c]);
  }
}

/// Calls visit(place in the tile, place in the run, number of voxels) for the part of a run within a column of tiles.
template <typename Visit>
void DitherBand::visit_part(const Run& run, std::int64_t column, const Visit& visit) {
  const std::int64_t begin = std::max(run.first.i, column * DitherTile::kSide);
  const std::int64_t end =
      std::min(run.first.i + static_cast<std::int64_t>(run.count), (column + 1) * DitherTile::kSide);
  visit(DitherTile::place(begin, run.first.j), static_cast<std::size_t>(begin - run.first.i),
        static_cast<std::size_t>(end - begin));
}

void DitherBand::settle_tile(const TileIndex& at, std::size_t materials, std::span<const std::size_t> runs) {
  if (materials < 2) return;
  tile_.clear(materials);
  for (const std::size_t r : runs) {
    visit_part(runs_[r], at.column, [&](std::size_t place, std::size_t n, std::size_t count) {
      for (std::size_t m = 0; m < materials; ++m) {
        std::copy_n(fractions_.begin() + runs_[r].fractions + m * runs_[r].count + n, count,
                    tile_.fractions(m).begin() + place);
      }
      std::copy_n(chosen_.begin() + runs_[r].chosen + n, count, tile_.chosen().begin() + place);
    });
  }
  tile_.settle(mask_, at);
  for (const std::size_t r : runs) {
    visit_part(runs_[r], at.column, [&](std::size_t place, std::size_t n, std::size_t count) {
      std::transform(tile_.chosen().begin() + place, tile_.chosen().begin() + place + count,
                     chosen_.begin() + runs_[r].chosen + n,
                     [](std::int32_t m) { return static_cast<std::uint8_t>(m); });
    });
  }
}

}  // namespace lamella
