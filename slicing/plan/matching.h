#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace lamella {

/// A tool of its own for each of `materials`, tools being tried from the lowest; nothing when there is no such
/// matching. `holders` has the tools of every material as bits.
[[nodiscard]] std::optional<std::vector<std::uint32_t>> match_tools(const std::vector<std::uint32_t>& materials,
                                                                    const std::vector<std::uint32_t>& holders);

/// Why there is no such matching: materials that have fewer tools between them than they are, as few as need be named.
struct Crowd {
  std::vector<std::uint32_t> materials;
  std::uint32_t tools = 0;  ///< bits: all that can hold any of them
};
/// Nothing when there is a matching.
[[nodiscard]] std::optional<Crowd> find_crowd(const std::vector<std::uint32_t>& materials,
                                              const std::vector<std::uint32_t>& holders);

/// The matching of rows to columns of least cost (Hungarian method); cost[row][column], at most as many rows as
/// columns.
[[nodiscard]] std::vector<std::uint32_t> match_cheapest(const std::vector<std::vector<double>>& cost);

}  // namespace lamella
