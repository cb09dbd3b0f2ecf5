#include "slicing/plan/matching.h"

#include <array>
#include <limits>

namespace lamella {

namespace {

constexpr std::size_t kTools = 32;
constexpr std::uint32_t kNobody = UINT32_MAX;

/// Kuhn's augmenting path for `row`: takes the first free tool, or one whose owner finds another.
bool augment(std::uint32_t row, const std::vector<std::uint32_t>& options, std::uint32_t& tried,
             std::array<std::uint32_t, kTools>& owner) {
  for (std::uint32_t tool = 0; tool < kTools; ++tool) {
    if ((options[row] >> tool & 1U) == 0 || owner[tool] != kNobody) continue;
    owner[tool] = row;
    return true;
  }
  for (std::uint32_t tool = 0; tool < kTools; ++tool) {
    const std::uint32_t bit = 1U << tool;
    if ((options[row] & bit) == 0 || (tried & bit) != 0) continue;
    tried |= bit;
    if (augment(owner[tool], options, tried, owner)) {
      owner[tool] = row;
      return true;
    }
  }
  return false;
}

}  // namespace

std::optional<std::vector<std::uint32_t>> match_tools(const std::vector<std::uint32_t>& materials,
                                                      const std::vector<std::uint32_t>& holders) {
  std::vector<std::uint32_t> options;
  for (const std::uint32_t material : materials) options.push_back(holders[material]);
  if (options.size() > kTools) return std::nullopt;
  std::array<std::uint32_t, kTools> owner;
  owner.fill(kNobody);
  for (std::uint32_t row = 0; row < options.size(); ++row) {
    std::uint32_t tried = 0;
    if (!augment(row, options, tried, owner)) return std::nullopt;
  }
  std::vector<std::uint32_t> tool_of(options.size());
  for (std::uint32_t tool = 0; tool < kTools; ++tool) {
    if (owner[tool] != kNobody) tool_of[owner[tool]] = tool;
  }
  return tool_of;
}

// By Hall's theorem the rows that are tried in vain have one tool less than they are.
std::optional<Crowd> find_crowd(const std::vector<std::uint32_t>& materials,
                                const std::vector<std::uint32_t>& holders) {
  std::vector<std::uint32_t> options;
  for (const std::uint32_t material : materials) options.push_back(holders[material]);
  std::array<std::uint32_t, kTools> owner;
  owner.fill(kNobody);
  for (std::uint32_t row = 0; row < options.size(); ++row) {
    std::uint32_t tried = 0;
    if (augment(row, options, tried, owner)) continue;
    Crowd crowd{{materials[row]}, tried};
    for (std::uint32_t tool = 0; tool < kTools; ++tool) {
      if ((tried >> tool & 1U) != 0) crowd.materials.push_back(materials[owner[tool]]);
    }
    return crowd;
  }
  return std::nullopt;
}

// Shortest augmenting paths with potentials (Kuhn 1955, Munkres 1957), row 0 and column 0 being sentinels.
std::vector<std::uint32_t> match_cheapest(const std::vector<std::vector<double>>& cost) {
  const std::size_t rows = cost.size();
  const std::size_t columns = rows == 0 ? 0 : cost.front().size();
  std::vector<double> row_potential(rows + 1);
  std::vector<double> column_potential(columns + 1);
  std::vector<std::size_t> owner(columns + 1);
  for (std::size_t row = 1; row <= rows; ++row) {
    std::vector<double> slack(columns + 1, std::numeric_limits<double>::infinity());
    std::vector<std::size_t> before(columns + 1);
    std::vector<bool> done(columns + 1);
    owner[0] = row;
    std::size_t at = 0;
    do {
      done[at] = true;
      std::size_t next = 0;
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t c = 1; c <= columns; ++c) {
        if (done[c]) continue;
        const double reduced = cost[owner[at] - 1][c - 1] - row_potential[owner[at]] - column_potential[c];
        if (reduced < slack[c]) {
          slack[c] = reduced;
          before[c] = at;
        }
        if (slack[c] < least) {
          least = slack[c];
          next = c;
        }
      }
      for (std::size_t c = 0; c <= columns; ++c) {
        if (done[c]) {
          row_potential[owner[c]] += least;
          column_potential[c] -= least;
        } else {
          slack[c] -= least;
        }
      }
      at = next;
    } while (owner[at] != 0);
    for (; at != 0; at = before[at]) owner[at] = owner[before[at]];
  }
  std::vector<std::uint32_t> column_of(rows);
  for (std::size_t c = 1; c <= columns; ++c) {
    if (owner[c] != 0) column_of[owner[c] - 1] = static_cast<std::uint32_t>(c - 1);
  }
  return column_of;
}

}  // namespace lamella
