#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.h"

namespace lamella {

/// One material-labelled run [x_begin, x_end) of a row, mm along the row.
struct Segment {
  double x_begin = 0.0;
  double x_end = 0.0;
  MaterialId material;
  SolidId solid;

  bool operator==(const Segment&) const = default;
};

/// Rows of segments in compressed form: row r holds segments [row_start[r], row_start[r + 1]), disjoint and ascending.
struct SegmentRows {
  std::vector<std::uint64_t> row_start{0};
  std::vector<Segment> segments;

  [[nodiscard]] std::size_t rows() const { return row_start.size() - 1; }
  [[nodiscard]] std::span<const Segment> row(std::size_t r) const {
    return {segments.data() + row_start[r], segments.data() + row_start[r + 1]};
  }
  bool operator==(const SegmentRows&) const = default;
};

/// Hatch rows first_row, first_row + 1, ...; x is the coordinate along the row from the foot of the machine origin.
struct HatchRows {
  double angle = 0.0;    ///< radians, of this layer
  double spacing = 0.0;  ///< mm
  std::int64_t first_row = 0;
  SegmentRows rows;

  bool operator==(const HatchRows&) const = default;
};

/// One layer of labelled segments: the exchange format, and the only thing exporters read.
struct Layer {
  std::uint32_t index = 0;
  double z_bottom = 0.0;
  double z_sample = 0.0;
  double z_top = 0.0;
  SegmentRows raster;  ///< one row per raster line, j ascending with y
  std::optional<HatchRows> hatch;

  bool operator==(const Layer&) const = default;
};

}  // namespace lamella
