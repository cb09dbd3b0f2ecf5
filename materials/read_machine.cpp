#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/xml.h"
#include "materials/machine.h"
#include "materials/rule_fields.h"

namespace lamella {

namespace {

constexpr const char* kNamespace = "urn:lamella:machine:1";
constexpr double kMmPerInch = 25.4;
constexpr double kLargest = 1e9;  // of any number: no machine has more of anything

std::string in_quotes(const std::string& text) { return "'" + text + "'"; }

/// A number in [low, high], or the fallback when there is none. `unit` is for the hint.
double number_within(const XmlElement& element, const char* name, double low, double high, const char* unit,
                     std::optional<double> fallback = std::nullopt) {
  if (!element.has(name) && fallback) return *fallback;
  const double value = element.number(name);
  if (value >= low && value <= high) return value;
  throw InputError(std::string(name) + "=\"" + element.attribute(name) + "\" is out of range", element.where(),
                   std::string("give ") + unit + ", " + format_double(low) + " to " + format_double(high));
}

double positive(const XmlElement& element, const char* name, const char* unit,
                std::optional<double> fallback = std::nullopt) {
  return number_within(element, name, 1e-6, kLargest, unit, fallback);
}

double not_negative(const XmlElement& element, const char* name, const char* unit) {
  return number_within(element, name, 0.0, kLargest, unit, 0.0);
}

/// The value that a word stands for.
template <class Value>
Value read_word(const XmlElement& element, const char* name, const std::map<std::string, Value>& words) {
  const std::string text = element.attribute(name);
  const auto found = words.find(text);
  if (found != words.end()) return found->second;
  std::string known;
  for (const auto& [word, value] : words) known += (known.empty() ? "" : ", ") + word;
  throw InputError(std::string(name) + "=\"" + text + "\" isn't known", element.where(), "one of: " + known);
}

XmlElement required(const XmlElement& root, const char* name) {
  if (auto child = root.child(name)) return *child;
  throw InputError("no <" + std::string(name) + ">", root.where(), "add it; see docs/formats/machine.md");
}

const std::map<std::string, Technology> kTechnologies{{"material-jetting", Technology::material_jetting},
                                                      {"vat", Technology::vat},
                                                      {"extrusion", Technology::extrusion},
                                                      {"powder-bed", Technology::powder_bed}};
const std::map<std::string, PriceUnit> kPriceUnits{{"kg", PriceUnit::kilogram}, {"litre", PriceUnit::litre}};
const std::map<std::string, SupportFill> kFills{{"overhang", SupportFill::overhang}, {"box", SupportFill::box}};
const std::map<std::string, GcodeFlavor> kFlavors{{"marlin", GcodeFlavor::marlin},
                                                  {"reprapfirmware", GcodeFlavor::reprapfirmware},
                                                  {"klipper", GcodeFlavor::klipper}};

class MachineReader {
 public:
  explicit MachineReader(const XmlElement& root) {
    root.allow_only({"version", "name", "technology"}, {"volume", "raster", "layer", "deposition", "compensation",
                                                        "tools", "materials", "support", "cost", "gcode"});
    check_xml_head(root, kNamespace, "machine profile");
    machine_.name = read_name(root, "name");
    machine_.technology = read_word(root, "technology", kTechnologies);
    read_volume(required(root, "volume"));
    read_raster(required(root, "raster"));
    read_layer(required(root, "layer"));
    read_deposition(required(root, "deposition"));
    if (const auto element = root.child("compensation")) read_compensation(*element);
    read_tools(required(root, "tools"));
    if (const auto element = root.child("materials")) read_materials(*element);
    if (const auto element = root.child("support")) read_support(*element);
    if (const auto element = root.child("cost")) read_cost(*element);
    if (const auto element = root.child("gcode")) read_gcode(*element);
    check_exposures(root);
    check_tools(required(root, "tools"));
  }

  [[nodiscard]] Machine take() { return std::move(machine_); }

 private:
  void read_volume(const XmlElement& element) {
    element.allow_only({"x", "y", "z"}, {});
    refuse_text(element);
    machine_.volume = {positive(element, "x", "mm"), positive(element, "y", "mm"), positive(element, "z", "mm")};
  }

