#pragma once

#include <cstdint>
#include <vector>

#include "core/geometry.h"
#include "core/ids.h"

namespace lamella {

/// Entry when N.d < 0, exit when N.d > 0, edge when the ray touches without a decided crossing (paper, step 5).
enum class Sense : std::uint8_t { entry, exit, edge };

/// Doubt about one hit; zero means none.
enum HitFlag : std::uint8_t {
  kNearEdge = 1,   ///< within an edge's own tolerance of that edge
  kTangent = 2,    ///< the solver left a box undecided (tangency)
  kDisplaced = 4,  ///< found on a ray moved aside to break a tie (docs/methods/reference-engine.md)
  kUncertain = 8   ///< existence not decided within the file's own tolerances
};

/// One crossing of a ray with a face.
struct Hit {
  double t = 0.0;  ///< mm along the ray
  SolidId solid;
  FaceId face;
  Sense sense = Sense::entry;
  std::uint8_t flags = 0;
  Vec2 uv = Vec2::Zero();  ///< in the STEP file's parametrisation, radians and mm
};

/// One run of a ray inside one solid, [begin, end) along the ray, mm.
struct Span {
  double begin = 0.0;
  double end = 0.0;
  SolidId solid;
  FaceId face_in;
  FaceId face_out;
};

/// What casting rays met; merges by addition.
struct CastCounters {
  std::uint64_t rays = 0;      ///< solid-rays whose box was met
  std::uint64_t hits = 0;      ///< crossings that ended up in spans
  std::uint64_t tie_rays = 0;  ///< moved aside by less than 1e-6 of the model to break an exact tie (half-open rule)
  std::uint64_t tolerance_rays = 0;  ///< moved aside within the solid's own edge tolerance
  std::uint64_t repaired_rays = 0;   ///< hits had to be dropped or invented to close
  std::uint64_t unclosed_rays = 0;   ///< could not be closed; the solid is left out of this ray
  std::uint64_t uncertain_hits = 0;  ///< hits flagged kUncertain
  std::uint64_t candidates = 0;      ///< patches handed to the root finder
  std::uint64_t iterations = 0;      ///< steps of the root finder

  CastCounters& operator+=(const CastCounters& other);
};

}  // namespace lamella
