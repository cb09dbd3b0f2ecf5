#pragma once

#include <vector>

#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/model_slants.h"

namespace lamella {

/// Heights that differ by no more than this, in mm, are one.
inline constexpr double kSameHeight = 1e-6;

/// The face is horizontal, or its height is extremal somewhere inside: what is flat there.
[[nodiscard]] std::vector<FlatFeature> flat_features(const Scene& scene, FaceId id, const FaceSlants& face);

/// Where the height along an edge is extremal, or all along it where it is horizontal, if the solid's surface is
/// locally highest or lowest there: a vertical direction lies between the normals of its faces.
[[nodiscard]] std::vector<FlatFeature> flat_features(const Scene& scene, HalfEdgeId half_edge, const FaceSlants& face,
                                                     const FaceSlants& neighbor);

/// Sorts by height and joins what is at one height, with the kind that counts most.
[[nodiscard]] std::vector<FlatFeature> joined(std::vector<FlatFeature> features);

}  // namespace lamella
