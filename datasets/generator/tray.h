#pragma once

#include <array>
#include <string>

#include "datasets/generator/assembly.h"

/// A tray of copies of one assembly, as a printer's build volume is filled.
namespace lamella::datasets {

struct TrayOptions {
  std::array<double, 3> size{};  ///< mm, of the build volume
  double gap = 2.0;              ///< mm, the least distance between the boxes of neighbouring copies
};

struct Tray {
  DataSet set;                        ///< one instance of the same assembly for every copy, in the box from 0 to `size`
  std::array<int, 3> copies{};        ///< along x, y and z
  std::array<double, 3> distance{};   ///< mm between the boxes of neighbours along x, y and z; 0 where there are none
  std::array<double, 3> part_size{};  ///< mm, of the box of a copy as it lies in the tray

  [[nodiscard]] int count() const { return copies[0] * copies[1] * copies[2]; }
};

/// Places as many copies of `unit` as the volume holds, row beside row, all turned alike: of the six ways to lay its
/// box along the axes, the first that takes most. What is left over widens the gaps, so that along every axis with more
/// than one copy the tray is as long as the volume. Throws std::invalid_argument when not one copy fits, or for sizes
/// that aren't positive or a gap that is negative.
[[nodiscard]] Tray make_tray(const DataSet& unit, const TrayOptions& options);

}  // namespace lamella::datasets
