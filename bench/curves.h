#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

namespace lamella::bench {

struct CurveOptions {
  std::int32_t rows = 1000;    ///< where they don't vary
  std::int32_t layers = 1000;  ///< where they don't vary
  int repeats = 3;             ///< the fastest counts
  double budget = 60.0;        ///< CPU seconds a point; a curve ends where one takes longer
};

/// What the span engine costs on one model against layers, rows and threads: {"file", "faces", "prepare_s", "layers":
/// [{"layers", "cpu_s", "wall_s", "hits", "peak_mib"}, ...], "rows": [...], "threads": [...]}; peak_mib is the process'
/// own so far.
[[nodiscard]] nlohmann::json measure_curves(const std::filesystem::path& file, const CurveOptions& options);

}  // namespace lamella::bench