  /// Either two pitches in mm or two resolutions in dots per inch.
  void read_raster(const XmlElement& element) {
    element.allow_only({"pitch_x", "pitch_y", "dpi_x", "dpi_y"}, {});
    refuse_text(element);
    const bool in_mm = element.has("pitch_x") || element.has("pitch_y");
    const bool in_dpi = element.has("dpi_x") || element.has("dpi_y");
    if (in_mm == in_dpi) {
      throw InputError("<raster> needs pitches or resolutions", element.where(),
                       "give pitch_x and pitch_y in mm, or dpi_x and dpi_y");
    }
    const Vec2 given{positive(element, in_mm ? "pitch_x" : "dpi_x", in_mm ? "mm" : "dots per inch"),
                     positive(element, in_mm ? "pitch_y" : "dpi_y", in_mm ? "mm" : "dots per inch")};
    machine_.pitch = in_mm ? given : Vec2(Vec2::Constant(kMmPerInch).cwiseQuotient(given));
  }

  void read_layer(const XmlElement& element) {
    element.allow_only({"min", "max", "step", "default", "overhead"}, {});
    refuse_text(element);
    machine_.layer_min = positive(element, "min", "mm");
    machine_.layer_max = positive(element, "max", "mm");
    if (machine_.layer_max < machine_.layer_min) {
      throw InputError("max is less than min", element.where(), "swap them");
    }
    machine_.layer_step = not_negative(element, "step", "mm");
    machine_.layer_default = positive(element, "default", "mm");
    machine_.layer_overhead = not_negative(element, "overhead", "s");
    const std::string fault = layer_height_fault(machine_, machine_.layer_default);
    if (!fault.empty()) throw InputError("the default height doesn't fit: " + fault, element.where(), "change it");
  }

  void read_deposition(const XmlElement& element) {
    element.allow_only(
        {"width", "swath", "turn", "self_support", "first_layers", "acceleration", "travel_acceleration"}, {});
    refuse_text(element);
    machine_.width = positive(element, "width", "mm");
    machine_.turn = not_negative(element, "turn", "s");
    if (element.has("self_support")) machine_.self_support = number_within(element, "self_support", 0.0, 10.0, "mm");
    const long layers = element.integer_or("first_layers", 0);
    if (layers < 0 || layers > 1000000) {
      throw InputError("first_layers is out of range", element.where(), "give 0 to 1000000");
    }
    machine_.first_layers = static_cast<int>(layers);
    const bool sweeps = machine_.technology == Technology::material_jetting;
    if (sweeps != element.has("swath")) {
      throw InputError(sweeps ? "material jetting needs a swath" : "only material jetting has a swath", element.where(),
                       sweeps ? "give the width of a sweep in mm" : "remove it");
    }
    if (sweeps) machine_.swath = positive(element, "swath", "mm");
    machine_.acceleration = read_acceleration(element, "acceleration");
    machine_.travel_acceleration = read_acceleration(element, "travel_acceleration");
  }

  /// Nothing where it isn't stated. Where a tool or a material states one the machine has to, so that there is one for
  /// every move, and each can be given back after another.
  [[nodiscard]] std::optional<double> read_acceleration(const XmlElement& element, const char* name) const {
    if (!element.has(name)) return std::nullopt;
    const bool is_of_travel = std::string_view(name) == "travel_acceleration";
    if (machine_.technology == Technology::vat) {
      throw InputError("a vat machine moves nothing that is to be accelerated", element.where(),
                       "remove " + std::string(name));
    }
    if (is_of_travel && machine_.technology == Technology::material_jetting) {
      throw InputError("a machine that sweeps has no travels", element.where(), "remove travel_acceleration");
    }
    const double value = number_within(element, name, 1.0, kLargest, "mm/s^2");
    if (machine_.acceleration || (!is_of_travel && element.name() == "deposition")) return value;
    throw InputError(std::string(name) + " without the machine's own", element.where(),
                     "give <deposition> an acceleration, for the moves that state none");
  }

  void read_compensation(const XmlElement& element) {
    element.allow_only({"shrink_x", "shrink_y", "shrink_z", "width"}, {});
    refuse_text(element);
    const auto percent = [&](const char* name) {
      return number_within(element, name, -20.0, 50.0, "a percentage", 0.0) / 100.0;
    };
    machine_.shrink = {percent("shrink_x"), percent("shrink_y"), percent("shrink_z")};
    machine_.width_compensation = number_within(element, "width", -10.0, 10.0, "mm", 0.0);
  }

