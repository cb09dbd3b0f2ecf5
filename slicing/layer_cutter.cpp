#include "slicing/layer_cutter.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace lamella {

namespace {

RowLattice raster_lattice(const Grid& grid) {
  RowLattice lattice;
  lattice.anchor = grid.origin.y();
  lattice.spacing = grid.pitch.y();
  lattice.last_row = grid.size[1];
  return lattice;
}

RowLattice sub_lattice(const Grid& grid, std::int64_t per_row) {
  RowLattice lattice = raster_lattice(grid);
  lattice.spacing = grid.pitch.y() / static_cast<double>(per_row);
  lattice.last_row *= per_row;
  return lattice;
}

/// The spans of a row with what fills its gaps, sorted; nearly always that is nothing.
std::span<const Span> filled_row(std::span<const Span> spans, std::span<const GapFill> fills, std::vector<Span>& out) {
  if (fills.empty()) return spans;
  out.assign(spans.begin(), spans.end());
  for (const GapFill& fill : fills) out.push_back(fill.span);
  sort_spans(out);
  return out;
}

/// Everything of a layer but its segments.
void begin_layer(const LayerPlan& plan, std::size_t index, const LayerRequest& request, Layer& layer) {
  layer.index = static_cast<std::uint32_t>(index);
  layer.z_bottom = plan.layers[index].z_bottom;
  layer.z_sample = plan.layers[index].z_sample;
  layer.z_top = plan.layers[index].z_top;
  if (!plan.hatch) return;
  if (!layer.hatch) layer.hatch.emplace();
  layer.hatch->angle = plan.hatch->angle + static_cast<double>(index) * plan.hatch->rotation;
  layer.hatch->spacing = plan.hatch->spacing;
  layer.hatch->first_row = request.lattices[1].first_row;
}

}  // namespace

LayerCutter::LayerCutter(const SlabEngine& engine, const Scene& scene, const MaterialTable& table,
                         const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                         std::vector<SolidId> solids, const Interfaces& interfaces, const Mixer& mixer)
    : engine_(engine),
      measures_(measures),
      plan_(plan),
      interfaces_(interfaces),
      mixer_(mixer),
      solids_(std::move(solids)),
      limits_(make_layer_limits(plan.grid.size[1], table.materials, scene.solids.size())),
      depth_sampling_(plan, measures) {
  rules_.table = &table;
  rules_.rank = interfaces.rank();
  if (const auto& tolerance = interfaces.gap_tolerance()) {
    rules_.gap_tolerance = *tolerance;
  } else {
    rules_.widen_at(scene.faces);
  }
}

/// The hatch rows that meet the box of a solid on that layer.
RowLattice LayerCutter::hatch_lattice(std::size_t layer) const {
  const HatchAxes axes = hatch_axes(*plan_.hatch, layer);
  RowLattice lattice;
  lattice.along = axes.along;
  lattice.across = axes.across;
  lattice.spacing = plan_.hatch->spacing;
  const double z = plan_.layers[layer].z_sample;
  bool is_first = true;
  Interval range;
  for (const SolidId solid : solids_) {
    const Box3& bounds = measures_[solid].bounds;
    if (!(bounds.min().z() <= z && z <= bounds.max().z())) continue;
    const Interval across = lattice.range_of(bounds);
    range = is_first ? across : Interval{std::min(range.lo, across.lo), std::max(range.hi, across.hi)};
    is_first = false;
  }
  if (is_first) return lattice;
  const auto first = static_cast<std::int64_t>(std::ceil(range.lo / lattice.spacing - 0.5));
  const auto last = static_cast<std::int64_t>(std::floor(range.hi / lattice.spacing - 0.5)) + 1;
  if (!(first < last)) return lattice;
  lattice.first_row = first;
  lattice.last_row = last;
  return lattice;
}

LayerRequest LayerCutter::request_of(std::size_t layer) const {
  LayerRequest request;
  request.layer = layer;
  request.z = plan_.layers[layer].z_sample;
  request.lattices.push_back(raster_lattice(plan_.grid));
  if (plan_.hatch) request.lattices.push_back(hatch_lattice(layer));
  if (plan_.sub_rows > 0) request.lattices.push_back(sub_lattice(plan_.grid, plan_.sub_rows));
  return request;
}

