#include "slicing/layer_cutter.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "slicing/compensated_sum.h"

namespace lamella {

namespace {

/// Rows a task: enough to hide what starting a task costs, few enough that threads end together.
constexpr std::int64_t kRowsPerTask = 32;

/// A solid and the range it takes across the rows of a lattice.
struct Candidate {
  SolidId solid;
  Interval across;
};

/// The parallel lines of one lattice on one layer.
struct Rows {
  Vec2 along = Vec2::UnitX();
  Vec2 across = Vec2::UnitY();
  double anchor = 0.0;  ///< of row 0's lower side, mm along `across`
  double spacing = 1.0;
  double z = 0.0;

  [[nodiscard]] double position(std::int64_t row) const { return anchor + (static_cast<double>(row) + 0.5) * spacing; }
  [[nodiscard]] Ray ray(std::int64_t row) const {
    Ray ray;
    ray.origin << position(row) * across, z;
    ray.direction << along, 0.0;
    return ray;
  }
  [[nodiscard]] Interval range_of(const Box3& box) const {
    const Vec2 a = across.cwiseProduct(box.min().head<2>());
    const Vec2 b = across.cwiseProduct(box.max().head<2>());
    return {a.cwiseMin(b).sum(), a.cwiseMax(b).sum()};
  }
};

Rows raster_rows(const LayerPlan& plan, std::size_t layer) {
  Rows rows;
  rows.anchor = plan.grid.origin.y();
  rows.spacing = plan.grid.pitch.y();
  rows.z = plan.layers[layer].z_sample;
  return rows;
}

Rows hatch_rows(const LayerPlan& plan, std::size_t layer) {
  const HatchAxes axes = hatch_axes(*plan.hatch, layer);
  Rows rows;
  rows.along = axes.along;
  rows.across = axes.across;
  rows.spacing = plan.hatch->spacing;
  rows.z = plan.layers[layer].z_sample;
  return rows;
}

/// Sums of one row block, one per solid or material.
std::vector<double> values_of(const std::vector<CompensatedSum>& sums) {
  std::vector<double> values;
  values.reserve(sums.size());
  for (const CompensatedSum& sum : sums) values.push_back(sum.value());
  return values;
}

void append_rows(SegmentRows& to, const SegmentRows& from) {
  const std::uint64_t offset = to.segments.size();
  for (std::size_t r = 1; r < from.row_start.size(); ++r) to.row_start.push_back(offset + from.row_start[r]);
  to.segments.insert(to.segments.end(), from.segments.begin(), from.segments.end());
}

void add_tasks(std::vector<RowTask>& tasks, std::size_t layer, bool is_hatch, std::int64_t first, std::int64_t last) {
  for (std::int64_t row = first; row < last; row += kRowsPerTask) {
    tasks.push_back({layer, is_hatch, row, std::min(row + kRowsPerTask, last)});
  }
}

}  // namespace

LayerCutter::LayerCutter(const CastFunction& cast, const Scene& scene, const MaterialTable& table,
                         const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                         std::vector<SolidId> solids)
    : cast_(cast),
      measures_(measures),
      plan_(plan),
      solids_(std::move(solids)),
      material_count_(table.materials.size()) {
  rules_.table = &table;
  rules_.rank = rank_solids(scene, table, measures);
  rules_.face_tolerance.reserve(scene.faces.size());
  for (const Face& face : scene.faces) rules_.face_tolerance.push_back(face.tolerance);
}

std::vector<SolidId> LayerCutter::solids_at(double z) const {
  std::vector<SolidId> found;
  for (const SolidId solid : solids_) {
    const Box3& bounds = measures_[solid].bounds;
    if (bounds.min().z() <= z && z <= bounds.max().z()) found.push_back(solid);
  }
  return found;
}

std::vector<RowTask> LayerCutter::tasks_of(std::size_t layer) const {
  std::vector<RowTask> tasks;
  add_tasks(tasks, layer, false, 0, plan_.grid.size[1]);
  if (!plan_.hatch) return tasks;
  const Rows rows = hatch_rows(plan_, layer);
  Interval range{0.0, 0.0};
  bool is_first = true;
  for (const SolidId solid : solids_at(rows.z)) {
    const Interval across = rows.range_of(measures_[solid].bounds);
    range = is_first ? across : Interval{std::min(range.lo, across.lo), std::max(range.hi, across.hi)};
    is_first = false;
  }
  if (is_first) return tasks;
  const double first = std::ceil(range.lo / rows.spacing - 0.5);
  const double last = std::floor(range.hi / rows.spacing - 0.5) + 1.0;
  add_tasks(tasks, layer, true, static_cast<std::int64_t>(first), static_cast<std::int64_t>(last));
  return tasks;
}

RowBlock LayerCutter::cut(const RowTask& task) const {
  const Rows rows = task.is_hatch ? hatch_rows(plan_, task.layer) : raster_rows(plan_, task.layer);
  std::vector<Candidate> candidates;
  for (const SolidId solid : solids_at(rows.z)) candidates.push_back({solid, rows.range_of(measures_[solid].bounds)});

  RowBlock block;
  std::vector<CompensatedSum> solid_sums(measures_.size());
  std::vector<CompensatedSum> material_sums(material_count_);
  std::vector<Span> spans;
  SolidCast found;
  CombinedRow combined;
  for (std::int64_t row = task.first_row; row < task.last_row; ++row) {
    spans.clear();
    for (const Candidate& candidate : candidates) {
      if (!candidate.across.contains(rows.position(row))) continue;
      cast_(rows.ray(row), candidate.solid, found, block.cast);
      spans.insert(spans.end(), found.spans.begin(), found.spans.end());
    }
    for (const Span& span : spans) solid_sums[span.solid.value()].add(span.end - span.begin);
    combine_row(spans, rules_, combined);
    for (const Segment& segment : combined.segments) {
      material_sums[segment.material.value()].add(segment.x_end - segment.x_begin);
    }
    block.rows.segments.insert(block.rows.segments.end(), combined.segments.begin(), combined.segments.end());
    block.rows.row_start.push_back(block.rows.segments.size());
    block.overlaps.insert(block.overlaps.end(), combined.overlaps.begin(), combined.overlaps.end());
    block.gaps.insert(block.gaps.end(), combined.gaps.begin(), combined.gaps.end());
  }
  block.solid_length = values_of(solid_sums);
  block.material_length = values_of(material_sums);
  return block;
}

Layer LayerCutter::assemble(const std::vector<RowTask>& tasks, const std::vector<RowBlock>& blocks,
                            std::size_t layer) const {
  Layer out;
  out.index = static_cast<std::uint32_t>(layer);
  out.z_bottom = plan_.layers[layer].z_bottom;
  out.z_sample = plan_.layers[layer].z_sample;
  out.z_top = plan_.layers[layer].z_top;
  if (plan_.hatch) {
    out.hatch.emplace();
    out.hatch->angle = plan_.hatch->angle + static_cast<double>(layer) * plan_.hatch->rotation;
    out.hatch->spacing = plan_.hatch->spacing;
  }
  bool has_hatch_rows = false;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].layer != layer) continue;
    if (tasks[i].is_hatch && !has_hatch_rows) out.hatch->first_row = tasks[i].first_row;
    has_hatch_rows = has_hatch_rows || tasks[i].is_hatch;
    append_rows(tasks[i].is_hatch ? out.hatch->rows : out.raster, blocks[i].rows);
  }
  return out;
}

}  // namespace lamella
