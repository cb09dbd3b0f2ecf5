#include "apps/job.h"

#include <algorithm>
#include <cmath>

#include "apps/options.h"
#include "apps/outputs.h"
#include "core/error.h"
#include "materials/rule_fields.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

constexpr const char* kNamespace = "urn:lamella:job:1";

/// Runs `read`, whose complaints about an option's text become complaints about a place in the file.
auto at(const std::string& where, const auto& read) {
  try {
    return read();
  } catch (const UsageError& error) {
    const std::string name = error.where().starts_with("--") ? error.where().substr(2) : error.where();
    throw InputError(name + ": " + error.what(), where, error.hint());
  }
}

Vec3 read_vector(const XmlElement& element, const char* name, const Vec3& fallback) {
  if (!element.has(name)) return fallback;
  return at(element.where(), [&] { return parse_vector(name, element.attribute(name)); });
}

/// sin and cos of an angle in degrees, exact at multiples of 90.
Vec2 sin_cos(double degrees) {
  const double quarters = degrees / 90.0;
  if (quarters == std::round(quarters)) {
    constexpr std::array<double, 4> kSin{0.0, 1.0, 0.0, -1.0};
    const auto q = static_cast<std::size_t>(std::fmod(std::fmod(quarters, 4.0) + 4.0, 4.0));
    return {kSin[q], kSin[(q + 1) % 4]};
  }
  const double angle = degrees / 180.0 * kPi;
  return {std::sin(angle), std::cos(angle)};
}

/// Rodrigues' formula for the rotation about a unit axis.
Mat3 rotation(const Vec3& axis, double degrees) {
  const Vec2 sc = sin_cos(degrees);
  Mat3 cross;
  cross << 0.0, -axis.z(), axis.y(), axis.z(), 0.0, -axis.x(), -axis.y(), axis.x(), 0.0;
  const Mat3 along = axis * axis.transpose();
  return sc.y() * Mat3::Identity() + sc.x() * cross + (1.0 - sc.y()) * along;
}

/// turn="ax,ay,az,degrees"
Mat3 read_turn(const XmlElement& element) {
  if (!element.has("turn")) return Mat3::Identity();
  const auto values = at(element.where(), [&] { return parse_numbers("turn", element.attribute("turn"), 4); });
  const Vec3 axis(values[0], values[1], values[2]);
  const double length = axis.norm();
  if (!(length > 0.0) || !std::isfinite(length)) {
    throw InputError("the axis of the turn has no direction", element.where(),
                     "write turn=\"0,0,1,30\" for 30 degrees "
                     "about z");
  }
  return rotation(axis / length, values[3]);
}

std::array<std::size_t, 3> read_counts(const XmlElement& element) {
  const auto values = at(element.where(), [&] { return parse_numbers("counts", element.attribute("counts"), 3); });
  std::array<std::size_t, 3> counts{};
  for (std::size_t i = 0; i < 3; ++i) {
    const bool is_count =
        values[i] >= 1.0 && values[i] <= static_cast<double>(kMaxPlacements) && values[i] == std::round(values[i]);
    if (!is_count) throw InputError("counts must be whole numbers from 1", element.where(), "write counts=\"3,2,1\"");
    counts[i] = static_cast<std::size_t>(values[i]);
  }
  if (counts[0] * counts[1] > kMaxPlacements || counts[0] * counts[1] * counts[2] > kMaxPlacements) {
    throw InputError("more copies than a million", element.where(), "slice a part of them at a time");
  }
  return counts;
}

