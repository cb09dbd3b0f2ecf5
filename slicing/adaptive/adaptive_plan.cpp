#include "slicing/adaptive/adaptive_plan.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/parallel.h"
#include "core/xml.h"
#include "slicing/adaptive/layer_costs.h"

namespace lamella {

namespace {

constexpr double kTouch = 1e-9;  // mm
/// Of layers that may be: one number each is held in memory.
constexpr double kMaxCandidates = 2e7;
constexpr std::size_t kChunk = 256;  // borders that a thread looks at in one go

/// So much more than any number of extrema do horizontal faces and material changes count.
constexpr std::uint64_t kFlatWeight = std::uint64_t{1} << 32;

double top_of(const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids) {
  double top = -std::numeric_limits<double>::infinity();
  for (const SolidId id : solids) top = std::max(top, measures[id].bounds.max().z());
  return top;
}

/// Of the borders nearest to a height above the bottom the lower one, and whether the next is as near.
struct Nearest {
  double border = 0.0;
  bool is_between = false;
};

Nearest nearest_border(double height, double quantum) {
  const double below = std::floor(height / quantum);
  const double beyond = height - (below + 0.5) * quantum;  // the middle between two borders
  return {beyond > kTouch ? below + 1.0 : below, std::abs(beyond) <= kTouch};
}

/// The number of quanta nearest to the height, at least one.
std::size_t count_quanta(double height, const LayerRules& rules) {
  const double count = std::max(1.0, nearest_border(height, rules.quantum).border);
  if (!(count * static_cast<double>(rules.thicknesses.size()) <= kMaxCandidates)) {
    throw UsageError("too many layers to choose from: " + format_double(count) + " borders with " +
                         std::to_string(rules.thicknesses.size()) + " thicknesses each",
                     "--adaptive-step", "give a coarser step or a narrower --adaptive-range");
  }
  return static_cast<std::size_t>(count);
}

/// Enters what features cost at the border next to them, or at the two that are equally near: it meets either.
void weigh_borders(const ModelSlants& slants, double bottom, double quantum, LayerProblem& problem) {
  problem.missing.assign(problem.height + 1, 0);
  problem.missing_both.assign(problem.height + 1, 0);
  for (const FlatFeature& feature : slants.features) {
    const auto [border, is_between] = nearest_border(feature.z - bottom, quantum);
    if (border < 0.0 || border > static_cast<double>(problem.height)) continue;
    std::vector<std::uint64_t>& costs = is_between ? problem.missing_both : problem.missing;
    costs[static_cast<std::size_t>(border)] += feature.kind == FlatKind::extremum ? 1 : kFlatWeight;
  }
}

LayerProblem state_problem(const LayerRules& rules, const LayerCosts& costs, std::size_t count,
                           const Progress& progress, int threads) {
  LayerProblem problem;
  problem.height = count;
  problem.thicknesses = rules.thicknesses;
  const std::size_t width = rules.thicknesses.size();
  problem.deviations.assign(count * width, LayerProblem::kRefused);
  const std::size_t chunks = (count + kChunk - 1) / kChunk;
  parallel_for(
      chunks,
      [&](std::size_t chunk) {
        progress.throw_if_cancelled();
        for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk); ++i) {
          for (std::size_t t = 0; t < width; ++t) {
            if (!costs.accepts(i, rules.thicknesses[t])) continue;
            problem.deviations[i * width + t] = costs.deviation(i, rules.thicknesses[t]);
          }
        }
      },
      threads);
  return problem;
}

/// The thickest multiple of the quantum whose layers, all alike, deviate by no more than `deviation`.
void compare_uniform(const LayerCosts& costs, const LayerRules& rules, std::size_t count, double deviation,
                     AdaptivePlan& plan) {
  for (std::size_t thickness = rules.thicknesses.back(); thickness > 0; --thickness) {
    bool keeps = true;
    for (std::size_t i = 0; keeps && i < count; i += thickness) {
      keeps = costs.deviation(i, thickness) <= deviation + kTouch;
    }
    if (!keeps) continue;
    plan.uniform_layers = (count + thickness - 1) / thickness;
    plan.uniform_thickness = static_cast<double>(thickness) * rules.quantum;
    return;
  }
}

void add_layers(const LayerChoice& choice, const LayerCosts& costs, const LayerRules& rules, const ModelSlants& slants,
                AdaptivePlan& plan) {
  for (const MaterialId id : rules.materials.ids()) {
    plan.materials.push_back({rules.materials[id], 0.0, slants.profiles[id].has_value()});
  }
  for (std::size_t k = 0; k + 1 < choice.borders.size(); ++k) {
    const std::size_t border = choice.borders[k];
    const std::size_t thickness = choice.borders[k + 1] - border;
    const double bottom = costs.height(border);
    const double top = costs.height(choice.borders[k + 1]);
    // Half a quantum is a border of bins, so that the middle is where deviations are measured from.
    plan.layers.push_back({bottom, 0.5 * (bottom + top), top});

    for (const MaterialId id : rules.materials.ids()) {
      MaterialDeviation& material = plan.materials[id];
      material.largest = std::max(material.largest, costs.deviation(id, border, thickness));
    }

    plan.deviations.push_back(costs.deviation(border, thickness));
  }
  const auto height = static_cast<double>(choice.borders.back());
  plan.largest_deviation = choice.largest;
  plan.mean_deviation = choice.deviation_sum / height;
}

