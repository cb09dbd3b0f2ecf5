#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "slicing/layer_plan.h"
#include "slicing/slab.h"

/// Crossings of one solid with a lattice of rays along +x, exact or of a mesh.
namespace lamella::accuracy {

/// Rays along +x, one a row of each layer: ray number = layer * rows + row.
struct RayLattice {
  std::vector<double> y;  ///< mm, ascending, of the rows
  std::vector<double> z;  ///< mm, ascending, of the layers

  [[nodiscard]] std::size_t rays() const { return y.size() * z.size(); }
  [[nodiscard]] double ray_y(std::uint32_t ray) const { return y[ray % y.size()]; }
  [[nodiscard]] double ray_z(std::uint32_t ray) const { return z[ray / y.size()]; }
};

/// The rows of a plan's raster lattice; they are the same numbers as the slicer's.
[[nodiscard]] RayLattice lattice_of(const LayerPlan& plan);

struct Crossing {
  std::uint32_t ray = 0;
  double x = 0.0;  ///< mm

  bool operator==(const Crossing&) const = default;
};

/// Ascending by ray, then x; an even number on each ray, entries and exits in turn.
using Crossings = std::vector<Crossing>;

/// Where two lists differ. Lengths in mm, along the rays.
struct CrossingErrors {
  std::uint64_t matched = 0;
  double sum = 0.0;          ///< of the absolute errors of matched crossings
  double squares = 0.0;      ///< of their squares
  double largest = 0.0;      ///< of them
  std::uint64_t missed = 0;  ///< exact crossings without a partner
  std::uint64_t false_ = 0;  ///< found crossings without a partner
  double longest_missed = 0.0;
  double longest_false = 0.0;
  double differing = 0.0;  ///< total length that is inside in one list and outside in the other

  [[nodiscard]] double mean() const { return matched > 0 ? sum / static_cast<double>(matched) : 0.0; }
  [[nodiscard]] double rms() const;
  CrossingErrors& operator+=(const CrossingErrors& other);
};

/// Matches the found crossings of every ray with the exact ones.
///
/// All crossings of both lists are put in one order along the ray and paired one after the other. Before each pair both
/// lists are inside or both outside, so the pair bounds a length where they differ, and pairs are of one of two kinds:
/// an exact and a found crossing of the same sense, which are matched; or two neighbours of one list with nothing of
/// the other between them, a span or a gap that the other list doesn't have: two missed, or two false crossings. Of all
/// ways to pair equal senses in their order, leaving neighbours out by twos, this has the least total length: any such
/// way has at least that of the part of the ray that is inside in one list only, and this one has just that. No
/// tolerance is involved.
[[nodiscard]] CrossingErrors compare_crossings(const Crossings& exact, const Crossings& found);

}  // namespace lamella::accuracy
