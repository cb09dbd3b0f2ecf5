#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "model/scene.h"

namespace lamella::test {

/// How much of a scene to compare.
struct OracleOptions {
  std::size_t solids = 4;       ///< drawn at random
  std::size_t slabs = 2;        ///< a solid: runs of kSlabLayers layers, drawn at random
  std::size_t layers = 4;       ///< a slab: layers of which rows are compared, each at a random hatch angle
  std::size_t rows = 4;         ///< a layer
  double layers_a_solid = 300;  ///< sets the layers' distance: the solid's height over this
  std::uint64_t seed = 1;
};

/// What comparing the span engine with the certified oracle came to. A solid-ray is a row that one of the two found to
/// meet a solid.
struct OracleTally {
  std::size_t solid_rays = 0;
  std::size_t agree = 0;    ///< the same number of spans, and every end within the bound
  std::size_t in_zone = 0;  ///< differ, within a tolerance zone that the oracle reports
  std::size_t grazing = 0;  ///< differ, but no more than rays do that lie within the bound of each other
  std::size_t differ = 0;
  double worst = 0.0;  ///< mm, of the rays that agree: largest error in x times |n . d|
  std::uint64_t unclosed = 0;
  std::uint64_t doubtful = 0;         ///< hits that the span engine flagged
  std::vector<std::string> examples;  ///< of rays that differ

  OracleTally& operator+=(const OracleTally& other);
};

/// mm: bound on the error in x times |n . d|.
inline constexpr double kOracleBound = 1e-6;

/// Compares random rows of random solids of a scene.
[[nodiscard]] OracleTally compare_with_oracle(const Scene& scene, const OracleOptions& options);

}  // namespace lamella::test
