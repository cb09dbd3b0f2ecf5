#pragma once

#include <cstdint>
#include <vector>

#include "slicing/span/section.h"

namespace lamella::span {

/// The arcs of a section (by index) in the order in which they follow one another, each list from its lowest index on.
struct ArcChains {
  std::vector<std::vector<std::uint32_t>> loops;
  std::vector<std::vector<std::uint32_t>> open;  ///< from an arc that none leads to, to one that leads nowhere
  std::uint32_t doubled = 0;                     ///< arcs left out because the same arc was there before
  std::uint32_t unusable = 0;                    ///< arcs left out because they aren't finite
};

/// Joins arcs where one ends and another begins: nodes are the same in every bit. Where several meet, each goes on
/// with the arc that bounds the same material, the leftmost one, and a loop that comes to a node twice is taken apart
/// there: so loops touch but never cross, and none touches itself in a node. Arcs without extent are left out. Depends
/// on the order of the arcs only where arcs coincide.
[[nodiscard]] ArcChains chain_arcs(const Section& section);

}  // namespace lamella::span
