#pragma once

#include <limits>
#include <memory>

#include "core/geometry.h"
#include "model/rational_form.h"
#include "model/scene.h"
#include "model/trim.h"

namespace lamella {

/// How far something reaches along a direction, and a point of it that reaches so far.
struct Reach {
  double value = -std::numeric_limits<double>::infinity();  ///< direction . point, mm for a unit direction
  Vec3 point = Vec3::Zero();
  bool converged = true;  ///< false where a search ended at its limit: something may reach further

  /// Takes what reaches further.
  void raise(double further, const Vec3& at) {
    if (!(further > value)) return;
    value = further;
    point = at;
  }
};

/// Whether a face of this surface can reach further than its border somewhere inside. On a plane, and along the rulings
/// of cylinders, cones and extrusions, a height is linear: what is furthest inside goes on to the border.
[[nodiscard]] bool may_exceed_border(const Surface& surface);

/// How far the inside of one trimmed face reaches along any direction. Safe to ask from several threads.
class FaceExtent {
 public:
  /// The scene must outlive it. Throws GeometryError as TrimRegion does.
  FaceExtent(const Scene& scene, FaceId face);

  /// Raises `best`, what is known to reach along `direction` (a unit vector) - the border has to be in it - to what the
  /// inside of the face reaches, exact to 1e-9 of the face's size and to the tolerance of its edges next to them.
  void raise(const Vec3& direction, Reach& best) const;

 private:
  struct Parts;
  std::shared_ptr<const Parts> parts_;
};

}  // namespace lamella
