#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <string_view>

#include "core/xml_parts.h"
#include "materials/color.h"
#include "model/move_scene.h"
#include "slicing/plan/build_plan.h"
#include "slicing/plan/plan_words.h"
#include "slicing/rotation_words.h"

namespace lamella {

namespace {

[[noreturn]] void refuse(const XmlElement& element, const std::string& what) {
  throw InputError(what, element.where(), "make the plan again with lamella plan");
}

std::string tag(std::string_view name) {
  std::string text = "<";
  text.append(name).append(">");
  return text;
}

double not_negative(const XmlElement& element, const char* name) {
  const double value = element.number(name);
  if (value < 0.0) refuse(element, std::string(name) + " is negative");
  return value;
}

double not_negative_or_0(const XmlElement& element, const char* name) {
  return element.has(name) ? not_negative(element, name) : 0.0;
}

/// A count that is no more than `most`.
std::uint64_t count(const XmlElement& element, const char* name, std::uint64_t most) {
  const long value = element.integer(name);
  if (value < 0 || static_cast<std::uint64_t>(value) > most) {
    refuse(element, std::string(name) + "=\"" + element.attribute(name) + "\" is out of range");
  }
  return static_cast<std::uint64_t>(value);
}

constexpr std::uint64_t kMany = std::uint64_t{1} << 53;

std::optional<double> optional_number(const XmlElement& element, const char* name) {
  if (!element.has(name)) return std::nullopt;
  return not_negative(element, name);
}

bool flag(const XmlElement& element, const char* name) {
  const std::string word = element.attribute_or(name, "false");
  if (word != "true" && word != "false")
    refuse(element, std::string(name) + "=\"" + word + "\" is neither true nor false");
  return word == "true";
}

class PlanReader {
 public:
  explicit PlanReader(XmlParts& file) {
    const XmlElement root = file.root().root("plan");
    read_head(root);
    std::size_t place = 0;  // in kParts, of what may come next
    while (const auto part = file.next()) {
      const XmlElement element = part->root();
      place = find_place(element, place);
      read_part(element, kParts[place]);
      if (kParts[place] != "layer") ++place;
    }
    skip_optional(root, place, kParts.size() - 1);
    check_counts(root);
  }

  [[nodiscard]] BuildPlan take() { return std::move(plan_); }

 private:
  /// In this order; layers come last, as often as they like, the others once.
  static constexpr std::array<std::string_view, 6> kParts{"orientation", "tools",    "materials",
                                                          "support",     "findings", "layer"};

  static std::size_t find_place(const XmlElement& element, std::size_t least) {
    const auto found = std::find(kParts.begin(), kParts.end(), element.name());
    if (found == kParts.end()) refuse(element, "<plan> has an unknown element " + tag(element.name()));
    const auto place = static_cast<std::size_t>(found - kParts.begin());
    if (place < least) refuse(element, tag(element.name()) + " comes too late, or a second time");
    skip_optional(element, least, place);
    return place;
  }

  /// Refuses to leave out what must be there.
  static void skip_optional(const XmlElement& where, std::size_t from, std::size_t to) {
    for (std::size_t place = from; place < to; ++place) {
      if (kParts[place] == "orientation" || kParts[place] == "support") continue;
      refuse(where, "no " + tag(kParts[place]) + " above");
    }
  }

  void read_part(const XmlElement& element, std::string_view name) {
    if (name == "orientation") return read_turn(element);
    if (name == "support") return read_support(element);
    if (name == "layer") return read_layer(element);
    element.allow_only({}, {name == "tools" ? "tool" : name == "materials" ? "material" : "finding"});
    for (const XmlElement& child : element.children()) {
      if (name == "tools") read_tool(child);
      if (name == "materials") read_material(child);
      if (name == "findings") read_finding(child);
    }
  }

  void read_turn(const XmlElement& element) {
    element.allow_only({kTurnNames[0], kTurnNames[1], kTurnNames[2], kTurnNames[3], kTurnNames[4], kTurnNames[5],
                        kTurnNames[6], kTurnNames[7], kTurnNames[8]},
                       {});
    Mat3 turn;
    for (int i = 0; i < 9; ++i) turn(i / 3, i % 3) = element.number(kTurnNames[static_cast<std::size_t>(i)]);
    if (!is_rotation(turn)) refuse(element, "the orientation is no rotation");
    plan_.turn = turn;
  }

