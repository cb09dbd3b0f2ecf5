#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/progress.h"
#include "model/scene.h"
#include "slicing/slab.h"

namespace lamella {

struct SpanOptions {
  double tolerance = 1e-7;  ///< mm: how far a section arc may lie from the exact section between its exact points
  int threads = 0;          ///< for the preparation; 0: all cores
};

/// One arc of an exact section: points in the layer's plane, a polyline flattened to the chord error asked for.
struct SectionLoop {
  SolidId solid;
  std::vector<Vec2> points;  ///< closed: the last joins the first; material on the left
  double area = 0.0;         ///< signed, exact by the arcs: positive for outer loops, negative for holes, mm^2
};

/// The engine that users run: scan conversion of exact sections (docs/methods/span-engine.md). Topology decides whether
/// there is a hit, numerics only where: every arc of a section runs from one shared node to another, so that every row
/// closes in integers.
///
/// Immutable after construction; cut() may be called from several threads at once.
class SpanEngine {
 public:
  /// Prepares `solids` of the scene, which must outlive the engine. Throws GeometryError for surfaces beyond the stated
  /// limits, Cancelled when asked.
  SpanEngine(const Scene& scene, std::span<const SolidId> solids, const SpanOptions& options,
             const Progress& progress = {});
  ~SpanEngine();
  SpanEngine(SpanEngine&&) noexcept;

  /// Cuts consecutive layers, ascending in z; a SlabFunction.
  void cut(std::span<const LayerRequest> slab, std::span<LayerSpans> out) const;

  /// The exact contours of one solid at height z, flattened to `chord_error` mm.
  [[nodiscard]] std::vector<SectionLoop> contours(SolidId solid, double z, double chord_error) const;

  /// What preparing and cutting met that a user should know (faces fitted within a bound, checks that failed).
  [[nodiscard]] const std::vector<Finding>& findings() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace lamella
