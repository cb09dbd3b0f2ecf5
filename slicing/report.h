#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/ids.h"
#include "slicing/hit.h"

namespace lamella {

/// Volume that two solids share (overlap), or that lies between them within the gap tolerance (gap).
struct PairReport {
  SolidId first;
  SolidId second;
  double volume = 0.0;         ///< mm^3, by the raster lattice
  std::uint64_t layers = 0;    ///< number of layers it was met in
  double largest_depth = 0.0;  ///< mm: how far inside both solids an overlap goes, how wide a gap is
};

/// Where two solids lie along one another, by their exact faces (docs/methods/interfaces.md).
struct ContactReport {
  SolidId first;
  SolidId second;
  double area = 0.0;         ///< mm^2
  double volume = 0.0;       ///< mm^3 between them, of a gap that stays open
  double least_gap = 0.0;    ///< mm, along the normal
  double largest_gap = 0.0;  ///< mm
  std::uint64_t layers = 0;  ///< number of layers it reaches through
};

struct SolidReport {
  double volume_sliced = 0.0;     ///< mm^3, of the solid alone, before priorities
  double volume_exact = 0.0;      ///< mm^3
  double quadrature_bound = 0.0;  ///< py A_y + pz A_z, mm^3 (command.md, exit code 3)
  bool left_out = false;          ///< open or empty, not sliced
  std::string status = "ok";      ///< "ok", "open", "invalid", "empty", "volume"
};

struct MaterialReport {
  double volume = 0.0;  ///< mm^3, after priorities
  double mass = 0.0;    ///< g, 0 when the density is unknown
};

/// How far the answer may be trusted.
struct SliceReport {
  std::uint64_t layers = 0;
  std::uint64_t rows = 0;  ///< raster rows, all layers
  std::uint64_t rays = 0;  ///< raster rays = rows
  std::uint64_t segments = 0;
  CastCounters cast;
  IdVector<SolidId, SolidReport> solids;
  IdVector<MaterialId, MaterialReport> materials;
  std::vector<PairReport> overlaps;
  std::vector<PairReport> gaps;
  std::vector<ContactReport> interfaces;  ///< within the gap tolerance: one shared surface
  std::vector<ContactReport> open_gaps;   ///< wider, but less than the raster pitch: they stay open
  std::vector<Finding> findings;          ///< warnings that belong to the result

  /// Whether the error budget of command.md (exit code 3) is kept.
  [[nodiscard]] bool within_budget() const;
};

}  // namespace lamella
