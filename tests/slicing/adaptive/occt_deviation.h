#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace lamella::test {

/// The largest distances that samples find between solids and what layers make of them, by OpenCASCADE alone: nothing
/// of it is shared with the planner.
struct MeasuredDeviation {
  double built = 0.0;  ///< mm: from the surface of the extruded sections to that of the solid
  /// mm: from the surface of the solid to that of the extruded sections. It is that of a place where rays, the
  /// classifier and the curves of sections agree that it is no less; only curves that OpenCASCADE misses make it
  /// larger.
  double surface = 0.0;
  Vec3 built_at = Vec3::Zero();
  Vec3 surface_at = Vec3::Zero();
  std::uint64_t built_samples = 0;
  std::uint64_t surface_samples = 0;
};

struct MeasureOptions {
  std::uint64_t samples = 1000;  ///< of each kind and solid
  double seconds = 30.0;         ///< for each solid and kind, after which sampling stops
  std::uint32_t seed = 1;
};

/// Layers lie between neighbouring `borders` (mm, ascending) and are sampled in their middle. Solids of the file are
/// measured each by itself. Throws std::runtime_error when the file can't be read.
[[nodiscard]] MeasuredDeviation measure_deviation(const std::filesystem::path& step_file,
                                                  const std::vector<double>& borders, const MeasureOptions& options);

/// *surface* of one place of one of the solids' surfaces, mm. Solids count from 0 in OpenCASCADE's order.
[[nodiscard]] double surface_deviation_at(const std::filesystem::path& step_file, std::size_t solid,
                                          const std::vector<double>& borders, const Vec3& place);

}  // namespace lamella::test
