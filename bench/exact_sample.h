#pragma once

#include "bench/exact_peers.h"
#include "bench/measure.h"

namespace lamella::bench {

/// Rows at random on some layers at random, cast by the certified reference engine for about `seconds` of CPU time.
[[nodiscard]] std::vector<ExactRow> sample_rows(const ExactModel& model, const Lattice& lattice, double seconds,
                                                std::uint32_t seed);

/// The sample as bytes, and back.
[[nodiscard]] std::string to_bytes(const std::vector<ExactRow>& rows);
[[nodiscard]] std::vector<ExactRow> rows_from_bytes(const std::string& bytes);

}  // namespace lamella::bench