void LayerCutter::cut(std::size_t first_layer, std::span<CutLayer> out, Workspace& workspace) const {
  workspace.requests.clear();
  for (std::size_t i = 0; i < out.size(); ++i) workspace.requests.push_back(request_of(first_layer + i));
  if (!workspace.mixing) workspace.mixing.emplace(mixer_);
  make_layer_spans(workspace.requests, workspace.spans);
  engine_.cut(workspace.requests, workspace.spans);
  if (plan_.chord_error) cut_contours(out, workspace);
  for (std::size_t i = 0; i < out.size(); ++i) {
    combine(workspace.requests[i], workspace.spans[i], workspace, out[i]);
    if (const auto fault = find_layer_fault(out[i].layer, limits_)) {
      throw GeometryError("layer " + std::to_string(first_layer + i) + " came out malformed: " + *fault, {},
                          "please report this");
    }
  }
}

void LayerCutter::cut_contours(std::span<CutLayer> out, Workspace& workspace) const {
  workspace.contours.assign(out.size(), {});
  engine_.contours(workspace.requests, *plan_.chord_error, workspace.contours);
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i].layer.contours = std::move(workspace.contours[i].contours);
    if (!plan_.curves) out[i].layer.contours->curves.clear();
    out[i].contour_findings = std::move(workspace.contours[i].findings);
  }
}

/// Calls measure(row, spans, segments, fills) behind every row.
template <class Measure>
void LayerCutter::combine_rows(double z, const RowLattice& lattice, const SpanRows& spans, Workspace& workspace,
                               SegmentRows& out, const Measure& measure) const {
  out.row_start.assign(1, 0);
  out.segments.clear();
  interfaces_.fill(z, lattice, spans, workspace.fills);
  std::span<const GapFill> fills = workspace.fills;
  for (std::size_t r = 0; r < spans.rows(); ++r) {
    std::size_t count = 0;
    while (count < fills.size() && fills[count].row == r) ++count;
    workspace.row.combine(filled_row(spans.row(r), fills.first(count), workspace.filled_row), rules_, out.segments);
    measure(r, spans.row(r), std::span<const Segment>(out.segments).subspan(out.row_start.back()), fills.first(count));
    fills = fills.subspan(count);
    out.row_start.push_back(out.segments.size());
  }
}

void LayerCutter::combine(const LayerRequest& request, const LayerSpans& spans, Workspace& workspace,
                          CutLayer& out) const {
  check_layer_spans(request, spans);
  out.cast = spans.cast;
  out.failed = spans.failed;
  begin_layer(plan_, request.layer, request, out.layer);
  workspace.sums.clear(limits_.solids, limits_.materials);
  workspace.deepest.clear();
  const RowLattice& raster = request.lattices[0];
  combine_rows(
      request.z, raster, spans.lattices[0], workspace, out.layer.raster,
      [&](std::size_t r, std::span<const Span> row, std::span<const Segment> segments, std::span<const GapFill> fills) {
        workspace.sums.add(row, segments, workspace.row);
        for (const GapFill& fill : fills) workspace.sums.add_gap(fill.gap);
        for (const PairLength& overlap : workspace.row.overlaps()) {
          const bool is_taken = depth_sampling_.takes(overlap.first, overlap.second, request.layer);
          if (is_taken) workspace.deepest.add(overlap, r);
        }
      });
  out.mixing = {};
  mixer_.mix(request.z, raster, out.layer.raster, *workspace.mixing, out.mixing);
  workspace.sums.write(out.lengths);
  add_component_lengths(out.layer.raster, rules_.table->materials, out.lengths.materials);
  workspace.deepest.measure(interfaces_.distances(), request.z, raster, spans.lattices[0], out.lengths.depths);
  if (plan_.hatch) combine_unmeasured(request, spans, 1, workspace, out, out.layer.hatch->rows);
  if (plan_.sub_rows > 0) {
    if (!out.layer.sub_rows) out.layer.sub_rows.emplace();
    out.layer.sub_rows->per_row = plan_.sub_rows;
    const std::size_t last = request.lattices.size() - 1;
    combine_unmeasured(request, spans, last, workspace, out, out.layer.sub_rows->rows);
  }
}

/// Rows of a lattice that volumes aren't summed over.
void LayerCutter::combine_unmeasured(const LayerRequest& request, const LayerSpans& spans, std::size_t lattice,
                                     Workspace& workspace, CutLayer& out, SegmentRows& rows) const {
  combine_rows(request.z, request.lattices[lattice], spans.lattices[lattice], workspace, rows,
               [](std::size_t, std::span<const Span>, std::span<const Segment>, std::span<const GapFill>) {});
  mixer_.mix(request.z, request.lattices[lattice], rows, *workspace.mixing, out.mixing);
}

}  // namespace lamella