  void read_head(const XmlElement& root) {
    if (root.attribute_or("xmlns", "") != kPlanNamespace) refuse(root, "not a Lamella plan file");
    root.allow_only({"version",
                     "machine",
                     "technology",
                     "currency",
                     "lattice",
                     "width",
                     "layers",
                     "time",
                     "cost",
                     "tool_changes",
                     "tool_changes_bound",
                     "reloads",
                     "reloads_bound",
                     "matchings",
                     "matching_proved",
                     "change_time",
                     "reload_time",
                     "machine_cost",
                     "change_cost",
                     "fits",
                     "size_x",
                     "size_y",
                     "size_z"},
                    {});
    const std::string version = root.attribute("version");
    if (version != kPlanVersion && version != kTurnedPlanVersion && version != kWeighedPlanVersion)
      refuse(root, "version '" + root.attribute("version") + "' isn't known");
    plan_.machine = root.attribute("machine");
    plan_.technology = read_technology(root);
    plan_.currency = root.attribute("currency");
    const std::string lattice = root.attribute("lattice");
    if (lattice != "hatch" && lattice != "raster") refuse(root, "lattice '" + lattice + "' isn't known");
    plan_.by_hatch = lattice == "hatch";
    plan_.width = not_negative(root, "width");
    plan_.time = not_negative(root, "time");
    plan_.cost = not_negative(root, "cost");
    plan_.tool_changes = count(root, "tool_changes", kMany);
    plan_.tool_changes_bound = count(root, "tool_changes_bound", plan_.tool_changes);
    plan_.reloads = count(root, "reloads", kMany);
    plan_.reloads_bound = count(root, "reloads_bound", plan_.reloads);
    if (root.has("matchings") != root.has("matching_proved")) refuse(root, "matchings without matching_proved");
    if (root.has("matchings")) {
      plan_.matching = PlanMatching{count(root, "matchings", kMany), flag(root, "matching_proved")};
    }
    plan_.change_time = not_negative(root, "change_time");
    plan_.reload_time = not_negative(root, "reload_time");
    plan_.machine_cost = not_negative(root, "machine_cost");
    plan_.change_cost = not_negative(root, "change_cost");
    plan_.fits = flag(root, "fits");
    plan_.size = {not_negative(root, "size_x"), not_negative(root, "size_y"), not_negative(root, "size_z")};
  }

  static Technology read_technology(const XmlElement& root) {
    for (const Technology one :
         {Technology::material_jetting, Technology::vat, Technology::extrusion, Technology::powder_bed}) {
      if (root.attribute("technology") == name_of(one)) return one;
    }
    refuse(root, "technology '" + root.attribute("technology") + "' isn't known");
  }

  void read_tool(const XmlElement& element) {
    element.allow_only({"id", "name"}, {});
    if (plan_.tools.size() == kMaxTools) refuse(element, "over 32 tools");
    if (count(element, "id", kMaxTools) != plan_.tools.size()) refuse(element, "tool ids don't count from 0");
    plan_.tools.push_back(element.attribute("name"));
  }

  void read_material(const XmlElement& element) {
    element.allow_only(
        {"id", "name", "color", "tools", "density", "volume", "mass", "length", "time", "purge", "unsupported", "cost"},
        {});
    if (count(element, "id", kMany) != plan_.materials.size()) refuse(element, "material ids don't count from 0");
    PlanMaterial material;
    material.name = element.attribute("name");
    const auto color = parse_color(element.attribute("color"));
    if (!color) refuse(element, "no colour: '" + element.attribute("color") + "'");
    material.color = *color;
    std::istringstream tools(element.attribute("tools"));
    for (std::string word; tools >> word;) {
      const bool digits = word.size() < 3 && word.find_first_not_of("0123456789") == std::string::npos;
      if (!digits || std::stoul(word) >= plan_.tools.size()) refuse(element, "no tool '" + word + "'");
      material.tools.emplace_back(std::stoul(word));
    }
    material.density = optional_number(element, "density");
    material.volume = not_negative(element, "volume");
    material.mass = optional_number(element, "mass");
    material.length = not_negative(element, "length");
    material.time = not_negative(element, "time");
    material.purge = not_negative(element, "purge");
    material.unsupported = not_negative(element, "unsupported");
    material.cost = optional_number(element, "cost");
    plan_.materials.push_back(std::move(material));
  }

  void read_support(const XmlElement& element) {
    element.allow_only({"material", "volume", "cost"}, {});
    plan_.support = {element.attribute("material"), not_negative(element, "volume"), optional_number(element, "cost")};
  }

