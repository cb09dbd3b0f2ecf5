#include "slicing/slicer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "core/ordered_pipeline.h"
#include "core/parallel.h"
#include "slicing/interface_policy.h"
#include "slicing/layer_cutter.h"
#include "slicing/mixer.h"
#include "slicing/tally.h"

namespace lamella {

namespace {

/// In memory at once: one that is being cut, one that waits to be written.
constexpr std::size_t kSlabsPerThread = 2;

/// Under the interface policies an overlap is shared along +x, which only hatch rows along +x see alike.
void check_policy(const MaterialTable& table, const LayerPlan& plan) {
  if (!plan.hatch || !has_interfaces(table.policy)) return;
  for (std::size_t layer = 0; layer < plan.layers.size(); ++layer) {
    if (hatch_axes(*plan.hatch, layer).along == Vec2::UnitX()) continue;
    throw UsageError("the overlap policies entry, exit and average need hatch rows along +x", {},
                     "use --hatch-angle 0 without rotation, or give the solids priorities");
  }
}

void check_contours(const SlabEngine& engine, const LayerPlan& plan) {
  if (!plan.chord_error || engine.contours) return;
  throw UsageError("contours need the span engine and a closed solid", {},
                   "leave out --engine reference, repair the solids, or leave out the contours");
}

/// Consecutive layers that are cut together, and what is left to do to write them.
struct Slab {
  std::vector<CutLayer> layers;
  std::vector<std::function<void()>> writes;
};

Box3 bounds_of(const IdVector<SolidId, SolidMeasure>& measures, const std::vector<SolidId>& solids) {
  Box3 bounds;
  for (const SolidId solid : solids) bounds.extend(measures[solid].bounds);
  return bounds;
}

/// Workspaces for as many slabs as are being cut at once.
class WorkspacePool {
 public:
  std::unique_ptr<LayerCutter::Workspace> take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<LayerCutter::Workspace>();
    auto workspace = std::move(free_.back());
    free_.pop_back();
    return workspace;
  }
  void put_back(std::unique_ptr<LayerCutter::Workspace> workspace) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(workspace));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<LayerCutter::Workspace>> free_;
};

/// Adds up and writes the layers of a slab in increasing z.
void write_slab(Slab& slab, std::size_t layer_count, Tally& tally, const Progress& progress) {
  for (std::size_t i = 0; i < slab.layers.size(); ++i) {
    const CutLayer& cut = slab.layers[i];
    progress.throw_if_cancelled();
    tally.add(cut);
    slab.writes[i]();
    progress.report("slicing", (cut.layer.index + 1.0) / static_cast<double>(layer_count));
  }
  slab.writes.clear();
}

/// Cuts slabs and prepares them for the sink in parallel while others, in order, are written.
void cut_layers(const LayerCutter& cutter, std::size_t slab_layers, std::size_t layer_count, int threads, Tally& tally,
                LayerSink& sink, const Progress& progress) {
  progress.report("slicing", 0.0);
  std::vector<Slab> slabs(kSlabsPerThread * static_cast<std::size_t>(count_threads(threads)));
  WorkspacePool workspaces;
  const auto cut = [&](std::size_t item, std::size_t slot) {
    progress.throw_if_cancelled();
    const std::size_t first = item * slab_layers;
    Slab& slab = slabs[slot];
    slab.layers.resize(std::min(slab_layers, layer_count - first));
    auto workspace = workspaces.take();
    cutter.cut(first, slab.layers, *workspace);
    workspaces.put_back(std::move(workspace));
    for (const CutLayer& layer : slab.layers) slab.writes.push_back(sink.prepare(layer.layer));
  };
  const auto write = [&](std::size_t, std::size_t slot) { write_slab(slabs[slot], layer_count, tally, progress); };
  ordered_pipeline((layer_count + slab_layers - 1) / slab_layers, slabs.size(), cut, write, threads);
}

}  // namespace

bool is_closed(const SolidInfo& solid) { return solid.closed && solid.status != SolidStatus::open; }

std::vector<SolidId> choose_solids(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                   bool allow_open) {
  std::vector<SolidId> chosen;
  std::string left_out;
  for (const SolidId solid : scene.solids.ids()) {
    const SolidInfo& info = scene.solids[solid].info;
    const Box3& bounds = measures[solid].bounds;
    const bool is_bounded = bounds.min().allFinite() && bounds.max().allFinite() && !bounds.isEmpty();
    if (is_bounded && info.status != SolidStatus::empty && (is_closed(info) || allow_open)) {
      chosen.push_back(solid);
    } else {
      left_out += (left_out.empty() ? "'" : ", '") + info.path + "'";
    }
  }
  if (!chosen.empty()) return chosen;
  throw InputError("no closed solid to slice", left_out.empty() ? std::string("the files hold no solid") : left_out,
                   "repair the solids, or slice them by winding number with --allow-open");
}

BuildInfo make_build_info(const Scene& scene, const MaterialTable& table,
                          const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan) {
  BuildInfo info;
  info.sources = scene.files;
  info.materials = table.materials;
  info.policy = table.policy;
  info.plan = plan;
  for (const SolidId id : scene.solids.ids()) {
    const SolidInfo& from = scene.solids[id].info;
    BuildSolid solid;
    solid.name = from.name;
    solid.path = from.path;
    solid.material = table.assignments[id].material;
    solid.priority = table.assignments[id].priority;
    solid.volume_exact = std::isfinite(measures[id].volume) ? measures[id].volume : 0.0;
    if (measures[id].bounds.min().allFinite() && measures[id].bounds.max().allFinite())
      solid.bounds = measures[id].bounds;
    info.solids.push_back(std::move(solid));
  }
  return info;
}

SliceReport slice_with(const SlabEngine& engine, const Scene& scene, const MaterialTable& table,
                       const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                       const SliceOptions& options, LayerSink& sink, const Progress& progress) {
  progress.throw_if_cancelled();
  const std::vector<SolidId> solids = choose_solids(scene, measures, options.allow_open);
  check_policy(table, plan);
  check_contours(engine, plan);
  const Compositions compositions(scene, table);
  const Mixer mixer(compositions, bounds_of(measures, solids));
  const double reach = plan.grid.pitch.head<2>().maxCoeff();
  const Interfaces interfaces(scene, table, measures, solids, {options.gap_tolerance, reach, options.threads},
                              progress);
  const LayerCutter cutter(engine, scene, table, measures, plan, solids, interfaces, mixer);
  Tally tally(scene, table, measures, plan, solids, interfaces.contacts());
  try {
    BuildInfo info = make_build_info(scene, table, measures, plan);
    info.turn = options.turn;
    sink.begin(info);
    cut_layers(cutter, engine.slab_layers, plan.layers.size(), options.threads, tally, sink, progress);
    SliceReport report = tally.finish();
    if (engine.findings) {
      const std::vector<Finding> findings = engine.findings();
      report.findings.insert(report.findings.end(), findings.begin(), findings.end());
    }
    progress.throw_if_cancelled();
    sink.finish(report);
    progress.report("slicing", 1.0);
    return report;
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    sink.abandon();
    throw;
  }
}

}  // namespace lamella
