#include "slicing/slab.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

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

void sort_loops(LayerContours& contours) {
  std::vector<std::size_t> order(contours.loops.size());
  std::iota(order.begin(), order.end(), 0);
  const auto solid_of = [&](std::size_t loop) { return contours.loops[loop].solid; };
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return solid_of(a) < solid_of(b); });
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<std::int32_t>(i);
  LayerContours sorted;
  for (const std::size_t i : order) {
    ContourLoop loop = contours.loops[i];
    if (loop.parent >= 0) loop.parent = place[static_cast<std::size_t>(loop.parent)];
    sorted.add(loop, contours.polygon(i), contours.curves_of(i));
  }
  contours = std::move(sorted);
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
