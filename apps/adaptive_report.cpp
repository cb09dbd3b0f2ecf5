#include "apps/adaptive_report.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "apps/table.h"
#include "apps/terminal.h"

namespace lamella::apps {

namespace {

const char* kind_word(FlatKind kind) {
  switch (kind) {
    case FlatKind::extremum:
      return "extremum";
    case FlatKind::face:
      return "face";
    case FlatKind::material_change:
      break;
  }
  return "material-change";
}

/// For people: thicknesses as they were typed.
std::string short_mm(double value) { return fmt::format("{:.6g}", std::round(value * 1e6) * 1e-6); }

/// Runs of equal thickness: [{"z_bottom","layers","thickness","largest_deviation"}].
Json runs_json(const AdaptivePlan& plan) {
  Json out = Json::array();
  long last = -1;
  for (std::size_t k = 0; k < plan.layers.size(); ++k) {
    const double thickness = plan.layers[k].z_top - plan.layers[k].z_bottom;
    const long quanta = std::lround(thickness / plan.quantum);
    if (quanta != last) {
      out.push_back({{"z_bottom", plan.layers[k].z_bottom},
                     {"layers", 0},
                     {"thickness", static_cast<double>(quanta) * plan.quantum},
                     {"largest_deviation", 0.0}});
      last = quanta;
    }
    Json& run = out.back();
    run["layers"] = run["layers"].get<int>() + 1;
    run["largest_deviation"] = std::max(run["largest_deviation"].get<double>(), plan.deviations[k]);
  }
  return out;
}

Json features_json(const AdaptivePlan& plan, const Assembly& assembly) {
  Json out = Json::array();
  for (const MetFeature& met : plan.features) {
    out.push_back({{"z", met.feature.z},
                   {"kind", kind_word(met.feature.kind)},
                   {"solid", met.feature.solid.value()},
                   {"path", assembly.scene.solids[met.feature.solid].info.path},
                   {"count", met.feature.count},
                   {"offset", met.offset},
                   {"met", met.is_met}});
  }
  return out;
}

/// A place's deviation, or null where it is level and may be lost as a whole.
Json thin_json(const AdaptivePlan& plan, const Assembly& assembly) {
  Json out = Json::array();
  for (const ThinLoss& loss : plan.thin) {
    const Vec3& at = loss.place.at;
    const SolidId solid = assembly.scene.solid_of(loss.place.face);
    out.push_back({{"solid", solid.value()},
                   {"path", assembly.scene.solids[solid].info.path},
                   {"face", assembly.scene.faces[loss.place.face].step_entity},
                   {"at", {at.x(), at.y(), at.z()}},
                   {"deviation", std::isfinite(loss.deviation) ? Json(loss.deviation) : Json(nullptr)}});
  }
  return out;
}

Json limits_json(const AdaptivePlan& plan, const Assembly& assembly) {
  Json out = Json::array();
  for (const MaterialId id : plan.materials.ids()) {
    const MaterialDeviation& material = plan.materials[id];
    if (!material.is_used) continue;
    const Interval thickness = material.asked.thickness();
    out.push_back({{"name", assembly.table.materials[id].name},
                   {"deviation", material.asked.deviation},
                   {"thickness", {thickness.lo, thickness.hi}},
                   {"tools", material.asked.tools},
                   {"largest_deviation", material.largest}});
  }
  return out;
}

template <class T>
Json value_or_null(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

}  // namespace

Json adaptive_json(const AdaptivePlan& plan, const Assembly& assembly, double deviation) {
  return {{"deviation", deviation},
          {"quantum", plan.quantum},
          {"range", {plan.range.lo, plan.range.hi}},
          {"layers", plan.layers.size()},
          {"largest_deviation", plan.largest_deviation},
          {"mean_deviation", plan.mean_deviation},
          {"greedy_layers", value_or_null(plan.greedy_layers)},
          {"greedy_missed", plan.greedy_missed},
          {"uniform_layers", value_or_null(plan.uniform_layers)},
          {"uniform_thickness", value_or_null(plan.uniform_thickness)},
          {"materials", limits_json(plan, assembly)},
          {"sharp_edges", plan.sharp_edges},
          {"thin_faces", thin_json(plan, assembly)},
          {"missed", plan.missed},
          {"features", features_json(plan, assembly)},
          {"thicknesses", runs_json(plan)}};
}

std::string adaptive_text(const AdaptivePlan& plan, const Assembly& assembly, double deviation) {
  double least = plan.range.hi;
  double most = 0.0;
  for (const LayerSpan& layer : plan.layers) {
    least = std::min(least, layer.z_top - layer.z_bottom);
    most = std::max(most, layer.z_top - layer.z_bottom);
  }
  std::string out = fmt::format(
      "adaptive: {} layers of {} to {} mm (steps of {} mm), deviation at most {:.4g} of {:.4g} mm, {:.4g} mm on "
      "average\n",
      plan.layers.size(), short_mm(least), short_mm(most), short_mm(plan.quantum), plan.largest_deviation, deviation,
      plan.mean_deviation);
  if (plan.uniform_layers) {
    out += fmt::format("uniform layers that deviate as little: {} of {} mm", *plan.uniform_layers,
                       short_mm(*plan.uniform_thickness));
  } else {
    out += "no uniform layers deviate as little";
  }
  out += plan.greedy_layers ? fmt::format("; chosen greedily: {}\n", *plan.greedy_layers)
                            : std::string("; the greedy scheme finds none\n");
  out +=
      fmt::format("flat features and material changes: {} heights, {} met within {} mm, {} not\n", plan.features.size(),
                  plan.features.size() - plan.missed, short_mm(0.5 * plan.quantum), plan.missed);
  if (plan.sharp_edges > 0) {
    out += fmt::format("edges too sharp for any layers here, whose tips are cut off by more: {}\n", plan.sharp_edges);
  }
  if (!plan.thin.empty()) {
    const auto less = [](const ThinLoss& a, const ThinLoss& b) { return a.deviation < b.deviation; };
    const ThinLoss& worst = *std::max_element(plan.thin.begin(), plan.thin.end(), less);
    const Vec3& at = worst.place.at;
    out += fmt::format(
        "faces with thin, flat places that these layers may lose: {}, the worst at {:.6g} {:.6g} {:.6g} mm\n",
        plan.thin.size(), at.x(), at.y(), at.z());
  }
  TextTable table(
      {{"material"}, {"deviates [mm]", true}, {"may [mm]", true}, {"layers from [mm]", true}, {"to", true}});
  for (const MaterialId id : plan.materials.ids()) {
    const MaterialDeviation& material = plan.materials[id];
    if (!material.is_used) continue;
    table.add({assembly.table.materials[id].name, fmt::format("{:.4g}", material.largest),
               fmt::format("{:.4g}", material.asked.deviation), short_mm(material.asked.thickness().lo),
               short_mm(material.asked.thickness().hi)});
  }
  return out + table.text();
}

std::vector<Finding> adaptive_findings(const AdaptivePlan& plan, const Assembly& assembly) {
  std::vector<Finding> out;
  for (const MetFeature& met : plan.features) {
    if (met.is_met) continue;
    out.push_back(
        {Severity::warning,
         assembly.scene.solids[met.feature.solid].info.path,
         {},
         {},
         fmt::format("no layer ends at the {} at z = {:.6g} mm, but {:.4g} mm {} it", kind_word(met.feature.kind),
                     met.feature.z, std::abs(met.offset), met.offset > 0.0 ? "above" : "below"),
         "allow thinner layers: --adaptive-range"});
  }
  return out;
}

}  // namespace lamella::apps
