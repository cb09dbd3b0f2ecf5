#include <cmath>
#include <sstream>

#include "apps/machine_options.h"
#include "apps/options.h"
#include "apps/orient_report.h"
#include "apps/outputs.h"
#include "apps/verbs.h"
#include "export/orient_page.h"
#include "export/output_file.h"

namespace lamella::apps {

namespace {

struct OrientVerb {
  std::vector<StepPart> parts;
  std::optional<std::string> materials;
  OrientRequest request;
  std::optional<std::string> page;  ///< file to write
};

void check_page(const OrientVerb& verb) {
  if (!verb.page) return;
  std::vector<std::string> inputs;
  for (const StepPart& part : verb.parts) inputs.push_back(part.file.string());
  if (verb.materials) inputs.push_back(*verb.materials);
  if (verb.request.machine) inputs.push_back(*verb.request.machine);
  refuse_inputs_as_outputs({*verb.page}, inputs);
  check_writable({"xml", *verb.page});
}

void write_page(const OrientVerb& verb, const Assembly& assembly, const OrientOutcome& outcome) {
  if (!verb.page) return;
  OrientPage page;
  for (const SourceFile& file : assembly.scene.files) page.source += (page.source.empty() ? "" : ", ") + file.path;
  for (const auto& [name, weight] : named_weights(verb.request.weights)) page.weights.emplace_back(name, weight);
  page.layer_height = outcome.layer_height;
  page.present_height = outcome.present_height;
  if (outcome.machine) page.machine = outcome.machine->name;
  for (const SurfaceSample& sample : outcome.judge->samples().samples) {
    const SolidId solid = assembly.scene.solid_of(sample.face);
    page.colors.push_back(assembly.table.materials[assembly.table.assignments[solid].material].color);
  }
  OutputFile file(*verb.page);
  write_orient_page(outcome.found, outcome.least, *outcome.judge, page, file.stream());
  file.commit();
}

ExitCode run(const Session& session, const OrientVerb& verb) {
  check_page(verb);
  Assembly assembly = read_assembly(session, verb.parts, verb.materials);
  if (verb.page) refuse_inputs_as_outputs({*verb.page}, assembly.material_files);
  require_solid(assembly.scene, false);
  measure_assembly(session, assembly);
  const OrientOutcome outcome = find_orientation(session, assembly, verb.request);
  session.warn(outcome.findings);
  write_page(verb, assembly, outcome);
  if (session.json()) session.print(orient_json(verb.request, outcome));
  session.print(orient_text(verb.request, outcome) + (verb.page ? "page: " + *verb.page + "\n" : ""));
  return outcome.found.candidates.front().fits ? ExitCode::ok : ExitCode::budget;
}

Vec3 parse_axis(const std::string& text) {
  if (text == "x") return Vec3::UnitX();
  if (text == "y") return Vec3::UnitY();
  if (text == "z") return Vec3::UnitZ();
  const Vec3 axis = parse_vector("--axis", text);
  const double length = axis.stableNorm();
  if (!(length > 0.0) || !std::isfinite(length))
    throw UsageError("'" + text + "' is no axis", "--axis", "x, y, z or a direction that isn't zero");
  return axis;
}

std::optional<AxisScan> read_scan(const CLI::App& verb, const std::vector<std::string>& axes) {
  const auto step = given(verb, "--step");
  if (axes.empty()) {
    if (step) throw UsageError("--step needs --axis", {}, "name the axes to turn about: --axis x --axis y");
    return std::nullopt;
  }
  AxisScan scan;
  for (const std::string& axis : axes) scan.axes.push_back(parse_axis(axis));
  if (step) scan.step = parse_positive("--step", *step);
  if (!(scan.step >= 1e-3 && scan.step <= 180.0))
    throw UsageError("'" + *step + "' isn't between 0.001 and 180 degrees", "--step", "1 is usual");
  return scan;
}

OrientVerb read_options(const CLI::App& verb, const std::vector<std::string>& files,
                        const std::vector<std::string>& axes) {
  OrientVerb options;
  for (const std::string& file : files) options.parts.push_back({file, {}});
  options.materials = given(verb, "--materials");
  options.request = read_orient_options(verb, "--weights", given(verb, "--weights").value_or("height"));
  OrientRequest& request = options.request;
  request.scan = read_scan(verb, axes);
  if (const auto height = given(verb, "--layer-height"))
    request.plan.layer_height = parse_positive("--layer-height", *height);
  request.machine = given(verb, "--machine");
  options.page = given(verb, "--page");
  apply_machine(request.machine, request.plan);
  if (const auto count = given(verb, "--count"))
    request.count = static_cast<std::size_t>(parse_whole("--count", *count, 1, 100));
  if (const auto samples = given(verb, "--samples"))
    request.samples = static_cast<std::size_t>(parse_whole("--samples", *samples, 100, 5'000'000));
  if (const auto gap = given(verb, "--gap")) {
    request.limits.gap = parse_positive("--gap", *gap);
    if (!(request.limits.gap >= 1e-12 && request.limits.gap < 1.0))
      throw UsageError("'" + *gap + "' isn't between 1e-12 and 1", "--gap", "1e-7 is usual");
  }
  return options;
}

}  // namespace

void add_orient(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("orient", "which way up: least height, support, steps, fit");
  auto files = std::make_shared<std::vector<std::string>>();
  auto axes = std::make_shared<std::vector<std::string>>();
  verb->add_option("files", *files, "STEP files; several are one assembly")->required()->type_name("FILE");
  add_value(*verb, "--weights",
            "what counts: height, layers, support, support_area, cusp, contact, tools (default: height)", "NAME=W,...");
  verb->add_option("--axis", *axes, "also the paper's scheme: turn about this axis (x, y, z or X,Y,Z), then the next")
      ->type_name("AXIS")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  add_value(*verb, "--step", "its steps, degree (default: 1)", "DEG");
  add_orient_options(*verb);
  add_value(*verb, "--layer-height", "mm (default: the machine's, else about 500 layers)", "MM");
  add_value(*verb, "--machine", "the machine that it has to fit in", "X.xml");
  add_value(*verb, "--materials", "materials and their rules, for tool changes", "M.xml");
  add_value(*verb, "--count", "orientations to show (default: 5)", "N");
  add_value(*verb, "--samples", "points of the surface that support and cusps are judged at (default: 20000)", "N");
  add_value(*verb, "--gap", "stop when the least height is proved to this, relative (default: 1e-7)", "GAP");
  add_value(*verb, "--page", "also a page to read, with pictures", "orient.html");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella orient grip.step\n"
      "  lamella orient grip.step --axis x --axis y --step 1\n"
      "  lamella orient grip.step --weights height=1,support=2,cusp=0.5 --layer-height 0.1\n"
      "  lamella orient grip.step --down '#123' --unsupported 'Seal*' --machine printer.xml --json\n"
      "Rotations turn the assembly from where the files place it, about the machine's origin: p -> R p. Exit code 3:\n"
      "no orientation fits in the machine.");
  verb->final_callback([verb, files, axes, &action] {
    action = [options = read_options(*verb, *files, *axes)](const Session& session) { return run(session, options); };
  });
}

}  // namespace lamella::apps