void add_tile(const XmlElement& element, std::vector<Motion>& out) {
  element.allow_only({"counts", "spacing", "shift", "turn"}, {});
  refuse_text(element);
  const std::array<std::size_t, 3> counts = read_counts(element);
  const Vec3 spacing = read_vector(element, "spacing", Vec3::Zero());
  for (int a = 0; a < 3; ++a) {
    if (counts[a] == 1 || spacing[a] != 0.0) continue;
    throw InputError("copies would lie in one place", element.where(), "give their distances: spacing=\"dx,dy,dz\"");
  }
  const Motion first{read_turn(element), read_vector(element, "shift", Vec3::Zero())};
  for (std::size_t k = 0; k < counts[2]; ++k) {
    for (std::size_t j = 0; j < counts[1]; ++j) {
      for (std::size_t i = 0; i < counts[0]; ++i) {
        const Vec3 step(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
        out.push_back({first.turn, first.shift + spacing.cwiseProduct(step)});
      }
    }
  }
}

std::vector<Motion> read_placements(const XmlElement& part) {
  std::vector<Motion> placements;
  for (const XmlElement& element : part.children()) {
    if (element.name() == "tile") {
      add_tile(element, placements);
    } else {
      element.allow_only({"shift", "turn"}, {});
      refuse_text(element);
      placements.push_back({read_turn(element), read_vector(element, "shift", Vec3::Zero())});
    }
  }
  if (placements.empty()) placements.emplace_back();
  return placements;
}

fs::path beside(const fs::path& job, const std::string& path) { return (job.parent_path() / path).lexically_normal(); }

StepPart read_part(const XmlElement& element, const fs::path& job) {
  element.allow_only({"file", "label"}, {"place", "tile"});
  const std::string file = element.attribute("file");
  if (file.empty()) throw InputError("file is empty", element.where(), "name a STEP file");
  StepPart part{beside(job, file), element.attribute_or("label", ""), read_placements(element)};
  if (element.has("label") && part.label.empty()) {
    throw InputError("label is empty", element.where(), "leave it out or fill it");
  }
  if (part.label.empty() && part.placements.size() > 1) part.label = part.file.stem().string();
  return part;
}

bool is_path(const std::string& name) {
  return name == "output" || name == "materials" || name == "machine" || name == "plan" || name == "adaptive-chart" ||
         find_format(name) != nullptr;
}

bool is_switch(const CLI::Option& option) { return option.get_expected_max() == 0; }

std::string read_switch(const XmlElement& element, const std::string& name) {
  const std::string text = element.attribute(name.c_str());
  if (text == "true" || text == "1") return "true";
  if (text == "false" || text == "0") return {};
  throw InputError(name + "=\"" + text + "\" is neither true nor false", element.where(), "write true or false");
}

/// The options that a job may have: all of the verb but those that are about the command line itself.
std::vector<const CLI::Option*> job_options(const CLI::App& slice) {
  std::vector<const CLI::Option*> options;
  for (const CLI::Option* option : slice.get_options()) {
    const std::string name = option->get_lnames().empty() ? "" : option->get_lnames().front();
    if (!name.empty() && name != "help" && name != "job") options.push_back(option);
  }
  return options;
}

/// An option's name as an attribute; names in XML don't begin with a digit.
std::string attribute_of(const CLI::Option& option) {
  const std::string& name = option.get_lnames().front();
  return name.front() >= '0' && name.front() <= '9' ? "_" + name : name;
}

void refuse_unknown_attributes(const XmlElement& element, const CLI::App& slice) {
  std::vector<std::string> known;
  for (const CLI::Option* option : job_options(slice)) known.push_back(attribute_of(*option));
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  for (const std::string& name : element.attributes()) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError("unknown option '" + name + "'", element.where(), "known: " + list);
  }
}

std::vector<Job::Option> read_options(const XmlElement& element, const fs::path& job, const CLI::App& slice) {
  refuse_unknown_attributes(element, slice);
  if (!element.children().empty()) throw InputError("<options> holds elements", element.where(), "write attributes");
  refuse_text(element);
  std::vector<Job::Option> options;
  for (const CLI::Option* option : job_options(slice)) {
    const std::string name = option->get_lnames().front();
    const std::string attribute = attribute_of(*option);
    if (!element.has(attribute.c_str())) continue;
    std::string value = is_switch(*option) ? read_switch(element, attribute) : element.attribute(attribute.c_str());
    if (is_switch(*option) && value.empty()) continue;
    if (is_path(name) && !value.empty()) value = beside(job, value).string();
    options.push_back({"--" + name, std::move(value), element.where()});
  }
  return options;
}

}  // namespace

Job read_job(const fs::path& file, const CLI::App& slice) {
  const XmlDocument document = XmlDocument::read(file);
  const XmlElement root = document.root("job");
  root.allow_only({"version"}, {"part", "options"});
  check_xml_head(root, kNamespace, "job");
  Job job;
  for (const XmlElement& element : root.children("part")) job.parts.push_back(read_part(element, file));
  if (job.parts.empty()) throw InputError("no <part>", root.where(), "name the STEP files to slice");
  const auto options = root.children("options");
  if (options.size() > 1) throw InputError("two <options>", options[1].where(), "put all into one");
  if (!options.empty() && root.children().back().name() != "options") {
    throw InputError("<options> comes before a <part>", options[0].where(), "put the options last");
  }
  if (!options.empty()) job.options = read_options(options[0], file, slice);
  return job;
}

void apply_job(const Job& job, CLI::App& slice, CommonOptions& common) {
  for (const Job::Option& option : job.options) {
    CLI::Option* target = slice.get_option(option.name);
    if (target->count() > 0) continue;
    target->add_result(option.value);
    if (option.name == "--json") common.json = true;
    if (option.name == "--quiet") common.quiet = true;
    if (option.name == "--threads") common.threads = option.value;
  }
}

}  // namespace lamella::apps
