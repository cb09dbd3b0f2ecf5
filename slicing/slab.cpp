#include "slicing/slab.h"

#include <algorithm>
#include <string>

#include "core/error.h"

namespace lamella {

Interval RowLattice::range_of(const Box3& box) const {
  const Vec2 a = across.cwiseProduct(box.min().head<2>());
  const Vec2 b = across.cwiseProduct(box.max().head<2>());
  return {a.cwiseMin(b).sum(), a.cwiseMax(b).sum()};
}

void make_layer_spans(std::span<const LayerRequest> slab, std::vector<LayerSpans>& out) {
  out.resize(slab.size());
  for (std::size_t i = 0; i < slab.size(); ++i) {
    out[i].cast = {};
    out[i].failed.clear();
    out[i].lattices.resize(slab[i].lattices.size());
    for (SpanRows& rows : out[i].lattices) {
      rows.row_start.assign(1, 0);
      rows.spans.clear();
    }
  }
}

void note_failed(std::vector<FailedCheck>& failed, const FailedCheck& more) {
  for (FailedCheck& known : failed) {
    if (known.check != more.check || known.solid != more.solid || known.face != more.face) continue;
    known.count += more.count;
    known.longest = std::max(known.longest, more.longest);
    return;
  }
  failed.push_back(more);
}

void check_layer_spans(const LayerRequest& request, const LayerSpans& spans) {
  bool is_complete = spans.lattices.size() == request.lattices.size();
  for (std::size_t k = 0; is_complete && k < request.lattices.size(); ++k) {
    const SpanRows& rows = spans.lattices[k];
    is_complete = rows.row_start.size() == request.lattices[k].rows() + 1 && rows.row_start.front() == 0 &&
                  rows.row_start.back() == rows.spans.size() &&
                  std::is_sorted(rows.row_start.begin(), rows.row_start.end());
  }
  if (is_complete) return;
  throw GeometryError("the engine did not give all rows of layer " + std::to_string(request.layer), {},
                      "please report this");
}

}  // namespace lamella
