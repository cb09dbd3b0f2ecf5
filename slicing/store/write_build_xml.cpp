#include <algorithm>
#include <array>
#include <cstdio>
#include <sstream>
#include <utility>

#include "core/xml_writer.h"
#include "slicing/rotation_words.h"
#include "slicing/store/build_file.h"
#include "slicing/store/build_words.h"

namespace lamella {

namespace {

std::string_view word_for(bool value) { return value ? "true" : "false"; }

void write_bounds(XmlWriter& xml, const Box3& box) {
  if (box.isEmpty()) return;
  xml.start("bounds");
  xml.attribute("x_min", box.min().x()).attribute("y_min", box.min().y()).attribute("z_min", box.min().z());
  xml.attribute("x_max", box.max().x()).attribute("y_max", box.max().y()).attribute("z_max", box.max().z()).end();
}

void write_sources(XmlWriter& xml, const BuildInfo& info) {
  xml.start("sources");
  for (const SourceFile& source : info.sources) {
    xml.start("source").attribute("path", source.path).attribute("schema", source.schema);
    xml.attribute("unit", source.unit).attribute("unit_in_mm", source.unit_in_mm);
    xml.attribute("sha256", source.sha256).end();
  }
  xml.end();
}

void write_materials(XmlWriter& xml, const BuildInfo& info) {
  xml.start("materials");
  for (const MaterialId id : info.materials.ids()) {
    const Material& material = info.materials[id];
    xml.start("material").attribute("id", id.value()).attribute("name", material.name);
    if (material.density) xml.attribute("density", *material.density);
    xml.attribute("red", material.color[0]).attribute("green", material.color[1]);
    xml.attribute("blue", material.color[2]);
    for (const MaterialId component : material.components)
      xml.start("component").attribute("id", component.value()).end();
    xml.end();
  }
  xml.end();
}

void write_solids(XmlWriter& xml, const BuildInfo& info) {
  xml.start("solids");
  for (const SolidId id : info.solids.ids()) {
    const BuildSolid& solid = info.solids[id];
    xml.start("solid").attribute("id", id.value()).attribute("name", solid.name).attribute("path", solid.path);
    xml.attribute("material", solid.material.value()).attribute("priority", solid.priority);
    xml.attribute("volume", solid.volume_exact);
    write_bounds(xml, solid.bounds);
    xml.end();
  }
  xml.end();
}

void write_plan(XmlWriter& xml, const BuildInfo& info) {
  const Grid& grid = info.plan.grid;
  xml.start("plan").attribute("overlap", name_of(info.policy)).start("grid");
  xml.attribute("origin_x", grid.origin.x()).attribute("origin_y", grid.origin.y());
  xml.attribute("origin_z", grid.origin.z());
  xml.attribute("pitch_x", grid.pitch.x()).attribute("pitch_y", grid.pitch.y()).attribute("pitch_z", grid.pitch.z());
  xml.attribute("size_x", grid.size[0]).attribute("size_y", grid.size[1]).attribute("size_z", grid.size[2]).end();
  if (info.plan.hatch) {
    xml.start("hatch").attribute("spacing", info.plan.hatch->spacing).attribute("angle", info.plan.hatch->angle);
    xml.attribute("rotation", info.plan.hatch->rotation).end();
  }
  if (info.plan.chord_error) {
    xml.start("contours").attribute("chord_error", *info.plan.chord_error);
    if (info.plan.curves) xml.attribute("curves", "true");
    xml.end();
  }
  xml.end();
}

void write_mixtures(XmlWriter& xml, const std::array<const char*, 3>& names, const MixtureEntry& entry) {
  if (entry.segments == 0) return;
  xml.attribute(names[0], entry.segments).attribute(names[1], entry.knots).attribute(names[2], entry.fractions);
}

void write_layer(XmlWriter& xml, std::size_t index, const LayerSpan& span, const LayerEntry& entry) {
  xml.start("layer").attribute("index", index).attribute("z_bottom", span.z_bottom);
  xml.attribute("z_sample", span.z_sample).attribute("z_top", span.z_top).attribute("segments", entry.segments);
  if (entry.has_hatch) {
    xml.attribute("hatch_rows", entry.hatch_rows).attribute("hatch_segments", entry.hatch_segments);
  }
  if (entry.contours) xml.attribute("loops", entry.contours->loops).attribute("points", entry.contours->points);
  if (entry.contours && entry.contours->curves > 0) xml.attribute("curves", entry.contours->curves);
  write_mixtures(xml, kMixtureNames, entry.mixtures);
  write_mixtures(xml, kHatchMixtureNames, entry.hatch_mixtures);
  xml.attribute("sha256", entry.sha256).end();
}

void write_layers(XmlWriter& xml, const BuildFile& build) {
  xml.start("layers").attribute("per_shard", build.layers_per_shard);
  for (std::size_t shard = 0; shard < build.shards.size(); ++shard) {
    xml.start("shard").attribute("file", shard_name(shard)).attribute("sha256", build.shards[shard].sha256);
    const std::size_t first = shard * build.layers_per_shard;
    const std::size_t last = std::min<std::size_t>(first + build.layers_per_shard, build.layers.size());
    for (std::size_t i = first; i < last; ++i) write_layer(xml, i, build.info.plan.layers[i], build.layers[i]);
    xml.end();
  }
  xml.end();
}

void write_pairs(XmlWriter& xml, std::string_view name, const std::vector<PairReport>& pairs) {
  for (const PairReport& pair : pairs) {
    xml.start(name).attribute("first", pair.first.value()).attribute("second", pair.second.value());
    xml.attribute("volume", pair.volume).attribute("layers", pair.layers);
    xml.attribute("largest_depth", pair.largest_depth).end();
  }
}

void write_contacts(XmlWriter& xml, std::string_view name, const std::vector<ContactReport>& contacts) {
  for (const ContactReport& contact : contacts) {
    xml.start(name).attribute("first", contact.first.value()).attribute("second", contact.second.value());
    xml.attribute("area", contact.area).attribute("volume", contact.volume);
    xml.attribute("least_gap", contact.least_gap).attribute("largest_gap", contact.largest_gap);
    xml.attribute("layers", contact.layers).end();
  }
}

void write_counters(XmlWriter& xml, const SliceReport& report) {
  xml.attribute("layers", report.layers).attribute("rows", report.rows).attribute("rays", report.rays);
  xml.attribute("segments", report.segments);
  const CastCounters& cast = report.cast;
  xml.start("casts").attribute("rays", cast.rays).attribute("hits", cast.hits).attribute("tie_rays", cast.tie_rays);
  xml.attribute("tolerance_rays", cast.tolerance_rays).attribute("repaired_rays", cast.repaired_rays);
  xml.attribute("unclosed_rays", cast.unclosed_rays).attribute("uncertain_hits", cast.uncertain_hits);
  xml.attribute("candidates", cast.candidates).attribute("iterations", cast.iterations).end();
}

void write_report(XmlWriter& xml, const SliceReport& report) {
  xml.start("report");
  write_counters(xml, report);
  for (const SolidId id : report.solids.ids()) {
    const SolidReport& solid = report.solids[id];
    xml.start("solid_result").attribute("id", id.value()).attribute("volume_sliced", solid.volume_sliced);
    xml.attribute("volume_exact", solid.volume_exact).attribute("quadrature_bound", solid.quadrature_bound);
    xml.attribute("left_out", word_for(solid.left_out)).attribute("status", solid.status).end();
  }
  for (const MaterialId id : report.materials.ids()) {
    const MaterialReport& material = report.materials[id];
    xml.start("material_result").attribute("id", id.value()).attribute("volume", material.volume);
    xml.attribute("mass", material.mass).end();
  }
  write_pairs(xml, "overlap", report.overlaps);
  write_pairs(xml, "gap", report.gaps);
  write_contacts(xml, "interface", report.interfaces);
  write_contacts(xml, "open_gap", report.open_gaps);
  for (const Finding& finding : report.findings) {
    xml.start("finding").attribute("severity", name_of(finding.severity)).attribute("solid", finding.solid);
    xml.attribute("face", finding.face).attribute("entity", finding.entity).attribute("what", finding.what);
    xml.attribute("hint", finding.hint).end();
  }
  xml.end();
}

void write_turn(XmlWriter& xml, const std::optional<Mat3>& turn) {
  if (!turn) return;
  xml.start("orientation");
  for (int i = 0; i < 9; ++i) xml.attribute(kTurnNames[i], (*turn)(i / 3, i % 3));
  xml.end();
}

std::string_view version_of(const BuildFile& build) {
  const BuildInfo& info = build.info;
  if (info.plan.curves) return kCurvesVersion;
  if (info.turn) return kTurnedVersion;
  if (info.plan.chord_error) return kContourVersion;
  return is_graded(info) ? kGradedVersion : kPlainVersion;
}

std::string numbered(const char* format, std::size_t number) {
  char text[48];
  std::snprintf(text, sizeof(text), format, number);
  return text;
}

}  // namespace

std::string shard_name(std::size_t shard) { return kShardFolder + numbered("/%06zu.h5", shard); }

std::string layer_group_name(std::size_t layer) { return numbered("layer_%06zu", layer); }

std::string write_build_xml(const BuildFile& build, bool is_complete) {
  std::ostringstream text;
  XmlWriter xml(text);
  xml.start("build")
      .attribute("xmlns", kBuildNamespace)
      .attribute("version", version_of(build))
      .attribute("complete", word_for(is_complete));
  xml.attribute("length_unit", "mm").attribute("angle_unit", "rad").attribute("mass_unit", "g");
  write_sources(xml, build.info);
  write_materials(xml, build.info);
  write_solids(xml, build.info);
  write_turn(xml, build.info.turn);
  write_plan(xml, build.info);
  if (is_complete) {
    write_layers(xml, build);
    write_report(xml, build.report);
  }
  xml.end();
  return std::move(text).str();
}

}  // namespace lamella
