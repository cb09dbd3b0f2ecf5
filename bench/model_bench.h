#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/measure.h"

namespace lamella::bench {

struct BenchOptions {
  std::int32_t rows = 1000;
  std::int32_t layers = 1000;
  int rounds = 5;  ///< runs of each peer, the peers taking turns; the median counts
  MeasureOptions measure;
  double sample_seconds = 10.0;                  ///< CPU time of the certified engine for the exact rows
  std::vector<double> deflections{0.01, 0.001};  ///< mm
  int tessellation_cap = 300;                    ///< CPU seconds
  std::filesystem::path mesh_cache;              ///< folder of tessellations of earlier runs, or empty
  std::vector<std::string> peers;                ///< names of those to run, empty for all
};

/// Runs all peers on one STEP file, each in a process of its own, and gives everything measured. A peer or tessellation
/// that fails has "failed" with the reason instead of figures.
[[nodiscard]] nlohmann::json bench_model(const std::filesystem::path& file, const BenchOptions& options);

/// "0.001" for 0.001: the key of a tessellation.
[[nodiscard]] std::string deflection_key(double deflection);

}  // namespace lamella::bench
