#include "apps/slice_report.h"

#include <cmath>
#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/table.h"
#include "apps/terminal.h"

namespace lamella::apps {

namespace {

Json pair_json(const PairReport& pair) {
  return {{"solids", {pair.first.value(), pair.second.value()}},
          {"volume", pair.volume},
          {"layers", pair.layers},
          {"largest_depth", pair.largest_depth}};
}

Json contacts_json(const std::vector<ContactReport>& contacts, bool are_open) {
  Json out = Json::array();
  for (const ContactReport& contact : contacts) {
    Json entry{{"solids", {contact.first.value(), contact.second.value()}},
               {"area", contact.area},
               {"layers", contact.layers},
               {"largest_gap", contact.largest_gap}};
    if (are_open) entry["volume"] = contact.volume;
    if (are_open) entry["least_gap"] = contact.least_gap;
    out.push_back(std::move(entry));
  }
  return out;
}

Json pairs_json(const std::vector<PairReport>& pairs) {
  Json out = Json::array();
  for (const PairReport& pair : pairs) out.push_back(pair_json(pair));
  return out;
}

Json solids_json(const SliceOutcome& outcome) {
  Json out = Json::array();
  for (const SolidId id : outcome.assembly.scene.solids.ids()) {
    const SolidReport& solid = outcome.report.solids[id];
    const Assignment& assignment = outcome.assembly.table.assignments[id];
    const SolidInfo& info = outcome.assembly.scene.solids[id].info;
    out.push_back({{"id", id.value()},
                   {"name", info.name},
                   {"material", outcome.assembly.table.materials[assignment.material].name},
                   {"volume_sliced", solid.volume_sliced},
                   {"volume_exact", solid.volume_exact},
                   {"status", solid.status},
                   {"path", info.path},
                   {"left_out", solid.left_out},
                   {"quadrature_bound", solid.quadrature_bound}});
  }
  return out;
}

Json materials_json(const SliceOutcome& outcome) {
  Json out = Json::array();
  for (const MaterialId id : outcome.assembly.table.materials.ids()) {
    const Material& material = outcome.assembly.table.materials[id];
    const MaterialReport& report = outcome.report.materials[id];
    out.push_back({{"name", material.name},
                   {"volume", report.volume},
                   {"mass", material.density ? Json(report.mass) : Json(nullptr)},
                   {"density", material.density ? Json(*material.density) : Json(nullptr)}});
  }
  return out;
}

Json outputs_json(const std::vector<Output>& outputs) {
  Json out = Json::array();
  for (const Output& output : outputs) out.push_back({{"format", output.format}, {"path", output.path.string()}});
  return out;
}

std::string solids_text(const SliceOutcome& outcome) {
  TextTable table({{"id", true},
                   {"solid"},
                   {"material"},
                   {"sliced [mm^3]", true},
                   {"exact [mm^3]", true},
                   {"difference", true},
                   {"status"}});
  for (const SolidId id : outcome.assembly.scene.solids.ids()) {
    const SolidReport& solid = outcome.report.solids[id];
    const double difference = 100.0 * (solid.volume_sliced - solid.volume_exact) / solid.volume_exact;
    const MaterialId material = outcome.assembly.table.assignments[id].material;
    table.add({std::to_string(id.value()), outcome.assembly.scene.solids[id].info.path,
               outcome.assembly.table.materials[material].name, short_number(solid.volume_sliced),
               short_number(solid.volume_exact), std::isfinite(difference) ? fmt::format("{:+.3f} %", difference) : "-",
               solid.left_out ? solid.status + ", left out" : solid.status});
  }
  return table.text();
}

std::string materials_text(const SliceOutcome& outcome) {
  TextTable table({{"material"}, {"volume [mm^3]", true}, {"mass [g]", true}});
  for (const MaterialId id : outcome.assembly.table.materials.ids()) {
    const Material& material = outcome.assembly.table.materials[id];
    const MaterialReport& report = outcome.report.materials[id];
    table.add({material.name, short_number(report.volume), material.density ? short_number(report.mass) : "-"});
  }
  return table.text();
}

std::string pairs_text(const char* title, const SliceOutcome& outcome, const std::vector<PairReport>& pairs) {
  if (pairs.empty()) return "";
  TextTable table({{title}, {"and"}, {"volume [mm^3]", true}, {"largest depth [mm]", true}, {"layers", true}});
  const auto& solids = outcome.assembly.scene.solids;
  for (const PairReport& pair : pairs) {
    table.add({solids[pair.first].info.path, solids[pair.second].info.path, short_number(pair.volume),
               short_number(pair.largest_depth), std::to_string(pair.layers)});
  }
  return "\n" + table.text();
}

std::string contacts_text(const char* title, const SliceOutcome& outcome, const std::vector<ContactReport>& contacts) {
  if (contacts.empty()) return "";
  TextTable table({{title}, {"and"}, {"area [mm^2]", true}, {"largest gap [mm]", true}, {"layers", true}});
  const auto& solids = outcome.assembly.scene.solids;
  for (const ContactReport& contact : contacts) {
    table.add({solids[contact.first].info.path, solids[contact.second].info.path, short_number(contact.area),
               short_number(contact.largest_gap), std::to_string(contact.layers)});
  }
  return "\n" + table.text();
}

std::string doubts_text(const SliceReport& report) {
  const CastCounters& cast = report.cast;
  return fmt::format("rays: {}, unclosed {}, repaired {}; hits: {}, uncertain {}; segments: {}\n", report.rays,
                     cast.unclosed_rays, cast.repaired_rays, cast.hits, cast.uncertain_hits, report.segments);
}

}  // namespace

std::string lattice_text(const LayerPlan& plan) {
  const Grid& grid = plan.grid;
  const auto layers = plan.layers.size();
  return fmt::format(
      "lattice: {} x {} x {} voxels of {:.6g} x {:.6g} x {:.6g} mm from ({:.6g}, {:.6g}, {:.6g}) mm, {} layers, {} "
      "rays",
      grid.size[0], grid.size[1], grid.size[2], grid.pitch.x(), grid.pitch.y(), grid.pitch.z(), grid.origin.x(),
      grid.origin.y(), grid.origin.z(), layers, layers * static_cast<std::uint64_t>(grid.size[1]));
}

Json grid_json(const Grid& grid) {
  return {{"origin", json_of(grid.origin)}, {"pitch", json_of(grid.pitch)}, {"size", grid.size}};
}

Json timing_json(const Timing& timing) {
  return {{"read", timing.read},
          {"prepare", timing.prepare},
          {"slice", timing.slice},
          {"write", timing.write},
          {"total", timing.total}};
}

long long peak_memory() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return 1024LL * usage.ru_maxrss;  // Linux counts kibibytes
}

