#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"

namespace lamella::reference {

/// The tube about one edge in which a face's hit is doubtful, because the faces that meet there need not meet exactly.
struct EdgeZone {
  double radius = 0.0;         ///< mm: four times the gap measured between the faces, at most four times the stated one
  double stated = 0.0;         ///< mm: the edge's own tolerance from the file
  Box3 box;                    ///< of the edge, enlarged by the larger of the two
  std::vector<double> params;  ///< samples along the edge's curve; a single one for a degenerate edge
  std::vector<Vec3> points;
};

/// How near a point is to an edge.
struct EdgeNearness {
  bool doubtful = false;       ///< within the radius of an edge's zone
  bool within_stated = false;  ///< within an edge's stated tolerance
  double radius = 0.0;         ///< largest radius of the zones it lies in
};

/// Zones of all edges of one solid, by face.
class EdgeZones {
 public:
  /// Measures the gap of every edge of `solid`: the distance between the edge's curve and each face's own image of it
  /// at equal parameters, and to the vertices at the ends. `floor` (mm) is the least radius, the size of rounding
  /// errors.
  EdgeZones(const Scene& scene, SolidId solid, double floor);

  /// Tests `point` against the edges of face number `face` of the solid, in the order of shells and faces.
  [[nodiscard]] EdgeNearness test(const Scene& scene, std::uint32_t face, const Vec3& point) const;

  /// Largest radius among the edges of one face.
  [[nodiscard]] double face_radius(std::uint32_t face) const { return face_radius_[face]; }

 private:
  std::vector<EdgeId> edges_;
  std::vector<EdgeZone> zones_;
  std::vector<std::uint32_t> first_of_face_;  ///< face f has of_face_[first_of_face_[f] .. first_of_face_[f + 1])
  std::vector<std::uint32_t> of_face_;        ///< indices into zones_
  std::vector<double> face_radius_;
};

/// Distance in mm from `point` to an edge's curve where that lies between `enough` and `limit`; below `enough` some
/// distance not above it, beyond `limit` some distance beyond it.
[[nodiscard]] double distance_to_edge(const Edge& edge, const EdgeZone& zone, const Vec3& point, double enough,
                                      double limit);

}  // namespace lamella::reference
