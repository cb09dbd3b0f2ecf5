#include "apps/plan_report.h"

#include <cmath>
#include <fmt/format.h>

#include "apps/table.h"

namespace lamella::apps {

namespace {

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json materials_json(const BuildPlan& plan) {
  Json list = Json::array();
  for (const PlanMaterial& material : plan.materials) {
    Json tools = Json::array();
    for (const ToolId tool : material.tools) tools.push_back(tool.value());
    list.push_back({{"name", material.name},
                    {"tool", material.tools.empty() ? Json(nullptr) : Json(material.tools.front().value())},
                    {"volume", material.volume},
                    {"mass", number_or_null(material.mass)},
                    {"length", material.length},
                    {"time", material.time},
                    {"cost", number_or_null(material.cost)},
                    {"tools", tools},
                    {"purge", material.purge},
                    {"unsupported", material.unsupported}});
  }
  return list;
}

Json findings_json(const BuildPlan& plan) {
  Json list = Json::array();
  for (const PlanFinding& finding : plan.findings) {
    list.push_back({{"severity", word_of(finding.severity)},
                    {"layer", finding.layer ? Json(*finding.layer) : Json(nullptr)},
                    {"material", text_or_null(finding.material)},
                    {"what", finding.what},
                    {"hint", finding.hint}});
  }
  return list;
}

std::string tools_text(const BuildPlan& plan, const PlanMaterial& material) {
  std::string text;
  for (const ToolId tool : material.tools) text += (text.empty() ? "" : ", ") + plan.tools[tool.value()];
  return text.empty() ? "-" : text;
}

std::string materials_text(const BuildPlan& plan) {
  TextTable table({{"material"},
                   {"tool"},
                   {"volume mm^3", true},
                   {"mass g", true},
                   {plan.by_hatch ? "hatch mm" : "rows mm", true},
                   {"time s", true},
                   {"purge mm^3", true},
                   {"cost " + plan.currency, true}});
  for (const PlanMaterial& m : plan.materials) {
    table.add({m.name, tools_text(plan, m), short_number(m.volume), short_number(m.mass.value_or(NAN)),
               short_number(m.length), short_number(m.time), short_number(m.purge),
               short_number(m.cost.value_or(NAN))});
  }
  return table.text();
}

/// "12", or "12 (at least 9)" where it isn't proved to be least.
std::string count_text(std::uint64_t count, std::uint64_t bound) {
  return count == bound ? fmt::format("{}", count) : fmt::format("{} (at least {})", count, bound);
}

std::string matching_text(const PlanMatching& matching) {
  if (matching.is_proved)
    return fmt::format("no other way to fill the tools costs less ({} weighed)\n", matching.weighed);
  return fmt::format("tools filled in the cheapest of {} ways that were weighed; another may cost less\n",
                     matching.weighed);
}

}  // namespace

std::string time_text(double seconds) {
  if (seconds < 60.0) return fmt::format("{:.3g} s", seconds);
  const long long whole = std::llround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  const long long minutes = std::llround(seconds / 60.0);
  return fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

Json plan_json(const BuildPlan& plan) {
  Json object{{"layers", plan.layers.size()},
              {"tool_changes", plan.tool_changes},
              {"time", plan.time},
              {"cost", plan.cost},
              {"materials", materials_json(plan)},
              {"machine", plan.machine},
              {"technology", name_of(plan.technology)},
              {"currency", plan.currency},
              {"lattice", plan.by_hatch ? "hatch" : "raster"},
              {"tools", plan.tools},
              {"tool_changes_bound", plan.tool_changes_bound},
              {"manual_changes", plan.reloads},
              {"manual_changes_bound", plan.reloads_bound},
              {"matchings", plan.matching ? Json(plan.matching->weighed) : Json(nullptr)},
              {"matching_proved", plan.matching ? Json(plan.matching->is_proved) : Json(nullptr)},
              {"change_time", plan.change_time},
              {"manual_change_time", plan.reload_time},
              {"machine_cost", plan.machine_cost},
              {"change_cost", plan.change_cost},
              {"size", json_of(plan.size)},
              {"fits", plan.fits},
              {"rotation", plan.turn ? json_of(*plan.turn) : Json(nullptr)}};
  if (plan.support) {
    object["support"] = {{"material", plan.support->material},
                         {"volume", plan.support->volume},
                         {"cost", number_or_null(plan.support->cost)}};
  } else {
    object["support"] = nullptr;
  }
  object["findings"] = findings_json(plan);
  return object;
}

std::string plan_text(const BuildPlan& plan) {
  std::string text = fmt::format("{} ({}): {} layers, {}, {} {:.2f}\n", plan.machine, name_of(plan.technology),
                                 plan.layers.size(), time_text(plan.time), plan.currency, plan.cost);
  text += fmt::format("tool changes {} ({}), manual changes {} ({})\n",
                      count_text(plan.tool_changes, plan.tool_changes_bound), time_text(plan.change_time),
                      count_text(plan.reloads, plan.reloads_bound), time_text(plan.reload_time));
  if (plan.matching) text += matching_text(*plan.matching);
  text += "\n" + materials_text(plan);
  if (plan.support) {
    text += fmt::format("support: {}, {} mm^3, {} {}\n", plan.support->material, short_number(plan.support->volume),
                        plan.currency, short_number(plan.support->cost.value_or(NAN)));
  }
  return text;
}

}  // namespace lamella::apps
