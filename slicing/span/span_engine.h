#pragma once

#include <cstdint>
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

/// One closed loop of an exact section, material on its left: outer loops run counterclockwise, holes clockwise.
struct SectionLoop {
  std::vector<Vec2> points;          ///< mm; a polygon within the chord error asked for, the last point joins the first
  double area = 0.0;                 ///< mm^2, of the exact loop: positive for outer loops, negative for holes
  std::int32_t parent = -1;          ///< the smallest loop of the other kind around it, by index; -1 if there is none
  std::vector<ContourCurve> curves;  ///< that sides of the polygon are chords of, sides counted in this loop
};

/// The section of one solid at one height.
struct SectionContours {
  SolidId solid;
  double z = 0.0;  ///< mm
  std::vector<SectionLoop> loops;
  double area = 0.0;                    ///< mm^2, of the whole section
  std::vector<std::vector<Vec2>> open;  ///< chains that don't close, in no loop: a finding each
  std::vector<Finding> findings;
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

  /// The contours of all solids on consecutive layers, ascending in z; a ContourFunction. Points as contours() has
  /// them.
  void add_contours(std::span<const LayerRequest> slab, double chord_error, std::span<CutContours> out) const;

  /// The contours of one of the solids at any height z. No point of a loop lies further than `chord_error` mm (1e-9 at
  /// least) from its polygon, nor the other way round; nodes, where faces meet, are corners of the polygons. Where the
  /// two faces of a node leave a gap, the loop goes straight through the node. Areas are those of the arcs, whatever
  /// the chord error: within what arcs may be off (docs/methods/span-engine.md) times the loop's length.
  [[nodiscard]] SectionContours contours(SolidId solid, double z, double chord_error) const;

  /// The same at many heights, ascending, for less: arcs are carried from one to the next.
  [[nodiscard]] std::vector<SectionContours> contours(SolidId solid, std::span<const double> heights,
                                                      double chord_error) const;

  /// Areas of the sections of one solid at ascending heights, mm^2, without a search for loops.
  [[nodiscard]] std::vector<double> section_areas(SolidId solid, std::span<const double> heights) const;

  /// What preparing and cutting met that a user should know (faces fitted within a bound, checks that failed).
  [[nodiscard]] const std::vector<Finding>& findings() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace lamella
