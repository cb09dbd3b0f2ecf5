#include "export/view_header.h"

#include "export/json_text.h"
#include "materials/color.h"

namespace lamella {

namespace {

void write_vector(JsonText& json, const char* name, const Vec3& value) {
  json.key(name).open('[').number(value.x()).number(value.y()).number(value.z()).close(']');
}

/// Row by row.
void write_rotation(JsonText& json, const Mat3& turn) {
  json.key("rotation").open('[');
  for (int row = 0; row < 3; ++row) {
    json.open('[').number(turn(row, 0)).number(turn(row, 1)).number(turn(row, 2)).close(']');
  }
  json.close(']');
}

void write_grid(JsonText& json, const BuildInfo& info) {
  const Grid& grid = info.plan.grid;
  json.key("grid").open('{');
  write_vector(json, "origin", grid.origin);
  write_vector(json, "pitch", grid.pitch);
  json.key("size").open('[');
  for (const std::int64_t size : grid.size) json.integer(static_cast<std::uint64_t>(size));
  json.close(']').key("bits").integer(static_cast<std::uint64_t>(ViewScale(grid).bits())).close('}');
}

void write_hatch(JsonText& json, const BuildInfo& info) {
  if (!info.plan.hatch) return;
  const HatchScale scale(info.plan.grid);
  json.key("hatch").open('{').key("spacing").number(info.plan.hatch->spacing);
  json.key("angle").number(info.plan.hatch->angle).key("rotation").number(info.plan.hatch->rotation);
  json.key("unit").number(scale.unit);
  json.key("centre").open('[').number(scale.centre.x()).number(scale.centre.y()).close(']').close('}');
}

void write_materials(JsonText& json, const BuildInfo& info, const SliceReport& report) {
  json.key("materials").open('[');
  for (const MaterialId id : info.materials.ids()) {
    const Material& material = info.materials[id];
    json.open('{').key("name").text(material.name).key("color").text(format_color(material.color));
    if (material.density) json.key("density").number(*material.density);
    if (id.value() < report.materials.size()) {
      json.key("volume").number(report.materials[id].volume).key("mass").number(report.materials[id].mass);
    }
    if (material.is_graded()) {
      json.key("components").open('[');
      for (const MaterialId component : material.components) json.integer(component.value());
      json.close(']');
    }
    json.close('}');
  }
  json.close(']');
}

void write_solids(JsonText& json, const BuildInfo& info, const SliceReport& report) {
  json.key("solids").open('[');
  for (const SolidId id : info.solids.ids()) {
    const BuildSolid& solid = info.solids[id];
    json.open('{').key("name").text(solid.name).key("path").text(solid.path);
    json.key("material").integer(solid.material.value()).key("volume_exact").number(solid.volume_exact);
    if (id.value() < report.solids.size()) {
      json.key("volume_sliced").number(report.solids[id].volume_sliced);
      json.key("status").text(report.solids[id].status).key("left_out").truth(report.solids[id].left_out);
    }
    if (!solid.bounds.isEmpty()) {
      write_vector(json, "lower", solid.bounds.min());
      write_vector(json, "upper", solid.bounds.max());
    }
    json.close('}');
  }
  json.close(']');
}

/// Columns rather than objects: a page may have thousands of layers.
void write_layers(JsonText& json, const BuildInfo& info, const std::vector<ViewLayer>& layers) {
  const auto column = [&](const char* name, const auto& write_value) {
    json.key(name).open('[');
    for (const ViewLayer& layer : layers) write_value(layer);
    json.close(']');
  };
  const auto span_of = [&](const ViewLayer& layer) -> const LayerSpan& { return info.plan.layers[layer.index]; };
  json.key("layers").open('{').key("planned").integer(info.plan.layers.size());
  column("index", [&](const ViewLayer& layer) { json.integer(layer.index); });
  column("z_bottom", [&](const ViewLayer& layer) { json.number(span_of(layer).z_bottom); });
  column("z_sample", [&](const ViewLayer& layer) { json.number(span_of(layer).z_sample); });
  column("z_top", [&](const ViewLayer& layer) { json.number(span_of(layer).z_top); });
  column("segments", [&](const ViewLayer& layer) { json.integer(layer.segments); });
  if (info.plan.hatch) {
    column("hatch_first", [&](const ViewLayer& layer) { json.number(static_cast<double>(layer.hatch_first)); });
    column("hatch_rows", [&](const ViewLayer& layer) { json.integer(layer.hatch_rows); });
  }
  json.key("area").open('[');
  for (std::size_t m = 0; m < info.materials.size(); ++m) {
    json.open('[');
    for (const ViewLayer& layer : layers) json.short_number(layer.area[m]);
    json.close(']');
  }
  json.close(']').close('}');
}

void write_chunks(JsonText& json, const std::vector<ViewChunkSizes>& chunks, bool has_hatch) {
  json.key("chunks").open('[');
  for (const ViewChunkSizes& chunk : chunks) {
    json.open('{').key("layers").integer(chunk.layers).key("rows").integer(chunk.rows);
    json.key("segments").integer(chunk.segments).key("graded").integer(chunk.graded);
    json.key("knots").integer(chunk.knots).key("fractions").integer(chunk.fractions);
    if (has_hatch) {
      json.key("hatch_rows").integer(chunk.hatch_rows).key("hatch_segments").integer(chunk.hatch_segments);
    }
    json.close('}');
  }
  json.close(']');
}

void write_pairs(JsonText& json, const char* name, const std::vector<PairReport>& pairs) {
  json.key(name).open('[');
  for (const PairReport& pair : pairs) {
    json.open('{').key("solids").open('[').integer(pair.first.value()).integer(pair.second.value()).close(']');
    json.key("volume").number(pair.volume).key("layers").integer(pair.layers);
    json.key("largest_depth").number(pair.largest_depth).close('}');
  }
  json.close(']');
}

void write_contacts(JsonText& json, const char* name, const std::vector<ContactReport>& contacts) {
  json.key(name).open('[');
  for (const ContactReport& contact : contacts) {
    json.open('{').key("solids").open('[').integer(contact.first.value()).integer(contact.second.value()).close(']');
    json.key("area").number(contact.area).key("volume").number(contact.volume);
    json.key("least_gap").number(contact.least_gap).key("largest_gap").number(contact.largest_gap);
    json.key("layers").integer(contact.layers).close('}');
  }
  json.close(']');
}

void write_findings(JsonText& json, const SliceReport& report) {
  json.key("findings").open('[');
  for (const Finding& finding : report.findings) {
    const char* word = finding.severity == Severity::error     ? "error"
                       : finding.severity == Severity::warning ? "warning"
                                                               : "note";
    json.open('{').key("severity").text(word).key("solid").text(finding.solid).key("face").text(finding.face);
    json.key("entity").text(finding.entity).key("what").text(finding.what).key("hint").text(finding.hint).close('}');
  }
  json.close(']');
}

void write_report(JsonText& json, const SliceReport& report) {
  json.key("report").open('{').key("within_budget").truth(report.within_budget());
  json.key("rays").integer(report.rays).key("segments").integer(report.segments);
  json.key("repaired_rays").integer(report.cast.repaired_rays);
  json.key("unclosed_rays").integer(report.cast.unclosed_rays);
  json.key("uncertain_hits").integer(report.cast.uncertain_hits);
  write_pairs(json, "overlaps", report.overlaps);
  write_pairs(json, "gaps", report.gaps);
  write_contacts(json, "interfaces", report.interfaces);
  write_contacts(json, "open_gaps", report.open_gaps);
  write_findings(json, report);
  json.close('}');
}

}  // namespace

std::string view_header(const BuildInfo& info, const SliceReport& report, const std::vector<ViewLayer>& layers,
                        const std::vector<ViewChunkSizes>& chunks) {
  JsonText json;
  json.open('{').key("sources").open('[');
  for (const SourceFile& source : info.sources) json.text(source.path);
  json.close(']');
  if (info.turn) write_rotation(json, *info.turn);
  write_grid(json, info);
  write_hatch(json, info);
  write_materials(json, info, report);
  write_solids(json, info, report);
  write_layers(json, info, layers);
  write_chunks(json, chunks, info.plan.hatch.has_value());
  write_report(json, report);
  json.close('}');
  return json.str();
}

}  // namespace lamella
