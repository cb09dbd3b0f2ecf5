#pragma once

#include <vector>

#include "slicing/combine.h"

/// Rows of spans for tests of how they become segments.
namespace lamella::test {

/// A case: solids with material and priority; rank is by priority, then by `order`, larger wins.
struct Row {
  MaterialTable table;
  CombineRules rules;
  std::vector<Span> spans;

  SolidId add_solid(std::size_t material, int priority, int order) {
    while (table.materials.size() <= material) table.materials.push_back({});
    const SolidId solid = table.assignments.push_back({MaterialId{material}, priority, ""});
    rules.rank.push_back(priority * 1000 + order);
    return solid;
  }
  void add_span(SolidId solid, double begin, double end) { spans.push_back({begin, end, solid, FaceId{}, FaceId{}}); }

  CombinedRow combine() {
    rules.table = &table;
    return combine_row(spans, rules);
  }
};

/// One face that states this tolerance.
inline IdVector<FaceId, Face> faces_of_tolerance(double tolerance) {
  IdVector<FaceId, Face> faces(1);
  faces[FaceId{0}].tolerance = tolerance;
  return faces;
}

inline Segment segment(double begin, double end, std::size_t material, SolidId solid) {
  return {begin, end, MaterialId{material}, solid};
}

}  // namespace lamella::test
