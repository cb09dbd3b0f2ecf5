#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "slicing/reference/reference_engine.h"

namespace lamella::test {

/// How an interval of a ray that one of the two calls inside and the other doesn't was decided, by OpenCASCADE's point
/// classifier at its middle, which sends rays of its own in other directions.
enum class Verdict { engine, occt, boundary };

/// What was wrong with OpenCASCADE's list of intersections where the two differ.
enum class Kind {
  odd_hits,     ///< it has an odd number of intersections: one is missing or doubled
  fewer_spans,  ///< it closes, with fewer spans than the engine's
  more_spans,   ///< it closes, with more
  other_depth   ///< as many spans, other ends
};
inline constexpr int kKinds = 4;
[[nodiscard]] const char* kind_name(Kind kind);

/// One ray on which the two differ.
struct Dispute {
  SolidId solid;
  Ray ray;
  Kind kind = Kind::other_depth;
  Verdict verdict = Verdict::boundary;  ///< of its longest disputed interval
  double length = 0.0;                  ///< mm, of that interval
  std::vector<Span> engine;
  std::vector<double> occt;  ///< depths of its intersections, copies dropped
};

struct OcctComparison {
  std::uint64_t rays = 0;    ///< solid-rays: the ray meets the solid's box
  std::uint64_t met = 0;     ///< of these, solid-rays on which either found a span
  std::uint64_t agreed = 0;  ///< of `rays`, those whose spans are the same within the tolerance
  std::vector<Dispute> disputes;
  CastCounters counters;
  double engine_seconds = 0.0;
  double occt_seconds = 0.0;
  double tolerance = 0.0;  ///< mm, of the comparison

  [[nodiscard]] std::uint64_t count(Kind kind, Verdict verdict) const;
};

/// Casts random lines through the boxes of the solids of a STEP file by the certified engine and by OpenCASCADE's
/// IntCurvesFace_ShapeIntersector. Ends of spans may differ by `tolerance` mm, or, if larger, by twice the file's
/// largest edge tolerance, over |n.d|. Stops a solid after `seconds_per_solid`. Solids without a counterpart of the
/// same box in OpenCASCADE's reading are left out.
[[nodiscard]] OcctComparison compare_with_occt(const std::filesystem::path& file, int rays_per_solid,
                                               std::uint32_t seed, double tolerance = 1e-6,
                                               double seconds_per_solid = 1e300);

}  // namespace lamella::test
