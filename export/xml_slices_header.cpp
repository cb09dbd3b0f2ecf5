#include "export/xml_slices_header.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "export/build_check.h"
#include "export/xml_payload.h"
#include "export/xml_slices_format.h"
#include "model/move_scene.h"
#include "slicing/rotation_words.h"

namespace lamella::slices_xml {

namespace {

constexpr std::int64_t kMaxId = std::numeric_limits<std::int32_t>::max();

std::span<const double> span_of(const Vec3& v) { return {v.data(), 3}; }

Vec3 vector_of(const std::vector<double>& values) { return {values[0], values[1], values[2]}; }

/// A SHA-256 as hexadecimal digits, or nothing when it isn't known.
bool is_digest(const std::string& text) {
  return text.empty() || (text.size() == 64 && text.find_first_not_of("0123456789abcdef") == std::string::npos);
}

void write_sources(XmlWriter& xml, const std::vector<SourceFile>& sources) {
  xml.start("sources");
  for (const SourceFile& source : sources) {
    xml.start("source").attribute("path", source.path).attribute("schema", source.schema);
    xml.attribute("unit", source.unit).attribute("unit_in_mm", source.unit_in_mm);
    xml.attribute("sha256", source.sha256).end();
  }
  xml.end();
}

std::vector<SourceFile> read_sources(XmlStream& xml) {
  std::vector<SourceFile> sources;
  xml.enter("sources");
  while (xml.at("source")) {
    xml.enter("source", {"path", "schema", "unit", "unit_in_mm", "sha256"});
    sources.push_back({xml.attribute("path"), xml.attribute("schema"), xml.attribute("unit"), xml.number("unit_in_mm"),
                       xml.attribute("sha256")});
    if (!is_digest(sources.back().sha256)) xml.fail("attribute 'sha256' is not 64 lower-case hexadecimal digits");
    xml.leave();
  }
  xml.leave();
  return sources;
}

std::string components_text(const Material& material) {
  std::vector<std::uint32_t> ids;
  for (const MaterialId component : material.components) ids.push_back(component.value());
  return format_list(std::span<const std::uint32_t>(ids));
}

std::vector<MaterialId> read_components(XmlStream& xml) {
  std::vector<std::uint32_t> ids;
  try {
    parse_list(xml.attribute("components"), kMaxBlockItems, ids);
  } catch (const std::invalid_argument& error) {
    xml.fail(std::string("components: ") + error.what());
  }
  std::vector<MaterialId> components;
  for (const std::uint32_t id : ids) components.emplace_back(id);
  return components;
}

void write_materials(XmlWriter& xml, const IdVector<MaterialId, Material>& materials) {
  xml.start("materials");
  for (MaterialId id : materials.ids()) {
    const Material& material = materials[id];
    xml.start("material").attribute("id", id.value()).attribute("name", material.name);
    if (material.density) xml.attribute("density", *material.density);
    xml.attribute("color", std::span<const double>(material.color));
    if (material.is_graded()) xml.attribute("components", components_text(material));
    xml.end();
  }
  xml.end();
}

IdVector<MaterialId, Material> read_materials(XmlStream& xml) {
  IdVector<MaterialId, Material> materials;
  xml.enter("materials");
  while (xml.at("material")) {
    xml.enter("material", {"id", "name", "density", "color", "components"});
    const auto next = static_cast<std::int64_t>(materials.size());
    static_cast<void>(xml.integer("id", next, next));
    Material material;
    material.name = xml.attribute("name");
    if (xml.has("density")) material.density = xml.number("density");
    const auto color = xml.numbers("color", 3);
    std::copy(color.begin(), color.end(), material.color.begin());
    if (xml.has("components")) material.components = read_components(xml);
    materials.push_back(std::move(material));
    xml.leave();
  }
  xml.leave();
  return materials;
}

void write_solids(XmlWriter& xml, const IdVector<SolidId, BuildSolid>& solids) {
  xml.start("solids");
  for (SolidId id : solids.ids()) {
    const BuildSolid& solid = solids[id];
    xml.start("solid").attribute("id", id.value()).attribute("name", solid.name).attribute("path", solid.path);
    xml.attribute("material", solid.material.value()).attribute("priority", solid.priority);
    xml.attribute_if_finite("volume", solid.volume_exact);
    if (!solid.bounds.isEmpty()) {
      xml.attribute("lower", span_of(solid.bounds.min())).attribute("upper", span_of(solid.bounds.max()));
    }
    xml.end();
  }
  xml.end();
}

IdVector<SolidId, BuildSolid> read_solids(XmlStream& xml, std::int64_t materials) {
  IdVector<SolidId, BuildSolid> solids;
  xml.enter("solids");
  while (xml.at("solid")) {
    xml.enter("solid", {"id", "name", "path", "material", "priority", "volume", "lower", "upper"});
    const auto next = static_cast<std::int64_t>(solids.size());
    static_cast<void>(xml.integer("id", next, next));
    BuildSolid solid;
    solid.name = xml.attribute("name");
    solid.path = xml.attribute("path");
    solid.material = MaterialId{static_cast<std::size_t>(xml.integer("material", 0, materials - 1))};
    solid.priority = static_cast<int>(xml.integer("priority", std::numeric_limits<int>::min(), kMaxId));
    solid.volume_exact = xml.number_or_unknown("volume");
    if (xml.has("lower")) {
      solid.bounds = Box3(vector_of(xml.numbers("lower", 3)), vector_of(xml.numbers("upper", 3)));
    }
    solids.push_back(std::move(solid));
    xml.leave();
  }
  xml.leave();
  return solids;
}

Mat3 read_turn(XmlStream& xml) {
  xml.enter("orientation", {"rotation"});
  const std::vector<double> rows = xml.numbers("rotation", 9);
  Mat3 turn;
  for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = rows[static_cast<std::size_t>(i)];
  if (!is_rotation(turn)) xml.fail("attribute 'rotation' is no rotation");
  xml.leave();
  return turn;
}

void write_grid(XmlWriter& xml, const Grid& grid) {
  xml.start("grid").attribute("origin", span_of(grid.origin)).attribute("pitch", span_of(grid.pitch));
  xml.attribute("size",
                std::to_string(grid.size[0]) + " " + std::to_string(grid.size[1]) + " " + std::to_string(grid.size[2]));
  xml.end();
}

Grid read_grid(XmlStream& xml) {
  xml.enter("grid", {"origin", "pitch", "size"});
  Grid grid;
  grid.origin = vector_of(xml.numbers("origin", 3));
  grid.pitch = vector_of(xml.numbers("pitch", 3));
  const auto size = xml.numbers("size", 3);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!(size[axis] >= 1.0) || !(size[axis] <= static_cast<double>(kMaxId)))
      xml.fail("attribute 'size' is out of range");
    grid.size[axis] = static_cast<std::int64_t>(size[axis]);
  }
  if (grid.size[1] > kMaxRows) xml.fail("more than " + std::to_string(kMaxRows) + " rows a layer");
  xml.leave();
  return grid;
}

