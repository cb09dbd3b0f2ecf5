#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

#include "bench/peer.h"

namespace lamella::bench {

/// The exact crossings of some rows, all solids together, to hold against those of a peer.
struct ExactRow {
  std::int32_t layer = 0;
  std::int32_t row = 0;
  std::vector<double> x;  ///< ascending, mm
};

struct MeasureOptions {
  double least_seconds = 1.0;  ///< CPU time that a run shall take at least; fast peers repeat the work
  double most_seconds = 20.0;  ///< and at most; slow peers get a part of the work
  std::uint32_t seed = 1;      ///< of the rows that slow peers get
};

/// Serves one peer in a process of its own: prepares it, decides its share of the work, times runs and checks hits.
class Measurement {
 public:
  Measurement(const PeerEntry& entry, const Lattice& lattice, const std::vector<ExactRow>& exact,
              const MeasureOptions& options);

  /// Prepares: {"prepare_s", "share" of the rows, "passes" of them in a run}.
  [[nodiscard]] nlohmann::json prepare();

  /// Casts the peer's share of the rows, as often as said: CPU seconds of one pass.
  [[nodiscard]] double run();

  /// {"hits", "solid_rows", "odd_rows" (or reported as unclosed), "repaired_rows", "uncertain_hits", "peak_mib",
  /// "error": {"rows", "count_mismatches", "mean", "max", "examples"}}.
  [[nodiscard]] nlohmann::json check();

 private:
  void prepare_peer();
  void plan_slabs();
  void plan_rows();
  [[nodiscard]] nlohmann::json compare();

  const PeerEntry& entry_;
  Lattice lattice_;
  const std::vector<ExactRow>& exact_;
  MeasureOptions options_;
  double base_mebibytes_ = 0.0;
  std::unique_ptr<Peer> peer_;
  std::vector<double> prepare_seconds_;
  std::vector<Batch> batches_;
  std::int64_t passes_ = 1;
  double share_ = 1.0;
};

}  // namespace lamella::bench
