#pragma once

#include <optional>
#include <string>

#include "core/geometry.h"
#include "model/nearest_point.h"
#include "model/scene.h"

namespace lamella {

/// p -> turn p + shift, from a solid's part frame to the machine's; the identity where the reader knows of none.
struct PartFrame {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  [[nodiscard]] Vec3 to_part(const Vec3& point) const { return turn.transpose() * (point - shift); }
  [[nodiscard]] Vec3 to_machine(const Vec3& point) const { return turn * point + shift; }
};
[[nodiscard]] PartFrame part_frame(const SolidInfo& solid);

/// Exact distances of points of a part's frame from faces of one solid (docs/methods/distance.md).
class PartDistance {
 public:
  /// Of the faces whose name matches the glob, or all. Throws InputError that lists the solid's face names when none
  /// does.
  PartDistance(const Scene& scene, SolidId solid, const std::optional<std::string>& faces, const std::string& where);

  /// The nearest point of the faces if it is nearer than `within` mm; both points in the part's frame.
  [[nodiscard]] std::optional<NearPoint> find(const Vec3& point, double within) const;

  /// Diagonal of the faces' box, mm.
  [[nodiscard]] double size() const { return faces_.bounds().diagonal().norm(); }

 private:
  PartFrame frame_;
  NearestPoint faces_;
};

}  // namespace lamella
