#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "slicing/layer_sink.h"

namespace lamella {

/// One closed loop of what a material fills: outer loops run counterclockwise, holes clockwise.
struct MaterialLoop {
  std::vector<Vec2> points;  ///< mm; three at least, the last joins the first
  double area = 0.0;         ///< mm^2, of the polygon: positive for outer loops, negative for holes
  std::int32_t parent = -1;  ///< of a hole: the outer loop around it, by number; -1 for outer loops
};

/// What each material fills on a layer; an outer loop comes before its holes. Regions of different materials overlap
/// nowhere, but may share edges.
using MaterialContours = IdVector<MaterialId, std::vector<MaterialLoop>>;

/// Where corners of material contours lie: on a grid of 2^-20 mm, about a nanometre.
inline constexpr double kContourGrid = 1.0 / (1 << 20);  // mm

/// Makes contours of materials of those of solids: the overlap policy shares out what solids of equal priority cover,
/// each solid loses what solids of higher rank and other material cover, and what is left of one material unites
/// (docs/methods/material-contours.md). Nothing is joined from ends of
/// rows.
class ContourCombiner {
 public:
  /// Throws UsageError when the build's layers have no contours; `format` is who asks.
  ContourCombiner(const BuildInfo& info, std::string_view format);

  /// Of a layer with contours. The result depends neither on ids nor on the order of solids. May be called from several
  /// threads at once.
  [[nodiscard]] MaterialContours combine(const LayerContours& contours) const;

 private:
  OverlapPolicy policy_;
  IdVector<SolidId, MaterialId> materials_;
  IdVector<SolidId, int> priority_;
  IdVector<SolidId, int> rank_;
  std::size_t material_count_ = 0;
};

/// Throws UsageError when the build's layers have no contours; `format` is who asks.
void require_contours(const BuildInfo& info, std::string_view format);

}  // namespace lamella
