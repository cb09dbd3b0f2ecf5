#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "model/nearest_point.h"
#include "model/scene.h"

namespace lamella {

/// Distances from the surfaces of a scene's solids, prepared when a solid is first asked for. Solids that the reader
/// found to be copies of one body share what is prepared. Safe from several threads at once.
class SolidDistances {
 public:
  /// The scene must outlive it.
  explicit SolidDistances(const Scene& scene);
  ~SolidDistances();

  /// The point of the solid's surface nearest to `point`, or nothing if there is none nearer than `within` mm.
  [[nodiscard]] std::optional<NearPoint> find(SolidId solid, const Vec3& point, double within) const;

  /// Of NearestPoint::may_come_within().
  [[nodiscard]] bool may_come_within(SolidId solid, const Vec3& point, double within) const;

  [[nodiscard]] const Scene& scene() const { return scene_; }

 private:
  struct Body;
  /// How a solid lies to the one that stands for its body: p_body = turn p + shift.
  struct Place {
    std::size_t body = 0;
    Mat3 turn = Mat3::Identity();
    Vec3 shift = Vec3::Zero();
    std::uint32_t face_shift = 0;  ///< from the body's face ids to the solid's, modulo 2^32
    bool is_moved = false;
  };

  [[nodiscard]] const NearestPoint& query_of(const Place& place) const;

  const Scene& scene_;
  std::vector<std::unique_ptr<Body>> bodies_;
  IdVector<SolidId, Place> places_;
};

/// The outward unit normal of a solid's face; zero where the surface has none.
[[nodiscard]] Vec3 outward_normal(const Scene& scene, FaceId face, const Vec2& uv);

}  // namespace lamella
