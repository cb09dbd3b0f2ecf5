#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "model/scene.h"
#include "model/trim.h"
#include "slicing/span/monotone_pieces.h"
#include "slicing/span/section_surface.h"

namespace lamella::span {

/// A z-monotone piece of a shared edge: where it crosses a layer, the section has a node that both faces read.
struct EdgePiece {
  EdgeId edge;
  std::uint32_t curve = 0;  ///< for EdgePieces::curve_of
  MonotonePiece range;
};

/// All pieces of the edges that a solid uses.
class EdgePieces {
 public:
  EdgePieces(const Scene& scene, SolidId solid);

  [[nodiscard]] const std::vector<EdgePiece>& all() const { return pieces_; }
  [[nodiscard]] const SectionCurve<3>& curve_of(const EdgePiece& piece) const { return curves_[piece.curve]; }
  /// Index range [first, last) of one edge's pieces; empty for degenerate edges.
  [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> of(EdgeId edge) const;

 private:
  std::vector<EdgePiece> pieces_;
  std::vector<SectionCurve<3>> curves_;
  std::map<EdgeId, std::pair<std::uint32_t, std::uint32_t>> ranges_;
};

/// One face's use of an edge piece. Uses that rise in the sense of their loop end an arc of the section, those that
/// fall begin one: the loop has the face on its left, and the section runs along z x n.
struct PieceUse {
  std::uint32_t piece = 0;  ///< in EdgePieces
  HalfEdgeId half_edge;
  std::uint32_t pcurve = 0;    ///< in FaceModel::pcurves
  Vec2 offset = Vec2::Zero();  ///< whole periods that bring the pcurve into the face's chart
  bool ends_arc = false;
  std::uint32_t loop = 0;
};

/// A line v = const from a point that sections may run round to the end of the face: with one from every extremum of
/// height and every hole, each loop of a section that touches no edge crosses a cut.
struct CutLine {
  SectionCurve<3> curve;  ///< parametrised by u
  double v = 0.0;
  std::vector<MonotonePiece> pieces;
};

/// Where sections of a face change from one pair of neighbours to another: its saddles, and places without curvature.
struct Pass {
  Vec2 xy = Vec2::Zero();
  double z = 0.0;
};

/// How a face is cut: by straight lines, by ellipses, or by tracing.
enum class SectionKind { plane, round, traced };

/// Everything about one face that doesn't depend on the layer.
struct FaceModel {
  FaceModel(const Scene& scene, FaceId face, const EdgePieces& edges);

  FaceId id;
  SectionKind kind;
  SectionSurface surface;
  double sign = 1.0;  ///< +1: the outward normal is S_u x S_v
  double tolerance = 0.0;
  double size = 0.0;           ///< mm, diagonal of its vertices and pieces, a scale for steps
  std::vector<PieceUse> uses;  ///< loop by loop in their order
  std::vector<SectionCurve<2>> pcurves;
  std::vector<double> events;  ///< ascending heights between which the topology of the section doesn't change
  std::vector<CutLine> cuts;
  std::vector<Pass> passes;
  std::optional<TrimRegion> region;  ///< only where a section may touch no edge
  bool complete = true;              ///< false when the search for critical heights hit its limit

  /// Index of the half-open band [events[i], events[i + 1]) that holds z, nothing if the face isn't there.
  [[nodiscard]] std::optional<std::size_t> band_of(double z) const;
};

}  // namespace lamella::span
