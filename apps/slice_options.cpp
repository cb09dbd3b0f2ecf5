#include "apps/slice_options.h"

#include <algorithm>

#include "apps/adaptive_options.h"
#include "apps/engine_options.h"
#include "apps/job.h"
#include "apps/machine_options.h"
#include "apps/options.h"
#include "core/error.h"
#include "slicing/accuracy/choose_lattice.h"

namespace lamella::apps {

namespace {

constexpr double kMmPerInch = 25.4;

/// mm, of contours that nobody gave a chord error.
constexpr const char* kChordError = "0.01";

/// One number for both axes, or two with a comma between, all positive.
Vec2 parse_one_or_two(const char* option, const std::string& text) {
  if (text.find(',') == std::string::npos) return Vec2::Constant(parse_positive(option, text));
  const std::vector<double> values = parse_numbers(option, text, 2);
  for (const double value : values) {
    if (!(value > 0.0)) throw UsageError("'" + text + "' is not more than zero", option, "give positive numbers");
  }
  return {values[0], values[1]};
}

std::optional<Vec2> read_pitch(const CLI::App& verb) {
  const auto pitch = given(verb, "--pitch");
  const auto dpi = given(verb, "--dpi");
  if (pitch && dpi) throw UsageError("--pitch and --dpi exclude each other", {}, "give one of them");
  if (pitch) return parse_one_or_two("--pitch", *pitch);
  if (dpi) return Vec2(Vec2::Constant(kMmPerInch).cwiseQuotient(parse_one_or_two("--dpi", *dpi)));
  return std::nullopt;
}

double radians(double degrees) { return degrees / 180.0 * kPi; }

std::optional<HatchLattice> read_hatch(const CLI::App& verb) {
  const auto spacing = given(verb, "--hatch-spacing");
  const auto angle = given(verb, "--hatch-angle");
  const auto rotation = given(verb, "--rotate-per-layer");
  if (!spacing) {
    if (angle || rotation) {
      throw UsageError(std::string(angle ? "--hatch-angle" : "--rotate-per-layer") + " needs --hatch-spacing", {},
                       "give the distance of the hatch rows in mm");
    }
    return std::nullopt;
  }
  HatchLattice hatch;
  hatch.spacing = parse_positive("--hatch-spacing", *spacing);
  if (angle) hatch.angle = radians(parse_number("--hatch-angle", *angle));
  if (rotation) hatch.rotation = radians(parse_number("--rotate-per-layer", *rotation));
  return hatch;
}

/// It decides what these options decide.
std::optional<double> read_accuracy(const CLI::App& verb) {
  const auto accuracy = given(verb, "--accuracy");
  if (!accuracy) return std::nullopt;
  for (const char* other : {"--pitch", "--dpi", "--layer-height"}) {
    if (!given(verb, other)) continue;
    throw UsageError(std::string("--accuracy and ") + other + " exclude each other", {}, "give one of them");
  }
  return parse_positive("--accuracy", *accuracy);
}

PlanOptions read_plan(const CLI::App& verb) {
  PlanOptions plan;
  if (const auto height = given(verb, "--layer-height")) plan.layer_height = parse_positive("--layer-height", *height);
  plan.pitch = read_pitch(verb);
  if (const auto origin = given(verb, "--origin")) plan.origin = parse_vector("--origin", *origin);
  plan.hatch = read_hatch(verb);
  return plan;
}

/// The chord error of contours, if they are asked for: by their option, or by a format that has them.
std::optional<double> read_contours(const CLI::App& verb, const SliceRequest& request) {
  const bool can_have = request.slice.engine == EngineKind::span && !request.slice.allow_open;
  // Without a number it is empty, or "true" in a job.
  if (const auto chord = given(verb, "--contours")) {
    if (request.slice.engine != EngineKind::span) {
      throw UsageError("only the span engine makes contours", "--contours", "leave out --engine reference");
    }
    return parse_positive("--contours", chord->empty() || *chord == "true" ? kChordError : *chord);
  }
  if (verb.count("--curves") > 0) {
    if (request.slice.engine != EngineKind::span) {
      throw UsageError("only the span engine makes contours", "--curves", "leave out --engine reference");
    }
    return parse_positive("--contours", kChordError);
  }
  for (const Output& output : request.outputs) {
    const Format* format = find_format(output.format);
    if (format == nullptr || format->contours == Contours::none) continue;
    if (format->contours == Contours::needed && request.slice.engine != EngineKind::span) {
      throw UsageError(output.format + " needs contours, which only the span engine makes", "--" + output.format,
                       "leave out --engine reference");
    }
    if (format->contours == Contours::needed || can_have) return parse_positive("--contours", kChordError);
  }
  return std::nullopt;
}

/// Lines across a row of pixels besides the row's own, if an output is a mean of them.
std::int64_t read_sub_rows(const CLI::App& verb, const SliceRequest& request) {
  const bool is_used = std::any_of(request.outputs.begin(), request.outputs.end(),
                                   [](const Output& output) { return output.format == "png-coverage"; });
  if (!is_used) {
    if (given(verb, "--coverage-rows")) {
      throw UsageError("only png-coverage has lines across a row", "--coverage-rows", "leave it out");
    }
    return 0;
  }
  return request.format.coverage_rows == 1 ? 0 : request.format.coverage_rows;
}

}  // namespace

void add_slice_options(CLI::App& verb) {
  add_value(verb, "-o,--output",
            "folder of the build (the layers, as HDF5 and XML); may be left out where another output is given",
            "BUILD");
  add_value(verb, "--job", "parts, placements and any of these options from a file", "J.xml");
  add_value(verb, "--layer-height", "mm (default: about 500 layers on the larger extent)", "MM");
  add_adaptive_options(verb);
  add_value(verb, "--pitch", "pitch of the raster, both axes or x,y (default: about 1000 rows)", "MM[,MM]");
  add_value(verb, "--dpi", "the same as dots per inch", "DPI[,DPI]");
  add_value(verb, "--accuracy", "pitch and layer height that keep voxels this close to the exact surface", "MM");
  add_value(verb, "--origin", "lower corner of the first voxel, mm (default: the lower bounds)", "X,Y,Z");
  add_value(verb, "--hatch-spacing", "also hatch rows at this distance", "MM");
  add_value(verb, "--hatch-angle", "of the first layer's hatch rows, degree", "DEG");
  add_value(verb, "--rotate-per-layer", "further angle of each layer's hatch rows, degree", "DEG");
  add_value(verb, "--contours", "also contours, this far from the exact sections (without a number: 0.01)", "[MM]")
      ->expected(0, 1);
  add_switch(verb, "--curves", "contours keep the curves that they are chords of, for --step");
  add_value(verb, "--materials", "materials and their rules (default: what the STEP file says)", "M.xml");
  add_value(verb, "--machine", "take pitch and layer height from a machine, where they aren't given", "X.xml");
  add_value(verb, "--orient", "turn the assembly first: height, or weights as lamella orient takes them", "SPEC");
  add_orient_options(verb);
  add_overlap_option(verb);
  add_value(verb, "--gap-tolerance", "solids within it touch (default: their faces' own tolerances, at least 1e-6)",
            "MM");
  add_switch(verb, "--allow-open", "slice open solids too, by winding number");
  for (const Format& format : available_formats()) {
    add_value(verb, "--" + std::string(format.name), "also write " + std::string(format.summary),
              format.is_folder ? "DIR" : "FILE");
  }
  add_format_options(verb);
  add_engine_options(verb, "span");
  add_switch(verb, "--dry-run", "only say how many layers, rows and rays, and estimate time, memory and bytes");
}

namespace {

std::vector<StepPart> parts_of(const std::vector<std::string>& files) {
  std::vector<StepPart> parts;
  for (const std::string& file : files) parts.push_back({file, {}});
  return parts;
}

/// What to slice, from the command line or the job.
std::vector<StepPart> read_parts(CLI::App& verb, const std::vector<std::string>& files, CommonOptions& common) {
  const auto file = given(verb, "--job");
  if (!file) {
    if (files.empty()) throw UsageError("files is required", {}, "name STEP files, or a job that does: --job J.xml");
    return parts_of(files);
  }
  Job job = read_job(*file, verb);
  apply_job(job, verb, common);
  return files.empty() ? std::move(job.parts) : parts_of(files);
}

/// Pitch, deviation and machine of adaptive layers from an accuracy.
void share_accuracy(double accuracy, bool is_open, SliceRequest& request) {
  AdaptiveOptions& adaptive = *request.adaptive;
  if (request.machine) adaptive.machine = read_machine(*request.machine);
  const accuracy::AdaptiveShare share =
      accuracy::share_accuracy(accuracy, is_open ? std::nullopt : std::optional<double>(adaptive.deviation),
                               adaptive.machine ? &*adaptive.machine : nullptr);
  request.plan.pitch = share.pitch;
  adaptive.deviation = share.deviation;
}

}  // namespace

SliceRequest read_slice_request(CLI::App& verb, const std::vector<std::string>& files, CommonOptions& common) {
  SliceRequest request;
  request.parts = read_parts(verb, files, common);
  request.job = given(verb, "--job");
  request.materials = given(verb, "--materials");
  request.build = given(verb, "--output");
  if (request.build) request.outputs.push_back({"store", *request.build});
  for (const Format& format : available_formats()) {
    const std::string name = format.name;
    if (const auto path = given(verb, "--" + name)) request.outputs.push_back({name, *path});
  }
  if (request.outputs.empty()) {
    throw UsageError("--output is required", {}, "name a folder for the build: -o BUILD; or any format: --png DIR");
  }
  request.format = read_format_options(verb);
  check_format_options(verb, request.format, request.outputs);
  request.plan = read_plan(verb);
  request.machine = given(verb, "--machine");
  request.adaptive = read_adaptive_options(verb);
  request.adaptive_chart = given(verb, "--adaptive-chart");
  request.accuracy = read_accuracy(verb);
  if (request.accuracy && request.adaptive) {
    share_accuracy(*request.accuracy, given(verb, "--adaptive") == "auto", request);
  } else if (!request.accuracy) {
    apply_machine(request.machine, request.plan, request.adaptive ? &*request.adaptive : nullptr);
  }
  if (const auto spec = given(verb, "--orient")) {
    request.orient = read_orient_options(verb, "--orient", *spec);
    request.orient->plan = request.plan;
    request.orient->machine = request.machine;
  } else {
    refuse_orient_options(verb);
  }
  request.policy = read_overlap_policy(verb);
  const EngineChoice choice = read_engine_options(verb);
  request.slice.engine = choice.engine.value_or(EngineKind::span);
  request.slice.reference = choice.reference;
  if (const auto gap = given(verb, "--gap-tolerance"))
    request.slice.gap_tolerance = parse_positive("--gap-tolerance", *gap);
  request.slice.allow_open = verb.count("--allow-open") > 0;
  request.plan.chord_error = read_contours(verb, request);
  request.plan.curves = verb.count("--curves") > 0;
  request.plan.sub_rows = read_sub_rows(verb, request);
  request.dry_run = verb.count("--dry-run") > 0;
  return request;
}

}  // namespace lamella::apps
