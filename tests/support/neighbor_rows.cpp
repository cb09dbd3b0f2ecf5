#include "tests/support/neighbor_rows.h"

#include <algorithm>

#include "tests/support/cut_scene.h"
#include "tests/support/span_sets.h"

namespace lamella::test {

NeighborRows::NeighborRows(const SpanEngine& engine, const std::vector<LayerRequest>& requests, double reach)
    : reach_(reach) {
  for (const double across : {0.0, -reach, reach}) {
    for (const double up : {0.0, -reach, reach}) {
      std::vector<LayerRequest> moved = requests;
      for (LayerRequest& request : moved) {
        request.z += up;
        for (RowLattice& lattice : request.lattices) lattice.anchor += across;
      }
      cuts_.push_back(cut_layers(engine, moved));
    }
  }
}

double NeighborRows::excess(std::size_t layer, std::size_t lattice, std::size_t row, SolidId solid,
                            const std::vector<Interval>& spans) const {
  std::vector<Interval> any;
  std::vector<Interval> all{{-1e9, 1e9}};
  for (const std::vector<LayerSpans>& cut : cuts_) {
    const std::vector<Interval> found = grown(spans_of(cut[layer].lattices[lattice], row, solid), 0.0);
    any = united(any, found);
    all = common(all, found);
  }
  const std::vector<Interval> here = grown(spans, 0.0);
  return std::max(longest(without(here, grown(any, reach_))), longest(without(grown(all, -reach_), here)));
}

std::vector<Interval> NeighborRows::spans(std::size_t layer, std::size_t lattice, std::size_t row,
                                          SolidId solid) const {
  return spans_of(cuts_.front()[layer].lattices[lattice], row, solid);
}

}  // namespace lamella::test
