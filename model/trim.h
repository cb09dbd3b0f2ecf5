#pragma once

#include <vector>

#include "core/geometry.h"
#include "core/ids.h"
#include "model/bezier.h"
#include "model/scene.h"
#include "model/winding_tree.h"

namespace lamella {

/// The trimmed region of one face in the (u, v) of its surface: loops with holes, seams and poles.
///
/// Gaps between consecutive pcurves are bridged by straight segments; the region is where the winding number of the
/// loops, orientation taken into account and summed over the periods, is not zero. Safe to query from several threads.
class TrimRegion {
 public:
  TrimRegion(const Scene& scene, FaceId face);

  enum class Side { inside, outside, on_boundary };

  /// Where `uv` lies. `tolerance` (per coordinate, in parameter units; both may be zero) is the half-width of the
  /// box around `uv` within which the boundary counts as met. Periodic coordinates are tried in every period that
  /// meets the region's bounds.
  [[nodiscard]] Side classify(const Vec2& uv, const Vec2& tolerance = Vec2::Zero()) const;

  /// The parameter of the period in which classify() found `uv` inside or on the boundary, else `uv` itself.
  [[nodiscard]] Vec2 unwrap(const Vec2& uv, const Vec2& tolerance = Vec2::Zero()) const;

  /// Box of the control points of the boundary; empty for a face without any.
  [[nodiscard]] const Box2& bounds() const { return bounds_; }
  /// The boundary as oriented rational Bezier pieces, region on the left, bridges included.
  [[nodiscard]] const std::vector<BezierCurve2>& boundary() const { return pieces_; }

 private:
  struct Place {
    Side side = Side::outside;
    Vec2 uv;
  };
  [[nodiscard]] Place locate(const Vec2& uv, const Vec2& tolerance) const;

  std::vector<BezierCurve2> pieces_;
  WindingTree tree_;
  Box2 bounds_;
  Vec2 periods_ = Vec2::Zero();
};

}  // namespace lamella
