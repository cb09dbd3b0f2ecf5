#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "slicing/dither.h"
#include "slicing/dither_tile.h"

namespace lamella {

/// Dithers rows of a layer together: by dither_row(), then with the number of voxels of each material set right in
/// every tile (docs/methods/dithering.md, "Tiles").
///
/// A band holds the rows of one row of tiles: those of equal j / 16, rounded down. So what comes out depends on the
/// layer alone. Memory is used again from band to band, by one thread.
class DitherBand {
 public:
  static constexpr std::int64_t kRows = DitherTile::kSide;

  /// The mask must outlive it.
  explicit DitherBand(const DitherMask& mask) : mask_(mask) {}

  /// Forgets all runs.
  void begin();
  /// Adds `count` voxels from `first` on along x and returns the run's number: 0, 1 ... Fractions are as dither_row()
  /// takes them, and refused likewise. Voxels of the same `mixture` are counted together; its runs must all have as
  /// many materials, and all runs of a band are of one layer.
  std::size_t add(std::size_t mixture, const VoxelIndex& first, std::span<const float> fractions, std::size_t count);
  /// Sets the numbers of voxels right. To be called once, when all runs are there.
  void settle();
  /// The materials of a run's voxels. Valid until the next run is added.
  [[nodiscard]] std::span<const std::uint8_t> chosen(std::size_t run) const {
    return std::span(chosen_).subspan(runs_[run].chosen, runs_[run].count);
  }

 private:
  struct Run {
    std::size_t mixture;
    VoxelIndex first;
    std::size_t count;
    std::size_t materials;
    std::size_t fractions;  ///< where they begin in fractions_
    std::size_t chosen;     ///< where they begin in chosen_
    bool is_settled;
  };

  void settle_mixture(std::size_t begin);
  void settle_tile(const TileIndex& at, std::size_t materials, std::span<const std::size_t> runs);
  template <typename Visit>
  static void visit_part(const Run& run, std::int64_t column, const Visit& visit);

  const DitherMask& mask_;
  DitherTile tile_;
  std::vector<Run> runs_;
  std::vector<float> fractions_;
  std::vector<std::uint8_t> chosen_;
  std::vector<std::vector<std::size_t>> columns_;  ///< of one mixture: the runs that reach into each column of tiles
};

}  // namespace lamella
