#include "slicing/slicer.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/parallel.h"
#include "slicing/layer_check.h"
#include "slicing/layer_cutter.h"
#include "slicing/tally.h"

namespace lamella {

namespace {

/// Layers cut together. Two windows are in memory: one being cut, one being written.
constexpr std::size_t kWindow = 8;

/// Some consecutive layers, as tasks that can run in any order and their results.
struct Window {
  std::size_t first_layer = 0;
  std::size_t last_layer = 0;  ///< one past
  std::vector<RowTask> tasks;
  std::vector<RowBlock> blocks;
};

std::vector<SolidId> choose_solids(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                   bool allow_open) {
  std::vector<SolidId> chosen;
  std::string left_out;
  for (const SolidId solid : scene.solids.ids()) {
    const SolidInfo& info = scene.solids[solid].info;
    const Box3& bounds = measures[solid].bounds;
    const bool is_bounded = bounds.min().allFinite() && bounds.max().allFinite() && !bounds.isEmpty();
    const bool is_trusted = info.closed && info.status != SolidStatus::open;
    if (is_bounded && info.status != SolidStatus::empty && (is_trusted || allow_open)) {
      chosen.push_back(solid);
    } else {
      left_out += (left_out.empty() ? "'" : ", '") + info.path + "'";
    }
  }
  if (!chosen.empty()) return chosen;
  throw InputError("no closed solid to slice", left_out.empty() ? std::string("the files hold no solid") : left_out,
                   "repair the solids, or slice them by winding number with --allow-open");
}

/// Under the interface policies an overlap is shared along +x, which only hatch rows along +x see alike.
void check_policy(const MaterialTable& table, const LayerPlan& plan) {
  if (!plan.hatch || table.policy == OverlapPolicy::priority || table.policy == OverlapPolicy::error) return;
  for (std::size_t layer = 0; layer < plan.layers.size(); ++layer) {
    if (hatch_axes(*plan.hatch, layer).along == Vec2::UnitX()) continue;
    throw UsageError("the overlap policies entry, exit and average need hatch rows along +x", {},
                     "use --hatch-angle 0 without rotation, or give the solids priorities");
  }
}

Window plan_window(const LayerCutter& cutter, std::size_t first_layer, std::size_t layer_count) {
  Window window;
  window.first_layer = first_layer;
  window.last_layer = std::min(first_layer + kWindow, layer_count);
  for (std::size_t layer = window.first_layer; layer < window.last_layer; ++layer) {
    const std::vector<RowTask> tasks = cutter.tasks_of(layer);
    window.tasks.insert(window.tasks.end(), tasks.begin(), tasks.end());
  }
  window.blocks.resize(window.tasks.size());
  return window;
}

/// Adds up and writes the layers of a window that has been cut, in increasing z.
void write_window(const Window& window, const LayerCutter& cutter, const LayerLimits& limits, Tally& tally,
                  LayerSink& sink) {
  for (std::size_t i = 0; i < window.tasks.size(); ++i) tally.add(window.tasks[i], window.blocks[i]);
  for (std::size_t layer = window.first_layer; layer < window.last_layer; ++layer) {
    const Layer cut = cutter.assemble(window.tasks, window.blocks, layer);
    if (const auto fault = find_layer_fault(cut, limits)) {
      throw GeometryError("layer " + std::to_string(layer) + " came out malformed: " + *fault, {},
                          "please report this");
    }
    sink.write(cut);
  }
}

void cut_layers(const LayerCutter& cutter, const LayerLimits& limits, std::size_t layer_count, int threads,
                Tally& tally, LayerSink& sink, const Progress& progress) {
  progress.report("slicing", 0.0);
  Window cut;
  for (std::size_t first = 0; first < layer_count || !cut.tasks.empty(); first += kWindow) {
    Window next = plan_window(cutter, std::min(first, layer_count), layer_count);
    // The first task writes the last window while the others cut the next one.
    const auto work = [&](std::size_t i) {
      progress.throw_if_cancelled();
      if (i == 0) {
        write_window(cut, cutter, limits, tally, sink);
      } else {
        next.blocks[i - 1] = cutter.cut(next.tasks[i - 1]);
      }
    };
    parallel_for(1 + next.tasks.size(), work, threads);
    progress.report("slicing", static_cast<double>(next.first_layer) / static_cast<double>(layer_count));
    cut = std::move(next);
  }
}

}  // namespace

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

SliceReport slice_with(const CastFunction& cast, const Scene& scene, const MaterialTable& table,
                       const IdVector<SolidId, SolidMeasure>& measures, const LayerPlan& plan,
                       const SliceOptions& options, LayerSink& sink, const Progress& progress) {
  progress.throw_if_cancelled();
  const std::vector<SolidId> solids = choose_solids(scene, measures, options.allow_open);
  check_policy(table, plan);
  const LayerCutter cutter(cast, scene, table, measures, plan, solids);
  const LayerLimits limits{static_cast<std::size_t>(plan.grid.size[1]), table.materials.size(), scene.solids.size()};
  Tally tally(scene, table, measures, plan, solids);
  try {
    sink.begin(make_build_info(scene, table, measures, plan));
    cut_layers(cutter, limits, plan.layers.size(), options.threads, tally, sink, progress);
    SliceReport report = tally.finish();
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