Json slice_json(const SliceOutcome& outcome) {
  const SliceReport& report = outcome.report;
  Json out{{"grid", grid_json(outcome.plan.grid)},
           {"layers", report.layers},
           {"rows", report.rows},
           {"rays", report.rays},
           {"hits", report.cast.hits},
           {"segments", report.segments},
           {"unclosed_rays", report.cast.unclosed_rays},
           {"repaired_rays", report.cast.repaired_rays},
           {"uncertain_hits", report.cast.uncertain_hits},
           {"solids", solids_json(outcome)},
           {"materials", materials_json(outcome)},
           {"overlaps", pairs_json(report.overlaps)},
           {"gaps", pairs_json(report.gaps)},
           {"interfaces", contacts_json(report.interfaces, false)},
           {"open_gaps", contacts_json(report.open_gaps, true)},
           {"timing", timing_json(outcome.timing)},
           {"peak_memory_bytes", peak_memory()},
           {"within_budget", report.within_budget()},
           {"warnings", json_of(report.findings)},
           {"outputs", outputs_json(outcome.outputs)}};
  if (!outcome.adaptive.is_null()) out["adaptive"] = outcome.adaptive;
  return out;
}

std::string slice_text(const SliceOutcome& outcome) {
  std::string out = "\n" + solids_text(outcome) + "\n" + materials_text(outcome);
  out += pairs_text("overlap of", outcome, outcome.report.overlaps);
  out += pairs_text("gap between", outcome, outcome.report.gaps);
  out += contacts_text("interface of", outcome, outcome.report.interfaces);
  out += contacts_text("open gap between", outcome, outcome.report.open_gaps);
  out += "\n" + doubts_text(outcome.report);
  const Timing& t = outcome.timing;
  out += fmt::format("time: {:.2f} s (read {:.2f}, prepare {:.2f}, slice {:.2f}, of which write {:.2f}); memory: {}\n",
                     t.total, t.read, t.prepare, t.slice, t.write, short_bytes(static_cast<double>(peak_memory())));
  for (const Output& output : outcome.outputs) {
    double bytes = 0.0;
    for (const WrittenFile& file : list_files(output.path)) bytes += static_cast<double>(file.bytes);
    out += fmt::format("{}: {} ({})\n", output.format, printable(output.path.string()), short_bytes(bytes));
  }
  return out;
}

}  // namespace lamella::apps
