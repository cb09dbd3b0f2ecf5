#pragma once

#include <map>
#include <utility>
#include <vector>

#include "model/scene.h"
#include "tests/support/solids.h"

namespace lamella::test {

/// One use of an edge in a loop. `pcurve` runs along with the edge, whatever `forward`.
struct EdgeUse {
  std::size_t edge;
  bool forward;
  Curve2 pcurve;
};

/// Loops with the region on the left in (u, v), whatever `same_sense`.
struct FacePlan {
  Surface surface;
  bool same_sense = true;
  std::vector<std::vector<EdgeUse>> loops;
};

struct EdgePlan {
  Curve3 curve;
  Interval range;
  std::size_t start;
  std::size_t end;
  bool degenerate = false;
};

/// A solid before it is placed and entered into a scene; indices are local.
struct SolidPlan {
  std::vector<Vec3> vertices;
  std::vector<EdgePlan> edges;
  std::vector<std::vector<FacePlan>> shells;

  std::size_t vertex(const Vec3& point);
  std::size_t edge(const Curve3& curve, Interval range, std::size_t start, std::size_t end);
  std::size_t degenerate_edge(Interval range, std::size_t at);
  /// The straight edge between two vertices, made at its first use; `forward` tells the sense of this use.
  std::pair<std::size_t, bool> line(std::size_t from, std::size_t to);

 private:
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> lines_;
};

[[nodiscard]] Curve2 project(const Curve3& curve, const Plane& plane);
/// pcurve from `from` to `to` over `range`.
[[nodiscard]] Curve2 line_pcurve(const Vec2& from, const Vec2& to, Interval range);

/// Plane face with its frame's z outward; `loops` as (edge, forward), region on the left seen from outside.
[[nodiscard]] FacePlan planar_face(const SolidPlan& plan, const Frame& frame,
                                   const std::vector<std::vector<std::pair<std::size_t, bool>>>& loops);

/// The whole (u, v) rectangle: `bottom` and `top` run along u, `left` and `right` along v (equal for a seam).
[[nodiscard]] FacePlan rectangle_face(const Surface& surface, Interval u, Interval v, const SolidPlan& plan,
                                      std::size_t bottom, std::size_t right, std::size_t top, std::size_t left);

/// Places the plan and enters it; sets twins, closed and void flags, uv bounds.
SolidId enter(Scene& scene, const SolidPlan& plan, const SolidOptions& options);

}  // namespace lamella::test
