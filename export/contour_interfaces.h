#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/geometry.h"
#include "core/ids.h"
#include "materials/material_table.h"

namespace lamella {

/// One solid's section as the overlap policies see it.
struct InterfacePart {
  int priority = 0;
  MaterialId material;
  int rank = 0;
  std::vector<std::vector<Vec2>> polygons;  ///< mm; inside by parity
};

/// Corners of a trapezoid with level sides, counterclockwise.
using Trapezoid = std::array<Vec2, 4>;

/// What parts of one priority and material may keep of what they cover.
struct KeptArea {
  int priority = 0;
  MaterialId material;
  std::vector<Trapezoid> area;  ///< they share sides but no area
};

/// Shares out overlaps among parts of equal priority and different material by the policies entry, exit and average, as
/// apply_interface_policy() does on a row: on every level line at once, for between two heights at which edges begin,
/// end or cross all lines have the same runs, and all ends move in straight lines. Entries ascend by priority, then
/// material; what covers nothing has none.
[[nodiscard]] std::vector<KeptArea> share_overlaps(std::span<const InterfacePart> parts, OverlapPolicy policy);

}  // namespace lamella
