#include <algorithm>
#include <cmath>
#include <limits>

#include "core/xml.h"
#include "model/move_scene.h"
#include "slicing/rotation_words.h"
#include "slicing/store/build_file.h"
#include "slicing/store/build_words.h"

namespace lamella {

namespace {

[[noreturn]] void refuse(const XmlElement& element, const std::string& what, const std::string& hint = {}) {
  throw InputError(what, element.where(), hint.empty() ? "the build is damaged; slice again" : hint);
}

/// A whole number in [0, limit].
std::uint64_t count(const XmlElement& element, const char* name,
                    std::uint64_t limit = std::numeric_limits<long>::max()) {
  const long value = element.integer(name);
  if (value < 0 || static_cast<std::uint64_t>(value) > limit) {
    refuse(element, std::string(name) + " = " + std::to_string(value) + " is out of range");
  }
  return static_cast<std::uint64_t>(value);
}

bool flag(const XmlElement& element, const char* name) {
  const std::string value = element.attribute(name);
  if (value != "true" && value != "false") refuse(element, std::string(name) + " must be true or false");
  return value == "true";
}

double positive(const XmlElement& element, const char* name) {
  const double value = element.number(name);
  if (!(value > 0.0)) refuse(element, std::string(name) + " must be positive");
  return value;
}

std::string digest(const XmlElement& element) {
  const std::string text = element.attribute("sha256");
  const bool is_hex = text.find_first_not_of("0123456789abcdef") == std::string::npos;
  if (text.size() != 64 || !is_hex) refuse(element, "sha256 is not 64 lower-case hexadecimal digits");
  return text;
}

XmlElement only_child(const XmlElement& parent, std::string_view name) {
  if (const auto child = parent.child(name)) return *child;
  refuse(parent, "<" + std::string(name) + "> is missing");
}

/// Ids count from 0 in the order of the elements.
void check_id(const XmlElement& element, std::size_t expected) {
  if (count(element, "id") != expected) refuse(element, "ids must count up from 0");
}

void read_sources(const XmlElement& parent, BuildInfo& info) {
  parent.allow_only({}, {"source"});
  for (const XmlElement& element : parent.children()) {
    element.allow_only({"path", "schema", "unit", "unit_in_mm", "sha256"}, {});
    SourceFile source;
    source.path = element.attribute("path");
    source.schema = element.attribute("schema");
    source.unit = element.attribute("unit");
    source.unit_in_mm = positive(element, "unit_in_mm");
    source.sha256 = element.attribute("sha256");
    if (!source.sha256.empty()) source.sha256 = digest(element);
    info.sources.push_back(std::move(source));
  }
}

std::vector<MaterialId> read_components(const XmlElement& element) {
  std::vector<MaterialId> components;
  for (const XmlElement& child : element.children()) {
    child.allow_only({"id"}, {});
    components.emplace_back(count(child, "id", std::numeric_limits<std::int32_t>::max()));
  }
  return components;
}

/// Components are plain materials of the build.
void check_components(const XmlElement& parent, const BuildInfo& info) {
  for (const Material& material : info.materials) {
    for (const MaterialId component : material.components) {
      const bool is_plain = component.value() < info.materials.size() && !info.materials[component].is_graded();
      if (!is_plain) refuse(parent, "'" + material.name + "' is mixed of something that is no plain material");
    }
  }
}

void read_materials(const XmlElement& parent, BuildInfo& info) {
  parent.allow_only({}, {"material"});
  for (const XmlElement& element : parent.children()) {
    element.allow_only({"id", "name", "density", "red", "green", "blue"}, {"component"});
    check_id(element, info.materials.size());
    Material material;
    material.name = element.attribute("name");
    if (element.has("density")) material.density = element.number("density");
    material.color = {element.number("red"), element.number("green"), element.number("blue")};
    const bool is_color = std::all_of(material.color.begin(), material.color.end(),
                                      [](double part) { return part >= 0.0 && part <= 1.0; });
    if (!is_color) refuse(element, "red, green and blue must lie in [0, 1]");
    material.components = read_components(element);
    info.materials.push_back(std::move(material));
  }
  check_components(parent, info);
}

Box3 read_bounds(const XmlElement& element) {
  element.allow_only({"x_min", "y_min", "z_min", "x_max", "y_max", "z_max"}, {});
  const Vec3 lo(element.number("x_min"), element.number("y_min"), element.number("z_min"));
  const Vec3 hi(element.number("x_max"), element.number("y_max"), element.number("z_max"));
  if (!((hi - lo).minCoeff() >= 0.0)) refuse(element, "bounds are reversed");
  return {lo, hi};
}

void read_solids(const XmlElement& parent, BuildInfo& info) {
  parent.allow_only({}, {"solid"});
  for (const XmlElement& element : parent.children()) {
    element.allow_only({"id", "name", "path", "material", "priority", "volume"}, {"bounds"});
    check_id(element, info.solids.size());
    BuildSolid solid;
    solid.name = element.attribute("name");
    solid.path = element.attribute("path");
    if (info.materials.empty()) refuse(element, "a solid needs a material");
    solid.material = MaterialId{count(element, "material", info.materials.size() - 1)};
    const long priority = element.integer("priority");
    solid.priority = static_cast<int>(priority);
    if (solid.priority != priority) refuse(element, "priority is out of range");
    solid.volume_exact = element.number("volume");
    if (const auto bounds = element.child("bounds")) solid.bounds = read_bounds(*bounds);
    info.solids.push_back(std::move(solid));
  }
}

Mat3 read_turn(const XmlElement& element) {
  element.allow_only({kTurnNames[0], kTurnNames[1], kTurnNames[2], kTurnNames[3], kTurnNames[4], kTurnNames[5],
                      kTurnNames[6], kTurnNames[7], kTurnNames[8]},
                     {});
  Mat3 turn;
  for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = element.number(kTurnNames[i]);
  if (!is_rotation(turn)) refuse(element, "the orientation is no rotation");
  return turn;
}

Grid read_grid(const XmlElement& element) {
  element.allow_only(
      {"origin_x", "origin_y", "origin_z", "pitch_x", "pitch_y", "pitch_z", "size_x", "size_y", "size_z"}, {});
  Grid grid;
  grid.origin = {element.number("origin_x"), element.number("origin_y"), element.number("origin_z")};
  grid.pitch = {positive(element, "pitch_x"), positive(element, "pitch_y"), positive(element, "pitch_z")};
  const char* const names[] = {"size_x", "size_y", "size_z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.size[axis] = static_cast<std::int64_t>(count(element, names[axis], std::numeric_limits<std::int32_t>::max()));
    if (grid.size[axis] == 0) refuse(element, "the lattice has no voxel");
  }
  return grid;
}

void read_plan(const XmlElement& parent, BuildInfo& info) {
  parent.allow_only({"overlap"}, {"grid", "hatch", "contours"});
  const auto policy = value_named<OverlapPolicy>(parent.attribute("overlap"), kPolicyWords);
  if (!policy) refuse(parent, "unknown overlap policy '" + parent.attribute("overlap") + "'");
  info.policy = *policy;
  info.plan.grid = read_grid(only_child(parent, "grid"));
  if (const auto element = parent.child("hatch")) {
    element->allow_only({"spacing", "angle", "rotation"}, {});
    info.plan.hatch =
        HatchLattice{positive(*element, "spacing"), element->number("angle"), element->number("rotation")};
  }
  if (const auto element = parent.child("contours")) {
    element->allow_only({"chord_error", "curves"}, {});
    info.plan.chord_error = positive(*element, "chord_error");
    if (element->has("curves")) {
      if (element->attribute("curves") != "true") refuse(*element, "curves can only be true");
      info.plan.curves = true;
    }
  }
}

MixtureEntry read_mixtures(const XmlElement& element, const std::array<const char*, 3>& names) {
  if (!element.has(names[0])) return {};
  return {count(element, names[0]), count(element, names[1]), count(element, names[2])};
}

void read_layer(const XmlElement& element, BuildFile& build) {
  element.allow_only({"index", "z_bottom", "z_sample", "z_top", "segments", "hatch_rows", "hatch_segments", "loops",
                      "points", "curves", "sha256", kMixtureNames[0], kMixtureNames[1], kMixtureNames[2],
                      kHatchMixtureNames[0], kHatchMixtureNames[1], kHatchMixtureNames[2]},
                     {});
  if (count(element, "index") != build.layers.size()) refuse(element, "layers must count up from 0");
  const LayerSpan span{element.number("z_bottom"), element.number("z_sample"), element.number("z_top")};
  const bool is_contiguous = build.layers.empty() || build.info.plan.layers.back().z_top == span.z_bottom;
  if (!(span.z_bottom < span.z_sample && span.z_sample < span.z_top) || !is_contiguous) {
    refuse(element, "layer heights must ascend without gaps");
  }
  LayerEntry entry;
  entry.segments = count(element, "segments");
  entry.has_hatch = element.has("hatch_rows");
  if (entry.has_hatch) {
    entry.hatch_rows = count(element, "hatch_rows", std::numeric_limits<std::int32_t>::max());
    entry.hatch_segments = count(element, "hatch_segments");
  }
  if (entry.has_hatch != element.has("hatch_segments") || entry.has_hatch != build.info.plan.hatch.has_value())
    refuse(element, "hatch rows disagree with the plan");
  if (element.has("loops") != build.info.plan.chord_error.has_value())
    refuse(element, "contours disagree with the plan");
  if (element.has("curves") && !build.info.plan.curves) refuse(element, "curves disagree with the plan");
  if (element.has("loops")) {
    entry.contours = {count(element, "loops", std::numeric_limits<std::int32_t>::max()), count(element, "points"),
                      element.has("curves") ? count(element, "curves") : 0};
  }
  entry.mixtures = read_mixtures(element, kMixtureNames);
  if (entry.has_hatch) entry.hatch_mixtures = read_mixtures(element, kHatchMixtureNames);
  entry.sha256 = digest(element);
  build.info.plan.layers.push_back(span);
  build.layers.push_back(std::move(entry));
}

void read_layers(const XmlElement& parent, BuildFile& build) {
  parent.allow_only({"per_shard"}, {"shard"});
  build.layers_per_shard = static_cast<std::uint32_t>(count(parent, "per_shard", kMaxStoredLayers));
  if (build.layers_per_shard == 0) refuse(parent, "per_shard must be positive");
  for (const XmlElement& shard : parent.children()) {
    shard.allow_only({"file", "sha256"}, {"layer"});
    // Names are ours to choose: a build can't point at files outside its folder.
    if (shard.attribute("file") != shard_name(build.shards.size())) {
      refuse(shard, "shards must be named " + shard_name(0) + ", " + shard_name(1) + ", ...");
    }
    if (build.layers.size() != build.shards.size() * build.layers_per_shard) {
      refuse(shard, "the shard before this one is not full");
    }
    build.shards.push_back({digest(shard)});
    for (const XmlElement& layer : shard.children()) read_layer(layer, build);
    const std::size_t in_shard = build.layers.size() - (build.shards.size() - 1) * build.layers_per_shard;
    if (in_shard == 0 || in_shard > build.layers_per_shard) refuse(shard, "the shard has a wrong number of layers");
  }
  if (static_cast<std::int64_t>(build.layers.size()) != build.info.plan.grid.size[2]) {
    refuse(parent, "the number of layers disagrees with the lattice");
  }
}

PairReport read_pair(const XmlElement& element, std::size_t solid_count) {
  element.allow_only({"first", "second", "volume", "layers", "largest_depth"}, {});
  if (solid_count == 0) refuse(element, "a pair needs solids");
  PairReport pair;
  pair.first = SolidId{count(element, "first", solid_count - 1)};
  pair.second = SolidId{count(element, "second", solid_count - 1)};
  pair.volume = element.number("volume");
  pair.layers = count(element, "layers");
  pair.largest_depth = element.number_or("largest_depth", 0.0);
  return pair;
}

ContactReport read_contact(const XmlElement& element, std::size_t solid_count) {
  element.allow_only({"first", "second", "area", "volume", "least_gap", "largest_gap", "layers"}, {});
  if (solid_count == 0) refuse(element, "a pair needs solids");
  ContactReport contact;
  contact.first = SolidId{count(element, "first", solid_count - 1)};
  contact.second = SolidId{count(element, "second", solid_count - 1)};
  contact.area = element.number("area");
  contact.volume = element.number("volume");
  contact.least_gap = element.number("least_gap");
  contact.largest_gap = element.number("largest_gap");
  contact.layers = count(element, "layers");
  return contact;
}

CastCounters read_casts(const XmlElement& element) {
  element.allow_only({"rays", "hits", "tie_rays", "tolerance_rays", "repaired_rays", "unclosed_rays", "uncertain_hits",
                      "candidates", "iterations"},
                     {});
  CastCounters cast;
  cast.rays = count(element, "rays");
  cast.hits = count(element, "hits");
  cast.tie_rays = count(element, "tie_rays");
  cast.tolerance_rays = count(element, "tolerance_rays");
  cast.repaired_rays = count(element, "repaired_rays");
  cast.unclosed_rays = count(element, "unclosed_rays");
  cast.uncertain_hits = count(element, "uncertain_hits");
  cast.candidates = count(element, "candidates");
  cast.iterations = count(element, "iterations");
  return cast;
}

void read_solid_result(const XmlElement& element, SliceReport& report) {
  element.allow_only({"id", "volume_sliced", "volume_exact", "quadrature_bound", "left_out", "status"}, {});
  check_id(element, report.solids.size());
  SolidReport solid;
  solid.volume_sliced = element.number("volume_sliced");
  solid.volume_exact = element.number("volume_exact");
  solid.quadrature_bound = element.number("quadrature_bound");
  solid.left_out = flag(element, "left_out");
  solid.status = element.attribute("status");
  report.solids.push_back(std::move(solid));
}

Finding read_finding(const XmlElement& element) {
  element.allow_only({"severity", "solid", "face", "entity", "what", "hint"}, {});
  Finding finding;
  const auto severity = value_named<Severity>(element.attribute("severity"), kSeverityWords);
  if (!severity) refuse(element, "unknown severity");
  finding.severity = *severity;
  finding.solid = element.attribute("solid");
  finding.face = element.attribute("face");
  finding.entity = element.attribute("entity");
  finding.what = element.attribute("what");
  finding.hint = element.attribute("hint");
  return finding;
}

void read_material_result(const XmlElement& element, SliceReport& report) {
  element.allow_only({"id", "volume", "mass"}, {});
  check_id(element, report.materials.size());
  report.materials.push_back({element.number("volume"), element.number("mass")});
}

void read_report(const XmlElement& parent, BuildFile& build) {
  parent.allow_only({"layers", "rows", "rays", "segments"},
                    {"casts", "solid_result", "material_result", "overlap", "gap", "interface", "open_gap", "finding"});
  SliceReport& report = build.report;
  report.layers = count(parent, "layers");
  report.rows = count(parent, "rows");
  report.rays = count(parent, "rays");
  report.segments = count(parent, "segments");
  report.cast = read_casts(only_child(parent, "casts"));
  const std::size_t solid_count = build.info.solids.size();
  for (const XmlElement& element : parent.children()) {
    if (element.name() == "solid_result") read_solid_result(element, report);
    if (element.name() == "material_result") read_material_result(element, report);
    if (element.name() == "overlap") report.overlaps.push_back(read_pair(element, solid_count));
    if (element.name() == "gap") report.gaps.push_back(read_pair(element, solid_count));
    if (element.name() == "interface") report.interfaces.push_back(read_contact(element, solid_count));
    if (element.name() == "open_gap") report.open_gaps.push_back(read_contact(element, solid_count));
    if (element.name() == "finding") report.findings.push_back(read_finding(element));
  }
  if (report.solids.size() != solid_count || report.materials.size() != build.info.materials.size()) {
    refuse(parent, "the report must judge every solid and every material");
  }
}

void check_header(const XmlElement& root) {
  root.allow_only({"version", "complete", "length_unit", "angle_unit", "mass_unit"},
                  {"sources", "materials", "solids", "orientation", "plan", "layers", "report"});
  const std::string version = root.attribute("version");
  const bool is_known = version == kPlainVersion || version == kGradedVersion || version == kContourVersion ||
                        version == kTurnedVersion || version == kCurvesVersion;
  if (root.attribute_or("xmlns", "") != kBuildNamespace || !is_known) {
    refuse(root, "this is not version 1 of the build format", "read it with the version of Lamella that wrote it");
  }
  if (!flag(root, "complete")) refuse(root, "the build is unfinished", "slice again to complete it");
  if (root.attribute("length_unit") != "mm" || root.attribute("angle_unit") != "rad" ||
      root.attribute("mass_unit") != "g") {
    refuse(root, "units other than mm, rad and g");
  }
}

}  // namespace

BuildFile read_build_xml(const std::filesystem::path& path) {
  const XmlDocument document = XmlDocument::read(path);
  const XmlElement root = document.root("build");
  check_header(root);
  BuildFile build;
  read_sources(only_child(root, "sources"), build.info);
  read_materials(only_child(root, "materials"), build.info);
  read_solids(only_child(root, "solids"), build.info);
  if (const auto element = root.child("orientation")) build.info.turn = read_turn(*element);
  read_plan(only_child(root, "plan"), build.info);
  read_layers(only_child(root, "layers"), build);
  read_report(only_child(root, "report"), build);
  return build;
}

}  // namespace lamella
