#include "core/xml_writer.h"
#include "materials/color.h"
#include "slicing/plan/build_plan.h"
#include "slicing/plan/plan_words.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

void write_head(XmlWriter& xml, const BuildPlan& plan) {
  xml.attribute("xmlns", kPlanNamespace)
      .attribute("version", plan.matching ? kWeighedPlanVersion
                            : plan.turn   ? kTurnedPlanVersion
                                          : kPlanVersion)
      .attribute("machine", plan.machine);
  xml.attribute("technology", name_of(plan.technology)).attribute("currency", plan.currency);
  xml.attribute("lattice", plan.by_hatch ? "hatch" : "raster").attribute("width", plan.width);
  xml.attribute("layers", plan.layers.size()).attribute("time", plan.time).attribute("cost", plan.cost);
  xml.attribute("tool_changes", plan.tool_changes).attribute("tool_changes_bound", plan.tool_changes_bound);
  xml.attribute("reloads", plan.reloads).attribute("reloads_bound", plan.reloads_bound);
  if (plan.matching) {
    xml.attribute("matchings", plan.matching->weighed).attribute("matching_proved", plan.matching->is_proved);
  }
  xml.attribute("change_time", plan.change_time).attribute("reload_time", plan.reload_time);
  xml.attribute("machine_cost", plan.machine_cost).attribute("change_cost", plan.change_cost);
  xml.attribute("fits", plan.fits).attribute("size_x", plan.size.x()).attribute("size_y", plan.size.y());
  xml.attribute("size_z", plan.size.z());
}

void write_material(XmlWriter& xml, const PlanMaterial& material, std::size_t id) {
  std::string tools;
  for (const ToolId tool : material.tools) {
    if (!tools.empty()) tools += ' ';
    tools += std::to_string(tool.value());
  }
  xml.start("material").attribute("id", id).attribute("name", material.name);
  xml.attribute("color", format_color(material.color)).attribute("tools", tools);
  if (material.density) xml.attribute("density", *material.density);
  xml.attribute("volume", material.volume);
  if (material.mass) xml.attribute("mass", *material.mass);
  xml.attribute("length", material.length).attribute("time", material.time).attribute("purge", material.purge);
  xml.attribute("unsupported", material.unsupported);
  if (material.cost) xml.attribute("cost", *material.cost);
  xml.end();
}

void write_lists(XmlWriter& xml, const BuildPlan& plan) {
  if (plan.turn) {
    xml.start("orientation");
    for (int i = 0; i < 9; ++i) xml.attribute(kTurnNames[static_cast<std::size_t>(i)], (*plan.turn)(i / 3, i % 3));
    xml.end();
  }
  xml.start("tools");
  for (std::size_t t = 0; t < plan.tools.size(); ++t) {
    xml.start("tool").attribute("id", t).attribute("name", plan.tools[t]).end();
  }
  xml.end().start("materials");
  for (std::size_t m = 0; m < plan.materials.size(); ++m) write_material(xml, plan.materials[m], m);
  xml.end();
  if (plan.support) {
    xml.start("support").attribute("material", plan.support->material).attribute("volume", plan.support->volume);
    if (plan.support->cost) xml.attribute("cost", *plan.support->cost);
    xml.end();
  }
  xml.start("findings");
  for (const PlanFinding& finding : plan.findings) {
    xml.start("finding").attribute("severity", severity_word(finding.severity));
    if (finding.layer) xml.attribute("layer", *finding.layer);
    if (!finding.material.empty()) xml.attribute("material", finding.material);
    xml.attribute("what", finding.what).attribute("hint", finding.hint).end();
  }
  xml.end();
}

void write_step(XmlWriter& xml, const BuildPlan& plan, const PlanStep& step) {
  const MaterialStatistics& s = step.statistics;
  const auto& density = plan.materials[step.material.value()].density;
  xml.start("step").attribute("material", step.material.value()).attribute("tool", step.tool.value());
  if (step.is_change) xml.attribute("change", true).attribute("change_time", step.change_time);
  if (step.is_reload) xml.attribute("reload", true);
  xml.attribute("time", step.time).attribute("segments", s.segments).attribute("length", s.length);
  xml.attribute("travel", s.travel).attribute("area", s.area).attribute("volume", step.volume);
  if (density) xml.attribute("mass", step.volume * *density * 1e-3);
  if (step.purge > 0.0) xml.attribute("purge", step.purge);
  xml.attribute("islands", s.islands).attribute("smallest", s.smallest).attribute("shortest", s.shortest);
  if (s.thin > 0.0) xml.attribute("thin", s.thin);
  if (s.specks > 0) xml.attribute("specks", s.specks);
  if (s.unsupported > 0.0) xml.attribute("unsupported", s.unsupported);
  xml.end();
}

}  // namespace

void write_plan_xml(const BuildPlan& plan, std::ostream& stream) {
  XmlWriter xml(stream);
  xml.start("plan");
  write_head(xml, plan);
  write_lists(xml, plan);
  for (const PlanLayer& layer : plan.layers) {
    xml.start("layer").attribute("index", layer.index).attribute("z_bottom", layer.z_bottom);
    xml.attribute("z_top", layer.z_top).attribute("time", layer.time);
    for (const PlanStep& step : layer.steps) write_step(xml, plan, step);
    xml.end();
  }
  xml.end();
}

}  // namespace lamella
