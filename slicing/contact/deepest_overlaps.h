#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "slicing/combine.h"
#include "slicing/contact/solid_distances.h"
#include "slicing/layer_plan.h"
#include "slicing/slab.h"

namespace lamella {

/// On which layers of a plan the depth of overlaps is measured: on about eight of those that a solid takes.
class DepthSampling {
 public:
  DepthSampling(const LayerPlan& plan, const IdVector<SolidId, SolidMeasure>& measures);

  /// Of two solids the one that takes fewer layers decides.
  [[nodiscard]] bool takes(SolidId a, SolidId b, std::size_t layer) const {
    const Steps& steps = steps_[a].step < steps_[b].step ? steps_[a] : steps_[b];
    return (layer + steps.step - steps.first) % steps.step == 0;
  }

 private:
  struct Steps {
    std::uint32_t first = 0;  ///< below `step`
    std::uint32_t step = 1;
  };
  IdVector<SolidId, Steps> steps_;
};

/// Remembers for every pair of solids on which rows of a layer they overlap, and measures how deep that is.
class DeepestOverlaps {
 public:
  /// Starts a layer.
  void clear() { rows_.clear(); }
  /// What two solids share on a row of the lattice, counted from 0.
  void add(const PairLength& overlap, std::size_t row);

  /// For every pair how far inside both solids the middle of their longest common stretch on its row lies, mm; one
  /// entry a pair, ids ascending.
  void measure(const SolidDistances& distances, double z, const RowLattice& lattice, const SpanRows& spans,
               std::vector<PairLength>& out) const;

 private:
  struct Rows {
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t longest = 0;
    double length = 0.0;  ///< mm, on the longest
  };
  std::map<std::pair<SolidId, SolidId>, Rows> rows_;
};

}  // namespace lamella
