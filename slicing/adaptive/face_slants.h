#pragma once

#include <vector>

#include "model/normal_net.h"
#include "model/rational_form.h"
#include "model/scene.h"
#include "model/trim.h"
#include "slicing/adaptive/slant_profile.h"

namespace lamella {

/// Which way a part of a face may look, neither where it is upright, and a coarse bound of its slant.
struct LookRange {
  bool up = false;
  bool down = false;
  double slant = 1.0;
};

/// The normals of one trimmed face. Queries are safe from several threads at once.
class FaceSlants {
 public:
  /// Throws as TrimRegion and rational_form() do. The scene must outlive it.
  FaceSlants(const Scene& scene, FaceId face);

  /// Exact heights of the face, mm.
  [[nodiscard]] const Interval& heights() const { return heights_; }
  /// Exact box of the face, mm.
  [[nodiscard]] const Box3& box() const { return box_; }

  /// Parts that cover the trimmed face, each with a bound of the slant over it, by halving Bezier nets. Parts are no
  /// higher than `resolution` mm where the slant changes over them. What would need too much work keeps a coarse bound.
  [[nodiscard]] std::vector<Slant> parts(double resolution) const;

  /// Bezier nets of normals over the part of the surface with parameters in `uv`: their span holds the outward normals.
  [[nodiscard]] NormalCone normals(const Box2& uv) const;

  /// The outward unit normal, or zero where the surface has none.
  [[nodiscard]] Vec3 normal_at(const Vec2& uv) const;
  /// The same a thousandth of the way from there into the face's parameters, where a pole or an apex has normals.
  [[nodiscard]] Vec3 normal_beside(const Vec2& uv) const;

  [[nodiscard]] const Surface& surface() const { return face_.surface; }
  /// The surface's Bezier patches, and nets of the normals of each.
  [[nodiscard]] const RationalForm& form() const { return form_; }
  [[nodiscard]] const std::vector<NormalNet>& nets() const { return nets_; }
  /// Of one patch the outward normals over parameters of the form, which may be a point.
  [[nodiscard]] NormalCone normals_of(std::size_t patch, const Interval& u, const Interval& v) const;
  /// Of one patch over parameters of the form: a bound of the slant, and which way it may look.
  [[nodiscard]] double largest_slant_of(std::size_t patch, const Interval& u, const Interval& v) const;
  [[nodiscard]] LookRange looks_of(std::size_t patch, const Interval& u, const Interval& v) const;
  /// Whether all of a rectangle of the form's parameters is certainly outside the trimmed face.
  [[nodiscard]] bool is_outside(const Interval& u, const Interval& v) const;

 private:
  const Face& face_;
  TrimRegion region_;
  RationalForm form_;
  std::vector<NormalNet> nets_;  ///< of the form's patches
  Box3 box_;
  Interval heights_;
};

}  // namespace lamella
