#pragma once

#include <mutex>
#include <vector>

#include "model/bezier.h"
#include "model/box_tree.h"
#include "model/nearest_point.h"
#include "model/rational_form.h"
#include "model/trim.h"

/// What NearestPoint searches: patches of faces and edges, each cut into parts when a search first comes near it.
namespace lamella {

/// A part of a surface between lines of its parameters, small enough for Newton's iteration.
struct SurfacePart {
  Box2 uv;
  bool is_inside = false;  ///< no border within
  Mat3 axes;               ///< rows: the normal in the middle and two directions across it
  Box3 box;                ///< axes * S over the part, by its net: far thinner than its box where it is slanted
};

/// A face whose patches are searched.
struct NearFace {
  FaceId id;
  const Surface* surface = nullptr;
  TrimRegion region;
  RationalForm form;  ///< its patches are taken out

  NearFace(const Scene& scene, FaceId id);
};

/// One Bezier patch of a face's surface. Searches are safe from several threads at once.
class NearPatch {
 public:
  /// `face` must outlive it.
  NearPatch(const NearFace& face, BezierPatch patch);

  /// Holds the patch.
  [[nodiscard]] const Box3& box() const { return box_; }
  /// Replaces `best` and `squared` (mm^2) by what is nearer than that, if there is anything.
  void search(const Vec3& point, double& squared, NearPoint& best) const;
  /// Whether the box of a part comes nearer than that.
  [[nodiscard]] bool may_come_within(const Vec3& point, double squared) const;

 private:
  void divide() const;

  const NearFace& face_;
  Box3 box_;
  mutable std::once_flag once_;
  mutable BezierPatch patch_;
  mutable std::vector<SurfacePart> parts_;
  mutable BoxTree tree_;
};

/// The curve of one edge, or the vertex of a degenerate one. Searches are safe from several threads at once.
class NearEdge {
 public:
  /// The scene must outlive it. `face` is what is found as the face.
  NearEdge(const Scene& scene, EdgeId edge, FaceId face);

  [[nodiscard]] const Box3& box() const { return box_; }
  void search(const Vec3& point, double& squared, NearPoint& best) const;
  [[nodiscard]] bool may_come_within(const Vec3& point, double squared) const;

 private:
  void divide() const;

  const Edge& edge_;
  FaceId face_;
  Box3 box_;
  mutable std::once_flag once_;
  mutable std::vector<Interval> parts_;
  mutable BoxTree tree_;
};

}  // namespace lamella
