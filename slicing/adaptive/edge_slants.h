#pragma once

#include <vector>

#include "slicing/adaptive/face_slants.h"

namespace lamella {

/// Which wedges count, those where a face that looks up meets one that looks down: layers cut off their tips.
struct WedgeRule {
  double deviation = 0.0;  ///< mm, that is allowed
  double steepest = 0.0;   ///< mm that a tip may recede by per mm of half a layer; what is beyond can't be kept
};

struct EdgeSlants {
  std::vector<Slant> parts;
  bool is_too_sharp = false;  ///< a wedge of which more than the allowed deviation may be cut off
};

/// Parts that cover an edge, given by one of its half-edges, with bounds of the slant of what lies between the normals
/// of its two faces. Where `known`, the slants of the faces, has as much anyway, parts may be long and bounds
/// coarse. An edge without a twin may be slanted in any way.
[[nodiscard]] EdgeSlants edge_slants(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                                     const FaceSlants* neighbor, const SlantProfile& known, const WedgeRule& wedges);

/// The face's parameters on a half-edge at a share, in [0, 1], of its edge's range.
[[nodiscard]] Vec2 parameters_at(const Scene& scene, HalfEdgeId half_edge, double share);

}  // namespace lamella
