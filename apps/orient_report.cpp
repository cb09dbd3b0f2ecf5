#include "apps/orient_report.h"

#include <fmt/format.h>

#include "apps/table.h"

namespace lamella::apps {

namespace {

Json candidate_json(const OrientationCandidate& one) {
  const OrientationFigures& f = one.figures;
  return {{"rotation", json_of(one.lying.turn)},
          {"height", f.height},
          {"layers", f.layers},
          {"support_area", f.support_area},
          {"cusp_error", f.cusp_error},
          {"score", one.score},
          {"support_volume", f.support_volume},
          {"support_volume_error", one.support_error},
          {"largest_cusp", f.largest_cusp},
          {"contact_area", f.contact_area},
          {"tool_changes", f.tool_changes},
          {"size", json_of(one.lying.size)},
          {"up", json_of(one.up)},
          {"fits", one.fits},
          {"unsupported_kept", one.is_free},
          {"origin", one.origin}};
}

Json scan_json(const OrientRequest& request, const AxisScanResult& scan) {
  Json axes = Json::array();
  for (const Vec3& axis : request.scan->axes) axes.push_back(json_of(axis));
  Json turns = Json::array();
  for (const AxisTurn& turn : scan.turns) {
    turns.push_back({{"axis", turn.axis}, {"angle", turn.angle}, {"height", turn.height}});
  }
  return {{"axes", axes},   {"step", request.scan->step}, {"rotation", json_of(scan.turn)}, {"height", scan.height},
          {"turns", turns}, {"heights", scan.heights}};
}

std::string scan_text(const AxisScanResult& scan) {
  std::string text = fmt::format("turning about axes: {:.10g} mm", scan.height);
  for (const AxisTurn& turn : scan.turns) text += fmt::format(", axis {} by {:g} degrees", turn.axis + 1, turn.angle);
  return text + fmt::format(" ({} heights)\n", scan.heights);
}

std::string yes_or_no(bool value) { return value ? "yes" : "NO"; }

std::string up_text(const Vec3& up) {
  return fmt::format("{:.4f} {:.4f} {:.4f}", up.x() + 0.0, up.y() + 0.0, up.z() + 0.0);
}

}  // namespace

Json orient_json(const OrientRequest& request, const OrientOutcome& outcome) {
  Json candidates = Json::array();
  for (const OrientationCandidate& one : outcome.found.candidates) candidates.push_back(candidate_json(one));
  Json weights = Json::object();
  for (const auto& [name, weight] : named_weights(request.weights)) weights[name] = weight;
  const LeastWidth& least = outcome.least;
  Json object{{"candidates", candidates},
              {"least_height",
               {{"height", least.height},
                {"proved", least.proved},
                {"gap", least.gap()},
                {"accuracy", least.accuracy},
                {"up", json_of(least.direction)},
                {"triangles", least.cells},
                {"heights", least.heights},
                {"converged", least.converged}}},
              {"axis_scheme", outcome.scan ? scan_json(request, *outcome.scan) : Json(nullptr)},
              {"present_height", outcome.present_height},
              {"weights", weights},
              {"layer_height", outcome.layer_height},
              {"critical_angle", request.critical_angle * 180.0 / kPi},
              {"machine", outcome.machine ? Json(outcome.machine->name) : Json(nullptr)},
              {"tried", outcome.found.tried},
              {"samples", outcome.judge->samples().samples.size()},
              {"outside_area", outcome.judge->samples().area},
              {"findings", json_of(outcome.findings)}};
  return object;
}

std::string orient_text(const OrientRequest& request, const OrientOutcome& outcome) {
  const LeastWidth& least = outcome.least;
  std::string text = fmt::format("as it is: {:.10g} mm high\n", outcome.present_height);
  if (outcome.scan) text += scan_text(*outcome.scan);
  text += fmt::format("least height: {:.10g} mm; proved: no orientation is below {:.10g} mm (gap {:.1e})\n\n",
                      least.height, least.proved, least.gap());
  TextTable table({{"", true},
                   {"score", true},
                   {"height mm", true},
                   {"layers", true},
                   {"support mm^3", true},
                   {"under mm^2", true},
                   {"cusp mm", true},
                   {"contact mm^2", true},
                   {"tools", true},
                   {"size mm"},
                   {outcome.machine ? "fits" : ""},
                   {"up"},
                   {"from"}});
  std::size_t number = 0;
  for (const OrientationCandidate& one : outcome.found.candidates) {
    const OrientationFigures& f = one.figures;
    table.add({std::to_string(++number), fmt::format("{:.4f}", one.score), short_number(f.height),
               std::to_string(f.layers), short_number(f.support_volume), short_number(f.support_area),
               fmt::format("{:.3g}", f.cusp_error), short_number(f.contact_area), std::to_string(f.tool_changes),
               fmt::format("{:.5g} x {:.5g}", one.lying.size.x(), one.lying.size.y()),
               outcome.machine ? yes_or_no(one.fits) : "", up_text(one.up), one.origin});
  }
  text += table.text();
  text += fmt::format(
      "\nless score is better; layers of {:g} mm; undersides flatter than {:g} degrees need support; {} "
      "orientations judged\n",
      outcome.layer_height, request.critical_angle * 180.0 / kPi, outcome.found.tried);
  return text;
}

}  // namespace lamella::apps
