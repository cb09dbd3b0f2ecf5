#pragma once

#include <cstdint>
#include <vector>

#include "core/ids.h"
#include "slicing/span/arc_piece.h"
#include "slicing/span/round_section.h"

namespace lamella::span {

/// One arc of a solid's section on one layer. `begin` and `end` are stored nodes, the same bits in both faces at an
/// edge: they decide which rows the arc crosses; the pieces say where.
struct SectionArc {
  FaceId face;
  Vec2 begin = Vec2::Zero();
  Vec2 end = Vec2::Zero();
  std::uint32_t first_piece = 0;
  std::uint32_t piece_count = 0;
  bool straight = false;      ///< one piece of degree 1
  bool doubtful = false;      ///< could not be traced: a chord stands in
  std::int32_t ellipse = -1;  ///< index in Section::ellipses of an arc without pieces
  std::int32_t round = -1;    ///< index in Section::ellipses of what the pieces stand for, if they stand for one
  /// The face's outward normal in the nodes, its horizontal part, found without the arc: z x n runs along it. Zero
  /// where there is none to compare with.
  Vec2 begin_normal = Vec2::Zero();
  Vec2 end_normal = Vec2::Zero();
};

/// All arcs of one solid on one layer, in the order of its faces.
struct Section {
  std::vector<SectionArc> arcs;
  std::vector<ArcPiece> pieces;
  std::vector<EllipseArc> ellipses;
  std::vector<FaceId> lost_loops;  ///< faces of loops known from a cut that could not be traced

  void clear() {
    arcs.clear();
    ellipses.clear();
    lost_loops.clear();
    pieces.clear();
  }
};

}  // namespace lamella::span
