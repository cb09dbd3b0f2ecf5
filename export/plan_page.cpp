#include "export/plan_page.h"

#include <fmt/format.h>

#include "core/xml.h"
#include "export/page_style.h"
#include "export/plan_charts.h"
#include "materials/color.h"

namespace lamella {

namespace {

std::string number(double value, int digits = 2) { return fmt::format("{:.{}f}", value, digits); }
std::string number(const std::optional<double>& value, int digits) {
  return value ? number(*value, digits) : std::string("unknown");
}

std::string duration(double seconds) {
  const auto minutes = static_cast<long long>(seconds / 60.0 + 0.5);
  if (seconds < 120.0) return fmt::format("{:.1f} s", seconds);
  return minutes < 120 ? fmt::format("{} min", minutes) : fmt::format("{} h {:02} min", minutes / 60, minutes % 60);
}

std::string dot(const PlanMaterial& material) {
  return fmt::format("<i class=\"dot\" style=\"background:{}\"></i>{}", format_color(material.color),
                     xml_escape(material.name));
}

void write_card(std::ostream& out, const std::string& value, const std::string& label) {
  out << "<div class=\"card\"><b>" << value << "</b><span>" << label << "</span></div>\n";
}

std::string bounded(std::uint64_t count, std::uint64_t bound) {
  return count == bound ? fmt::format("{}", count) : fmt::format("{} (&ge; {})", count, bound);
}

void write_totals(const BuildPlan& plan, std::ostream& out) {
  double mass = 0.0;
  for (const PlanMaterial& material : plan.materials) mass += material.mass.value_or(0.0);
  out << "<div class=\"cards\">\n";
  write_card(out, duration(plan.time), "build time");
  write_card(out, fmt::format("{} {}", number(plan.cost), xml_escape(plan.currency)), "cost");
  write_card(out, number(mass) + " g", "mass, as far as densities are known");
  write_card(out, fmt::format("{}", plan.layers.size()), "layers");
  write_card(out, bounded(plan.tool_changes, plan.tool_changes_bound), "tool changes, " + duration(plan.change_time));
  write_card(out, bounded(plan.reloads, plan.reloads_bound), "manual changes, " + duration(plan.reload_time));
  write_card(out,
             fmt::format("{} &times; {} &times; {} mm", number(plan.size.x(), 1), number(plan.size.y(), 1),
                         number(plan.size.z(), 1)),
             plan.fits ? "size on the machine, fits" : "size on the machine, DOES NOT FIT");
  out << "</div>\n";
}

std::string tool_names(const BuildPlan& plan, const PlanMaterial& material) {
  std::string names;
  for (const ToolId tool : material.tools) names += (names.empty() ? "" : ", ") + xml_escape(plan.tools[tool.value()]);
  return names.empty() ? "not used" : names;
}

void write_materials(const BuildPlan& plan, std::ostream& out) {
  out << "<h2>Materials</h2>\n<div class=\"scroll\"><table><tr><th>material</th><th class=\"text\">tool</th>"
      << "<th>volume mm&sup3;</th><th>mass g</th><th>" << (plan.by_hatch ? "hatch rows mm" : "raster rows mm")
      << "</th><th>time s</th><th>purged mm&sup3;</th><th>over nothing mm&sup2;</th><th>cost "
      << xml_escape(plan.currency) << "</th></tr>\n";
  for (const PlanMaterial& m : plan.materials) {
    out << "<tr><td>" << dot(m) << "</td><td class=\"text\">" << tool_names(plan, m) << "</td><td>" << number(m.volume)
        << "</td><td>" << number(m.mass, 3) << "</td><td>" << number(m.length, 1) << "</td><td>" << number(m.time, 1)
        << "</td><td>" << number(m.purge, 1) << "</td><td>" << number(m.unsupported) << "</td><td>" << number(m.cost, 2)
        << "</td></tr>\n";
  }
  out << "</table></div>\n";
  if (plan.support) {
    out << "<p>Support of " << xml_escape(plan.support->material) << ": " << number(plan.support->volume)
        << " mm&sup3;, " << number(plan.support->cost, 2) << " " << xml_escape(plan.currency) << ".</p>\n";
  }
}

void write_key(const BuildPlan& plan, std::ostream& out) {
  out << "<div class=\"key\">";
  for (const PlanMaterial& material : plan.materials) {
    if (!material.tools.empty()) out << "<span>" << dot(material) << "</span>";
  }
  out << "</div>\n";
}

void write_findings(const BuildPlan& plan, std::ostream& out) {
  if (plan.findings.empty()) return;
  out << "<h2>Fit in the machine</h2>\n<div class=\"scroll\"><table><tr><th>kind</th><th>layer</th><th "
         "class=\"text\">material</th><th class=\"text\">what</th><th class=\"text\">hint</th></tr>\n";
  for (const PlanFinding& one : plan.findings) {
    const char* word = one.severity == Severity::error     ? "error"
                       : one.severity == Severity::warning ? "warning"
                                                           : "note";
    out << "<tr><td class=\"" << word << "\">" << word << "</td><td>"
        << (one.layer ? fmt::format("{}", *one.layer) : std::string()) << "</td><td class=\"text\">"
        << xml_escape(one.material) << "</td><td class=\"wrap\">" << xml_escape(one.what) << "</td><td class=\"wrap\">"
        << xml_escape(one.hint) << "</td></tr>\n";
  }
  out << "</table></div>\n";
}

}  // namespace

void write_plan_page(const BuildPlan& plan, const BuildInfo& info, std::ostream& out) {
  std::string source;
  for (const SourceFile& file : info.sources) source += (source.empty() ? "" : ", ") + file.path;
  out << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      << "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Build plan: "
      << xml_escape(plan.machine) << "</title><style>" << kPageStyle
      << "</style></head><body>\n<h1>Build plan: " << xml_escape(plan.machine) << "</h1>\n<p>" << xml_escape(source)
      << " &middot; " << name_of(plan.technology) << " &middot; "
      << (plan.is_optimal() ? "changes are proved to be fewest" : "changes are few, not proved fewest") << "</p>\n";
  write_totals(plan, out);
  write_materials(plan, out);
  out << "<h2>Area of each material</h2>\n";
  write_key(plan, out);
  out << area_chart(plan) << "<h2>Time of each layer</h2>\n<div class=\"key\"><span><i class=\"dot\" "
      << "style=\"background:var(--accent)\"></i>laying material down</span><span><i class=\"dot\" "
      << "style=\"background:var(--rest)\"></i>changes, reloads and overhead</span></div>\n"
      << time_chart(plan) << "<h2>Tools</h2>\n";
  write_key(plan, out);
  out << tool_chart(plan);
  write_findings(plan, out);
  out << "</body></html>\n";
}

}  // namespace lamella