void write_plan(XmlWriter& xml, const LayerPlan& plan) {
  write_grid(xml, plan.grid);
  if (plan.hatch) {
    xml.start("hatch_lattice").attribute("spacing", plan.hatch->spacing);
    xml.attribute("angle", plan.hatch->angle).attribute("rotation", plan.hatch->rotation).end();
  }
  xml.start("plan").attribute("layers", plan.layers.size());
  const auto list = [&](const char* name, double LayerSpan::*member) {
    xml.start(name);
    std::vector<double> heights;
    for (const LayerSpan& layer : plan.layers) heights.push_back(layer.*member);
    xml.plain_text(format_list(std::span<const double>(heights))).end();
  };
  list("z_bottom", &LayerSpan::z_bottom);
  list("z_sample", &LayerSpan::z_sample);
  list("z_top", &LayerSpan::z_top);
  xml.end();
}

std::vector<double> read_heights(XmlStream& xml, std::string_view name, std::size_t count) {
  xml.enter(name);
  std::vector<double> heights;
  try {
    parse_list(xml.text(), count, heights);
  } catch (const std::invalid_argument& error) {
    xml.fail(error.what());
  }
  if (heights.size() != count) xml.fail("not as many heights as the plan has layers");
  xml.leave();
  return heights;
}

LayerPlan read_plan(XmlStream& xml) {
  LayerPlan plan;
  plan.grid = read_grid(xml);
  if (xml.at("hatch_lattice")) {
    xml.enter("hatch_lattice", {"spacing", "angle", "rotation"});
    plan.hatch = HatchLattice{xml.number("spacing"), xml.number("angle"), xml.number("rotation")};
    xml.leave();
  }
  xml.enter("plan", {"layers"});
  const auto count = static_cast<std::size_t>(xml.integer("layers", 0, kMaxId));
  const auto bottom = read_heights(xml, "z_bottom", count);
  const auto sample = read_heights(xml, "z_sample", count);
  const auto top = read_heights(xml, "z_top", count);
  xml.leave();
  for (std::size_t i = 0; i < count; ++i) plan.layers.push_back({bottom[i], sample[i], top[i]});
  return plan;
}

}  // namespace

void write_header(XmlWriter& xml, const BuildInfo& info) {
  xml.start("header").attribute("policy", kPolicies[static_cast<std::size_t>(info.policy)]);
  xml.start("units").attribute("length", "mm").attribute("angle", "rad").attribute("density", "g/cm3").end();
  write_sources(xml, info.sources);
  write_materials(xml, info.materials);
  write_solids(xml, info.solids);
  if (info.turn) xml.start("orientation").attribute("rotation", rotation_text(*info.turn)).end();
  write_plan(xml, info.plan);
  xml.end();
}

BuildInfo read_header(XmlStream& xml) {
  BuildInfo info;
  xml.enter("header", {"policy"});
  const auto policy = std::find(kPolicies.begin(), kPolicies.end(), xml.attribute("policy"));
  if (policy == kPolicies.end()) xml.fail("unknown policy '" + xml.attribute("policy") + "'");
  info.policy = static_cast<OverlapPolicy>(policy - kPolicies.begin());
  xml.enter("units", {"length", "angle", "density"});
  if (xml.attribute("length") != "mm" || xml.attribute("angle") != "rad" || xml.attribute("density") != "g/cm3") {
    xml.fail("units other than mm, rad and g/cm3");
  }
  xml.leave();
  info.sources = read_sources(xml);
  info.materials = read_materials(xml);
  info.solids = read_solids(xml, static_cast<std::int64_t>(info.materials.size()));
  if (xml.at("orientation")) info.turn = read_turn(xml);
  info.plan = read_plan(xml);
  xml.leave();
  if (const std::string fault = find_build_fault(info); !fault.empty()) xml.fail(fault);
  return info;
}

}  // namespace lamella::slices_xml
