#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "core/geometry.h"
#include "model/scene.h"

namespace lamella {

/// A point of a face, or of its border, and how far it is.
struct NearPoint {
  double distance = 0.0;  ///< mm
  Vec3 point = Vec3::Zero();
  FaceId face;
  Vec2 uv = Vec2::Zero();  ///< zero on an edge
  bool on_edge = false;    ///< found as a point of an edge's curve
};

/// Distances from points to trimmed faces (docs/methods/distance.md).
///
/// Branch and bound over boxes of Bezier nets and of edges, Newton's iteration in the parts that are left. Inside faces
/// distances are exact to rounding; at a face's border they are those of its edges' curves, which lie within the edges'
/// tolerances of it. Queries are safe from several threads at once.
class NearestPoint {
 public:
  /// Throws as TrimRegion and rational_form() do. The scene must outlive it.
  NearestPoint(const Scene& scene, std::span<const FaceId> faces);
  ~NearestPoint();
  NearestPoint(NearestPoint&&) noexcept;
  NearestPoint& operator=(NearestPoint&&) noexcept;

  /// The nearest point of all faces, or nothing if there is none nearer than `within` mm. Of equally near ones it is
  /// one. A small `within` makes it cheap: what is farther costs a look at a few boxes.
  [[nodiscard]] std::optional<NearPoint> find(const Vec3& point,
                                              double within = std::numeric_limits<double>::infinity()) const;

  /// Whether boxes of parts say that something may lie nearer than `within` mm: false is certain, and cheap.
  [[nodiscard]] bool may_come_within(const Vec3& point, double within) const;

  /// Box of all faces, not exact.
  [[nodiscard]] Box3 bounds() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

/// The faces of a solid, in order.
[[nodiscard]] std::vector<FaceId> faces_of(const Scene& scene, SolidId solid);

}  // namespace lamella