  void read_tools(const XmlElement& element) {
    element.allow_only({"change_time", "change_cost", "reload", "reload_time", "reload_cost", "reload_purge"},
                       {"tool", "change"});
    machine_.change_time = not_negative(element, "change_time", "s");
    machine_.change_cost = not_negative(element, "change_cost", "money");
    machine_.allows_reloading =
        element.has("reload") && read_word<bool>(element, "reload", {{"never", false}, {"between-layers", true}});
    machine_.reload_time = not_negative(element, "reload_time", "s");
    machine_.reload_cost = not_negative(element, "reload_cost", "money");
    machine_.reload_purge = not_negative(element, "reload_purge", "mm^3");
    for (const XmlElement& tool : element.children("tool")) read_tool(tool);
    if (machine_.tools.empty()) throw InputError("no tool", element.where(), "add a <tool>");
    for (const XmlElement& change : element.children("change")) {
      if (change.line() < element.children("tool").back().line()) {
        throw InputError("<change> comes before a <tool>", change.where(), "put the tools first");
      }
      read_change(change);
    }
  }

  void read_tool(const XmlElement& element) {
    element.allow_only(
        {"name", "speed", "travel", "purge", "layer_min", "layer_max", "acceleration", "travel_acceleration"},
        {"holds"});
    MachineTool tool;
    tool.name = read_name(element, "name");
    if (!tool_ids_.emplace(tool.name, ToolId{machine_.tools.size()}).second) {
      throw InputError("two tools have the name " + in_quotes(tool.name), element.where(), "give each its own");
    }
    if (machine_.tools.size() == kMaxTools) throw InputError("over 32 tools", element.where(), "leave some out");
    const bool moves = machine_.technology != Technology::vat;
    tool.speed = positive(element, "speed", "mm/s", moves ? std::nullopt : std::optional<double>(0.0));
    tool.travel = positive(element, "travel", "mm/s", tool.speed);
    tool.acceleration = read_acceleration(element, "acceleration");
    tool.travel_acceleration = read_acceleration(element, "travel_acceleration");
    tool.purge = not_negative(element, "purge", "mm^3");
    tool.layer_min = read_thickness(element, "layer_min");
    tool.layer_max = read_thickness(element, "layer_max");
    check_thicknesses(element, tool.layer_min, tool.layer_max);
    for (const XmlElement& holds : element.children("holds")) {
      holds.allow_only({"material"}, {});
      refuse_text(holds);
      tool.holds.push_back(read_glob(holds, "material"));
    }
    machine_.tools.push_back(std::move(tool));
  }

  ToolId read_tool_name(const XmlElement& element, const char* attribute) const {
    const std::string name = element.attribute(attribute);
    const auto found = tool_ids_.find(name);
    if (found != tool_ids_.end()) return found->second;
    std::string known;
    for (const MachineTool& tool : machine_.tools) known += (known.empty() ? "" : ", ") + tool.name;
    throw InputError("no tool has the name " + in_quotes(name), element.where(), "known: " + known);
  }

  void read_change(const XmlElement& element) {
    element.allow_only({"from", "to", "time", "purge"}, {});
    refuse_text(element);
    const ToolId from = read_tool_name(element, "from");
    const ToolId to = read_tool_name(element, "to");
    if (from == to) throw InputError("a change leads to the same tool", element.where(), "name two tools");
    const auto same = [&](const ToolChange& other) { return other.from == from && other.to == to; };
    if (std::any_of(machine_.changes.begin(), machine_.changes.end(), same)) {
      throw InputError("this change is given twice", element.where(), "leave one");
    }
    ToolChange change = machine_.change(from, to);
    if (element.has("time")) change.time = not_negative(element, "time", "s");
    if (element.has("purge")) change.purge = not_negative(element, "purge", "mm^3");
    machine_.changes.push_back(change);
  }

  void read_materials(const XmlElement& element) {
    element.allow_only({}, {"material"});
    for (const XmlElement& material : element.children("material")) read_settings(material);
  }

  void read_settings(const XmlElement& element) {
    element.allow_only({"match", "price", "per", "speed", "exposure", "first_exposure", "temperature", "flow",
                        "retraction", "retraction_speed", "layer_min", "layer_max", "acceleration"},
                       {});
    refuse_text(element);
    MaterialSettings one;
    one.match = read_glob(element, "match");
    const auto same = [&](const MaterialSettings& other) { return other.match == one.match; };
    if (std::any_of(machine_.settings.begin(), machine_.settings.end(), same)) {
      throw InputError("two materials match " + in_quotes(one.match), element.where(), "the first counts; leave one");
    }
    read_price(element, one.price, one.per);
    if (element.has("speed")) one.speed = positive(element, "speed", "mm/s");
    one.acceleration = read_acceleration(element, "acceleration");
    one.exposure = not_negative(element, "exposure", "s");
    one.first_exposure = element.has("first_exposure") ? not_negative(element, "first_exposure", "s") : one.exposure;
    one.temperature = number_within(element, "temperature", 0.0, 3000.0, "degrees Celsius", 0.0);
    one.flow = number_within(element, "flow", 0.01, 10.0, "a factor", 1.0);
    one.retraction = number_within(element, "retraction", 0.0, 100.0, "mm", 0.0);
    one.retraction_speed = positive(element, "retraction_speed", "mm/s", 30.0);
    one.layer_min = read_thickness(element, "layer_min");
    one.layer_max = read_thickness(element, "layer_max");
    check_thicknesses(element, one.layer_min, one.layer_max);
    machine_.settings.push_back(std::move(one));
  }

