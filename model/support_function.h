#pragma once

#include <span>
#include <vector>

#include "core/progress.h"
#include "model/face_extent.h"
#include "model/scene.h"

namespace lamella {

/// The support function h(d) = max d . p over the points p of some solids, from their exact trimmed surfaces.
///
/// The furthest point is a vertex, a point of an edge where the edge runs across d, or a point inside a face where the
/// normal lies along d. Boxes rule most of them out. Safe to ask from several threads.
class SupportFunction {
 public:
  /// Prepares the solids in parallel. The scene must outlive it. Throws GeometryError as TrimRegion does, Cancelled.
  SupportFunction(const Scene& scene, std::span<const SolidId> solids, const Progress& progress = {}, int threads = 0);

  /// The reach along `direction`, which must have unit length. `hint`, if given, is a point of the solids near the
  /// furthest one: it only saves time.
  [[nodiscard]] Reach operator()(const Vec3& direction, const Vec3* hint = nullptr) const;

  /// Height h(d) + h(-d) of the solids along a unit direction, mm.
  [[nodiscard]] double width(const Vec3& direction) const;

  /// Vertices, and points of edges where their curves aren't smooth.
  [[nodiscard]] const std::vector<Vec3>& points() const { return points_; }
  [[nodiscard]] const Box3& bounds() const { return bounds_; }
  /// mm: values are exact to this, but for tolerances of edges (see FaceExtent).
  [[nodiscard]] double accuracy() const;

 private:
  struct CurvedEdge {
    Curve3 curve;
    Interval range;
    Box3 box;
  };
  struct CurvedFace {
    FaceExtent extent;
    Box3 box;
  };

  void add_edge(const Scene& scene, EdgeId edge);
  void add_faces(const Scene& scene, std::span<const FaceId> faces, const Progress& progress, int threads);

  std::vector<Vec3> points_;
  std::vector<CurvedEdge> edges_;
  std::vector<CurvedFace> faces_;
  Box3 bounds_;
};

}  // namespace lamella
