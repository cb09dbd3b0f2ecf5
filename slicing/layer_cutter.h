#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slicing/combine.h"
#include "slicing/contact/deepest_overlaps.h"
#include "slicing/contact/interfaces.h"
#include "slicing/layer.h"
#include "slicing/layer_check.h"
#include "slicing/layer_lengths.h"
#include "slicing/layer_plan.h"
#include "slicing/mixer.h"
#include "slicing/slab.h"
#include "slicing/slab_engine.h"

namespace lamella {

/// What cutting one layer gave: the layer, and what was measured on the way. Hatch rows count as casts only; volumes,
/// overlaps and gaps are the raster lattice's.
struct CutLayer {
  Layer layer;
  CastCounters cast;
  std::vector<FailedCheck> failed;
  LayerLengths lengths;
  MixFaults mixing;  ///< both lattices
  std::vector<Finding> contour_findings;
};

/// Cuts slabs of layers: asks the engine for spans and combines the spans of every row into segments.
class LayerCutter {
 public:
  /// Memory that is used again from slab to slab, by one thread at a time.
  struct Workspace {
    std::vector<LayerRequest> requests;
    std::vector<LayerSpans> spans;
    RowCombiner row;
    LengthSums sums;
    std::vector<GapFill> fills;
    std::vector<Span> filled_row;
    DeepestOverlaps deepest;
    std::optional<Mixer::Workspace> mixing;
    std::vector<CutContours> contours;
  };

  /// `solids` are those to cut, all with finite bounds; the engine makes contours if the plan has them. Everything
  /// referred to must outlive the cutter.
  LayerCutter(const SlabEngine& engine, const Scene& scene, const MaterialTable& table,
              const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan, std::vector<SolidId> solids,
              const Interfaces& interfaces, const Mixer& mixer);

  /// Cuts layers [first_layer, first_layer + out.size()). Safe to call from several threads at once; the result depends
  /// on the layers alone. `out` is overwritten and its memory used again. Throws GeometryError when a layer comes out
  /// malformed.
  void cut(std::size_t first_layer, std::span<CutLayer> out, Workspace& workspace) const;

 private:
  [[nodiscard]] LayerRequest request_of(std::size_t layer) const;
  [[nodiscard]] RowLattice hatch_lattice(std::size_t layer) const;
  template <class Measure>
  void combine_rows(double z, const RowLattice& lattice, const SpanRows& spans, Workspace& workspace, SegmentRows& out,
                    const Measure& measure) const;
  void cut_contours(std::span<CutLayer> out, Workspace& workspace) const;
  void combine(const LayerRequest& request, const LayerSpans& spans, Workspace& workspace, CutLayer& out) const;
  void combine_unmeasured(const LayerRequest& request, const LayerSpans& spans, std::size_t lattice,
                          Workspace& workspace, CutLayer& out, SegmentRows& rows) const;

  const SlabEngine& engine_;
  const IdVector<SolidId, SolidMeasure>& measures_;
  const LayerPlan& plan_;
  const Interfaces& interfaces_;
  const Mixer& mixer_;
  std::vector<SolidId> solids_;
  CombineRules rules_;
  LayerLimits limits_;
  DepthSampling depth_sampling_;
};

}  // namespace lamella
