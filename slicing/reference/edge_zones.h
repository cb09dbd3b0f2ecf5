#pragma once

#include <cstdint>
#include <vector>

#include "model/scene.h"
#include "slicing/reference/patch_tree.h"

namespace lamella::reference {

/// The tube about one edge inside of which the faces that share the edge need not meet exactly. A ray outside of all
/// tubes can't slip between two faces, whatever their gaps.
struct EdgeZone {
  EdgeId edge;
  double radius = 0.0;  ///< mm: 1.5 times the gap measured between the edge and its images on the faces
  double stated = 0.0;  ///< mm: the edge's own tolerance from the file
};

/// A ray passing near an edge.
struct EdgePass {
  EdgeZone zone;
  double distance = 0.0;  ///< mm
  Vec3 point;             ///< of the edge, nearest to the ray
};

/// Zones of all edges of one solid, in a tree.
class EdgeZones {
 public:
  /// Measures the gap of every edge of `solid`: the distance of each face's image of the edge (by its pcurve) from the
  /// edge's curve, and of the ends from the vertices. `floor` (mm) is the least radius, the size of rounding errors.
  EdgeZones(const Scene& scene, SolidId solid, double floor);

  /// Appends every edge that the line passes within the larger of its radius and its stated tolerance; an edge may come
  /// more than once. `items` is work space.
  void find(const Ray& line, std::vector<std::uint32_t>& items, std::vector<EdgePass>& passes) const;

  [[nodiscard]] const std::vector<EdgeZone>& zones() const { return zones_; }

 private:
  /// Part of an edge between two samples; it stays within `bulge` mm of its chord.
  struct Piece {
    std::uint32_t zone = 0;
    double lo = 0.0;  ///< parameters of the edge's curve
    double hi = 0.0;
    Vec3 from;
    Vec3 to;
    double bulge = 0.0;
  };

  void add_pieces(std::uint32_t zone);

  const Scene* scene_;
  std::vector<EdgeZone> zones_;
  std::vector<Piece> pieces_;
  PatchTree tree_;
};

}  // namespace lamella::reference