  void read_finding(const XmlElement& element) {
    element.allow_only({"severity", "layer", "material", "what", "hint"}, {});
    PlanFinding finding;
    const std::string word = element.attribute("severity");
    if (word != "note" && word != "warning" && word != "error") refuse(element, "severity '" + word + "' isn't known");
    finding.severity = word == "note" ? Severity::note : word == "warning" ? Severity::warning : Severity::error;
    if (element.has("layer")) finding.layer = static_cast<std::uint32_t>(count(element, "layer", UINT32_MAX - 1));
    finding.material = element.attribute_or("material", "");
    finding.what = element.attribute("what");
    finding.hint = element.attribute("hint");
    plan_.findings.push_back(std::move(finding));
  }

  void read_layer(const XmlElement& element) {
    element.allow_only({"index", "z_bottom", "z_top", "time"}, {"step"});
    PlanLayer layer;
    layer.index = static_cast<std::uint32_t>(count(element, "index", UINT32_MAX - 1));
    layer.z_bottom = element.number("z_bottom");
    layer.z_top = element.number("z_top");
    layer.time = not_negative(element, "time");
    const bool ascends = plan_.layers.empty() || layer.index > plan_.layers.back().index;
    if (!ascends || !(layer.z_top > layer.z_bottom)) refuse(element, "layers don't ascend");
    for (const XmlElement& step : element.children()) read_step(step, layer);
    plan_.layers.push_back(std::move(layer));
  }

  void read_step(const XmlElement& element, PlanLayer& layer) {
    element.allow_only(
        {"material", "tool", "change", "change_time", "reload", "time", "segments", "length", "travel", "area",
         "volume", "mass", "purge", "islands", "smallest", "shortest", "thin", "specks", "unsupported"},
        {});
    PlanStep step;
    step.material = MaterialId{read_id(element, "material", plan_.materials.size())};
    step.tool = ToolId{read_id(element, "tool", plan_.tools.size())};
    for (const PlanStep& other : layer.steps) {
      if (other.tool == step.tool || other.material == step.material) refuse(element, "a tool or material comes twice");
    }
    step.is_change = flag(element, "change");
    step.is_reload = flag(element, "reload");
    step.time = not_negative(element, "time");
    step.change_time = not_negative_or_0(element, "change_time");
    step.volume = not_negative(element, "volume");
    step.purge = not_negative_or_0(element, "purge");
    MaterialStatistics& s = step.statistics;
    s.material = step.material;
    s.segments = count(element, "segments", kMany);
    s.length = not_negative(element, "length");
    s.travel = not_negative(element, "travel");
    s.area = not_negative(element, "area");
    s.shortest = not_negative(element, "shortest");
    s.smallest = not_negative(element, "smallest");
    s.islands = static_cast<std::uint32_t>(count(element, "islands", UINT32_MAX));
    s.thin = not_negative_or_0(element, "thin");
    if (element.has("specks")) s.specks = static_cast<std::uint32_t>(count(element, "specks", UINT32_MAX));
    s.unsupported = not_negative_or_0(element, "unsupported");
    layer.steps.push_back(std::move(step));
  }

  static std::size_t read_id(const XmlElement& element, const char* name, std::size_t size) {
    if (size == 0) refuse(element, std::string("there is no ") + name);
    return count(element, name, size - 1);
  }

  /// The totals are those of the layers.
  void check_counts(const XmlElement& root) const {
    if (count(root, "layers", kMany) != plan_.layers.size()) refuse(root, "not as many layers as stated");
    std::uint64_t changes = 0;
    std::uint64_t reloads = 0;
    std::vector<double> volume(plan_.materials.size());
    double time = 0.0;
    for (const PlanLayer& layer : plan_.layers) {
      time += layer.time;
      for (const PlanStep& step : layer.steps) {
        changes += step.is_change ? 1 : 0;
        reloads += step.is_reload ? 1 : 0;
        volume[step.material.value()] += step.volume;
      }
    }
    const auto differ = [](double a, double b) { return std::abs(a - b) > 1e-9 * std::max({a, b, 1e-3}); };
    if (changes != plan_.tool_changes) refuse(root, "not as many tool changes as stated");
    if (reloads != plan_.reloads) refuse(root, "not as many reloads as stated");
    if (differ(time, plan_.time)) refuse(root, "the times of the layers don't add up to the time stated");
    for (std::size_t m = 0; m < volume.size(); ++m) {
      if (differ(volume[m], plan_.materials[m].volume)) {
        refuse(root, "the volumes of '" + plan_.materials[m].name + "' don't add up to the volume stated");
      }
    }
  }

  BuildPlan plan_;
};

}  // namespace

BuildPlan read_plan_xml(const std::filesystem::path& path) {
  XmlParts file(path, kMaxPlanBytes);
  return PlanReader(file).take();
}

}  // namespace lamella
