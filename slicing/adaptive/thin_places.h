#pragma once

#include <cstdint>
#include <vector>

#include "slicing/adaptive/face_slants.h"
#include "slicing/adaptive/layer_reach.h"
#include "slicing/adaptive/ridge_slants.h"
#include "slicing/adaptive/slant_profile.h"

namespace lamella {

/// A part of a surface with another part of it, facing the other way, straight above or below: layers may lose it.
struct ThinPlace {
  /// The half of a layer in which it recedes by itself: the upper one of a part with something above. In the other half
  /// what faces it is nearer to the layer's middle.
  LayerHalf half = LayerHalf::upper;
  Interval z;         ///< mm, of the part
  Interval other;     ///< mm, of what is above or below
  double rate = 0.0;  ///< mm that it recedes by per mm of height; infinite where it is level
  Vec3 at = Vec3::Zero();
  FaceId face;
};

struct ThinParts {
  std::vector<Slant> upper;       ///< of thin places, with the rate that they recede by, in the upper halves of layers
  std::vector<Slant> lower;       ///< and in the lower ones
  std::vector<ThinPlace> beyond;  ///< those that recede faster than any layers can keep, one for each pair of heights
};

/// What layers may lose of a thin place.
struct ThinLoss {
  ThinPlace place;
  double deviation = 0.0;  ///< mm, a bound; infinite where all of it may be lost and it is level
};

/// For each face at most one, the largest, of those that layers, sampled at the heights `middles` (mm, ascending) and
/// ending at `borders` (one more), may lose by more than `allowed` mm: layers lose none of a place if a middle lies
/// between it and what faces it, and little of one that lies near to its own layer's middle.
[[nodiscard]] std::vector<ThinLoss> lost_places(const std::vector<ThinPlace>& places,
                                                const std::vector<double>& borders, const std::vector<double>& middles,
                                                double allowed);

/// Looks for the thin places of one solid, by its faces' Bezier nets (docs/methods/adaptive-layers.md). Queries are
/// safe from several threads at once.
class ThinSearch {
 public:
  /// The faces of the solid, which must outlive it.
  explicit ThinSearch(std::vector<const FaceSlants*> faces);

  /// Parts of one of the faces. What `known`, the finished profile of its slants, has anyway is left out.
  [[nodiscard]] ThinParts of_face(std::size_t face, const SlantProfile& known, const LayerReach& reach,
                                  const WedgeRule& rule) const;
  /// Of a ridge or a valley, along which what lies beside it runs down: both sides look up or both look down.
  [[nodiscard]] ThinParts of_line(const RidgeLine& line, const SlantProfile& known, const LayerReach& reach,
                                  const WedgeRule& rule) const;

  /// What of a patch, or of a line, there is between parameters.
  struct Part {
    std::uint32_t face = 0;
    std::uint32_t patch = 0;
    Interval u;
    Interval v;
    Box3 box;  ///< mm
    bool may_look_up = false;
    bool may_look_down = false;
    double slant = 1.0;  ///< a coarse bound
  };

 private:
  [[nodiscard]] std::vector<std::size_t> patches_near(const Box3& box) const;

  std::vector<const FaceSlants*> faces_;
  std::vector<Part> patches_;  ///< of all faces, by the least x of their boxes
  double widest_ = 0.0;        ///< mm, the largest extent along x of them
};

}  // namespace lamella
