#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace lamella::bench {

/// The results of span_bench as two markdown tables: how many times faster the span engine is than its peers, and what
/// each peer did.
[[nodiscard]] std::string markdown_tables(const nlohmann::json& results);

/// Seconds that a peer takes for all rows of the lattice, preparing included, or nothing when it failed. With
/// `with_tessellation` also the time of making its triangles.
[[nodiscard]] double whole_seconds(const nlohmann::json& model, const nlohmann::json& peer, bool with_tessellation);

}  // namespace lamella::bench