  static void read_price(const XmlElement& element, std::optional<double>& price, PriceUnit& per) {
    if (element.has("price") != element.has("per")) {
      throw InputError("price and per go together", element.where(), "write e.g. price=\"30\" per=\"kg\"");
    }
    if (!element.has("price")) return;
    price = not_negative(element, "price", "money");
    per = read_word(element, "per", kPriceUnits);
  }

  void read_support(const XmlElement& element) {
    element.allow_only({"material", "fill", "price", "per", "density"}, {});
    refuse_text(element);
    MachineSupport support;
    support.material = read_name(element, "material");
    if (element.has("fill")) support.fill = read_word(element, "fill", kFills);
    read_price(element, support.price, support.per);
    if (element.has("density")) support.density = number_within(element, "density", 1e-6, 100.0, "g/cm^3");
    machine_.support = std::move(support);
  }

  void read_cost(const XmlElement& element) {
    element.allow_only({"currency", "per_hour"}, {});
    refuse_text(element);
    machine_.currency = read_name(element, "currency");
    machine_.cost_per_hour = not_negative(element, "per_hour", "money");
  }

  void read_gcode(const XmlElement& element) {
    element.allow_only({"flavor", "filament_diameter", "bed_temperature", "extrusion", "rows", "purge_x", "purge_y"},
                       {});
    refuse_text(element);
    if (machine_.technology != Technology::extrusion) {
      throw InputError("<gcode> is for extrusion", element.where(), "remove it");
    }
    GcodeSettings gcode;
    gcode.flavor = read_word(element, "flavor", kFlavors);
    gcode.filament_diameter = number_within(element, "filament_diameter", 0.1, 20.0, "mm", 1.75);
    gcode.bed_temperature = number_within(element, "bed_temperature", 0.0, 500.0, "degrees Celsius", 0.0);
    if (element.has("extrusion")) {
      gcode.relative_extrusion = read_word<bool>(element, "extrusion", {{"relative", true}, {"absolute", false}});
    }
    if (element.has("rows")) {
      gcode.serpentine = read_word<bool>(element, "rows", {{"serpentine", true}, {"one-way", false}});
    }
    gcode.purge_at = {number_within(element, "purge_x", 0.0, machine_.volume.x(), "mm within the volume", 0.0),
                      number_within(element, "purge_y", 0.0, machine_.volume.y(), "mm within the volume", 0.0)};
    machine_.gcode = gcode;
  }

  /// A vat without an exposure would build in no time at all.
  void check_exposures(const XmlElement& root) const {
    if (machine_.technology != Technology::vat) return;
    const auto dark = [](const MaterialSettings& one) { return one.exposure <= 0.0; };
    if (machine_.settings.empty() || std::any_of(machine_.settings.begin(), machine_.settings.end(), dark)) {
      throw InputError("a vat machine needs an exposure for every material", root.where(),
                       "give <material match=\"*\" exposure=\"...\"/> in s");
    }
  }

  /// A tool whose range lies outside the machine's could never be used.
  void check_tools(const XmlElement& tools) const {
    const std::vector<XmlElement> elements = tools.children("tool");
    for (const ToolId tool : machine_.tools.ids()) {
      const Interval layers = machine_.layers_of(tool);
      if (layers.lo <= layers.hi) continue;
      throw InputError("the layers of the tool " + in_quotes(machine_.tools[tool].name) + " aren't the machine's",
                       elements[tool.value()].where(),
                       "the machine builds layers of " + format_double(machine_.layer_min) + " to " +
                           format_double(machine_.layer_max) + " mm: change layer_min and layer_max");
    }
  }

  Machine machine_;
  std::map<std::string, ToolId> tool_ids_;
};

}  // namespace

Machine read_machine(const std::filesystem::path& path) {
  const XmlDocument document = XmlDocument::read(path);
  Machine machine = MachineReader(document.root("machine")).take();
  machine.source = path.string();
  return machine;
}

}  // namespace lamella