std::vector<MetFeature> met_features(const ModelSlants& slants, const LayerChoice& choice, const LayerCosts& costs,
                                     double quantum) {
  std::vector<double> borders;
  for (const std::size_t border : choice.borders) borders.push_back(costs.height(border));
  std::vector<MetFeature> out;
  for (const FlatFeature& feature : slants.features) {
    const auto above = std::lower_bound(borders.begin(), borders.end(), feature.z);
    double offset = above == borders.end() ? borders.back() - feature.z : *above - feature.z;
    if (above != borders.begin() && above != borders.end()) {
      const double below = *(above - 1) - feature.z;
      if (-below < offset) offset = below;
    }
    out.push_back({feature, offset, std::abs(offset) <= 0.5 * quantum + kTouch});
  }
  return out;
}

/// Of each material by what it allows.
std::vector<ThinLoss> lost_places(const Scene& scene, const MaterialTable& table, const LayerRules& rules,
                                  const ModelSlants& slants, const std::vector<LayerSpan>& layers) {
  std::vector<double> borders{layers.front().z_bottom};
  std::vector<double> middles;
  for (const LayerSpan& layer : layers) {
    borders.push_back(layer.z_top);
    middles.push_back(layer.z_sample);
  }
  IdVector<MaterialId, std::vector<ThinPlace>> places(rules.materials.size());
  for (const ThinPlace& place : slants.thin) {
    places[table.assignments[scene.solid_of(place.face)].material].push_back(place);
  }
  std::vector<ThinLoss> out;
  for (const MaterialId id : rules.materials.ids()) {
    const auto lost = lamella::lost_places(places[id], borders, middles, rules.materials[id].deviation);
    out.insert(out.end(), lost.begin(), lost.end());
  }
  std::sort(out.begin(), out.end(), [](const ThinLoss& a, const ThinLoss& b) { return a.place.face < b.place.face; });
  return out;
}

std::size_t count_missed(const std::vector<MetFeature>& features) {
  return static_cast<std::size_t>(
      std::count_if(features.begin(), features.end(), [](const MetFeature& met) { return !met.is_met; }));
}

}  // namespace

AdaptivePlan plan_adaptive_layers(const Scene& scene, const MaterialTable& table,
                                  const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids,
                                  double bottom, const AdaptiveOptions& options, const Progress& progress,
                                  int threads) {
  const LayerRules rules = layer_rules(table, options);
  const std::size_t count = count_quanta(top_of(measures, solids) - bottom, rules);
  // What lies above the nearest border must be seen by the layer below it.
  const SlantGrid grid{bottom, 0.5 * rules.quantum, 2 * (count + 1)};
  IdVector<MaterialId, WedgeRule> wedges;
  for (const MaterialLayers& layers : rules.materials) {
    wedges.push_back({layers.deviation, 2.0 * layers.deviation / layers.thickness().lo, layers.thickness().hi});
  }
  const ModelSlants slants = find_slants(scene, table, measures, solids, grid, wedges, progress, threads);
  const LayerCosts costs(table, rules, slants, bottom);
  progress.report("choosing layers", -1.0);
  LayerProblem problem = state_problem(rules, costs, count, progress, threads);
  weigh_borders(slants, bottom, rules.quantum, problem);
  const LayerSearch best = choose_best(problem);
  if (!best.choice) costs.refuse(best.reached);

  AdaptivePlan plan;
  plan.quantum = rules.quantum;
  plan.range = {static_cast<double>(rules.thicknesses.front()) * rules.quantum,
                static_cast<double>(rules.thicknesses.back()) * rules.quantum};
  add_layers(*best.choice, costs, rules, slants, plan);
  plan.features = met_features(slants, *best.choice, costs, rules.quantum);
  plan.missed = count_missed(plan.features);
  plan.sharp_edges = slants.sharp_edges;
  plan.thin = lost_places(scene, table, rules, slants, plan.layers);
  if (const auto greedy = choose_greedily(problem).choice) {
    plan.greedy_layers = greedy->layers();
    plan.greedy_missed = count_missed(met_features(slants, *greedy, costs, rules.quantum));
  }
  compare_uniform(costs, rules, count, plan.largest_deviation, plan);
  return plan;
}

void set_layers(LayerPlan& plan, const std::vector<LayerSpan>& layers) {
  plan.layers = layers;
  plan.grid.size[2] = static_cast<std::int64_t>(layers.size());
  plan.grid.pitch.z() = (layers.back().z_top - layers.front().z_bottom) / static_cast<double>(layers.size());
}

}  // namespace lamella
