#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "core/ids.h"
#include "core/tolerances.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "slicing/hit.h"
#include "slicing/layer.h"

namespace lamella {

/// The total order of command.md in which solids win where they overlap: priority, then smaller exact volume (to seven
/// digits, so that integration noise does not decide), then the bytewise smaller path, then bounds. rank[s] is larger
/// for the winner; ranks are 0, 1, 2, ...
[[nodiscard]] IdVector<SolidId, int> rank_solids(const Scene& scene, const MaterialTable& table,
                                                 const IdVector<SolidId, SolidMeasure>& measures);

/// Length along one row that two solids share, or of a gap between them.
struct PairLength {
  SolidId first;  ///< the lower id
  SolidId second;
  double length = 0.0;  ///< mm, positive

  bool operator==(const PairLength&) const = default;
};

/// How one row's spans become segments (docs/methods/layers.md).
struct CombineRules {
  const MaterialTable* table = nullptr;       ///< not owned; material, priority and overlap policy
  IdVector<SolidId, int> rank;                ///< of rank_solids()
  double gap_tolerance = tolerance::kMinGap;  ///< mm along the row; gaps up to it go to the higher rank

  /// Widens the gap tolerance at the faces of the scene to what they state.
  void widen_at(const IdVector<FaceId, Face>& faces);

  /// mm: within what a face that is left or entered by touches another.
  [[nodiscard]] double tolerance_at(FaceId face) const {
    // An id that refers to nothing is larger than any size.
    if (face.value() >= face_tolerance_.size()) return gap_tolerance;
    return std::max(gap_tolerance, face_tolerance_[face]);
  }
  /// mm: no face has a larger one.
  [[nodiscard]] double widest_tolerance() const { return std::max(gap_tolerance, widest_); }

 private:
  IdVector<FaceId, double> face_tolerance_;  ///< mm, may be empty
  double widest_ = 0.0;
};

/// Combines one row after the other in memory that is used again: 3 to 20 ns a span where spans are disjoint, touch or
/// are nested, nothing allocated once the memory has grown.
class RowCombiner {
 public:
  /// Appends the segments of one row to `segments`: see combine_row(). Rows sorted as SpanRows are cost least.
  void combine(std::span<const Span> spans, const CombineRules& rules, std::vector<Segment>& segments);

  /// Of the last row: common lengths of pairs of different material, along the row; a pair may come more than once.
  [[nodiscard]] std::span<const PairLength> overlaps() const { return overlaps_; }
  /// Of the last row: filled gaps, likewise.
  [[nodiscard]] std::span<const PairLength> gaps() const { return gaps_; }

 private:
  class Staircase;
  struct Step {
    const Span* span = nullptr;
    double end = 0.0;
    int rank = 0;
  };
  struct Open {
    double end = 0.0;
    double tolerance_out = 0.0;  ///< mm, of the face that it is left by
    SolidId solid;
    MaterialId material;
  };

  std::span<const Span> sort_usable(std::span<const Span> spans, const CombineRules& rules);
  void measure_overlaps(std::span<const Span> spans, const CombineRules& rules);
  std::span<const Span> clip(std::span<const Span> spans, const CombineRules& rules);

  std::vector<Span> sorted_;
  std::vector<Span> clipped_;
  std::vector<Step> steps_;
  std::vector<Open> open_;
  std::vector<PairLength> overlaps_;
  std::vector<PairLength> gaps_;
};

/// One row and what was measured on it.
struct CombinedRow {
  std::vector<Segment> segments;  ///< disjoint, ascending, neighbours of equal material and solid merged
  std::vector<PairLength>
      overlaps;  ///< pairs of different material, ids ascending; one within the gap tolerance only touches
  std::vector<PairLength> gaps;  ///< filled gaps between different solids, ids ascending
};

/// Combines all solids' spans of one row (any order; each solid's own disjoint) into labelled half-open segments.
///
/// Each segment carries the solid of highest rank there. The result does not depend on the order of `spans`, and
/// permuting solid ids permutes the ids in it and changes nothing else. Spans that are empty, reversed or not finite
/// are ignored. Work linear in the spans times how many solids lie over one another, and a sort if they come unsorted.
[[nodiscard]] CombinedRow combine_row(std::span<const Span> spans, const CombineRules& rules);

}  // namespace lamella
