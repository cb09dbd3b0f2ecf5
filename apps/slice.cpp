#include <algorithm>
#include <fmt/format.h>

#include "apps/adaptive_report.h"
#include "apps/assembly.h"
#include "apps/dry_run.h"
#include "apps/machine_options.h"
#include "apps/options.h"
#include "apps/orientation.h"
#include "apps/slice_options.h"
#include "apps/slice_report.h"
#include "apps/stopwatch.h"
#include "apps/timed_sink.h"
#include "apps/verbs.h"
#include "core/atomic_file.h"
#include "export/thickness_chart.h"
#include "slicing/adaptive/adaptive_plan.h"
#include "slicing/slicer.h"

namespace lamella::apps {

namespace {

std::vector<std::filesystem::path> places_of(const SliceRequest& request) {
  std::vector<std::filesystem::path> places;
  for (const Output& output : request.outputs) {
    const std::vector<std::filesystem::path> taken = places_of(output, request.format);
    places.insert(places.end(), taken.begin(), taken.end());
  }
  if (request.adaptive_chart) places.push_back(*request.adaptive_chart);
  return places;
}

void check_request(const SliceRequest& request) {
  std::vector<std::string> inputs;
  for (const StepPart& part : request.parts) inputs.push_back(part.file.string());
  if (request.job) inputs.push_back(*request.job);
  if (request.materials) inputs.push_back(*request.materials);
  if (request.machine) inputs.push_back(*request.machine);
  if (request.format.plan) inputs.push_back(*request.format.plan);
  refuse_inputs_as_outputs(places_of(request), inputs);
  for (const Output& output : request.outputs) check_writable(output);
  if (request.adaptive_chart) check_writable({"xml", *request.adaptive_chart});  // a file, as that is
}

/// What differs from run to run, beside build.xml, which does not.
void write_run_file(const Session& session, const SliceRequest& request, const Timing& timing, ExitCode code) {
  const Json run{{"program", "lamella"},
                 {"version", LAMELLA_VERSION},
                 {"arguments", session.arguments()},
                 {"threads", session.threads()},
                 {"exit_code", static_cast<int>(code)},
                 {"timing", timing_json(timing)},
                 {"peak_memory_bytes", peak_memory()}};
  write_file_atomically(std::filesystem::path(*request.build) / "run.json",
                        run.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

SliceReport run_slicer(const Session& session, const SliceRequest& request, const Assembly& assembly,
                       const LayerPlan& plan, const SlabEngine& engine, Timing& timing) {
  TeeSink tee;
  for (const Output& output : request.outputs) tee.add(make_sink(output, request.format));
  TimedSink timed(tee);
  const Stopwatch watch;
  SliceReport report = slice_with(engine, assembly.scene, assembly.table, assembly.measures, plan, request.slice, timed,
                                  session.progress());
  timing.slice = watch.seconds();
  timing.write = timed.seconds();
  return report;
}

/// Replaces the plan's layers by adaptive ones and says how they were chosen.
AdaptivePlan choose_layers(const Session& session, const SliceRequest& request, const Assembly& assembly,
                           std::span<const SolidId> solids, LayerPlan& plan) {
  AdaptivePlan adaptive =
      plan_adaptive_layers(assembly.scene, assembly.table, assembly.measures, solids, plan.grid.origin.z(),
                           *request.adaptive, session.progress(), session.threads());
  set_layers(plan, adaptive.layers);
  session.warn(adaptive_findings(adaptive, assembly));
  return adaptive;
}

void write_chart(const std::string& file, const AdaptivePlan& adaptive, const SliceRequest& request) {
  ThicknessChart chart;
  chart.borders.push_back(adaptive.layers.front().z_bottom);
  for (const LayerSpan& layer : adaptive.layers) chart.borders.push_back(layer.z_top);
  chart.deviations = adaptive.deviations;
  chart.tolerance = request.adaptive->deviation;
  chart.range = adaptive.range;
  for (const MetFeature& met : adaptive.features) (met.is_met ? chart.features : chart.missed).push_back(met.feature.z);
  chart.title =
      fmt::format("{}: {} layers, deviation at most {:.4g} mm", request.parts.front().file.filename().string(),
                  adaptive.layers.size(), adaptive.largest_deviation);
  write_file_atomically(file, draw_thickness(chart));
}

ExitCode finish(const Session& session, const SliceRequest& request, const SliceOutcome& outcome) {
  const ExitCode code = outcome.report.within_budget() ? ExitCode::ok : ExitCode::budget;
  if (request.build) write_run_file(session, request, outcome.timing, code);
  session.warn(outcome.report.findings);
  if (code != ExitCode::ok) {
    session.terminal().warn("the error budget is exceeded: the outputs are written but can't be fully trusted");
  }
  if (session.json()) {
    Json object = with_accuracy(slice_json(outcome), outcome.accuracy);
    if (request.slice.turn) object["rotation"] = json_of(*request.slice.turn);
    session.print(object);
  }
  session.print(slice_text(outcome));
  return code;
}

/// Turns the assembly as --orient asks, and says how.
void turn_assembly(const Session& session, Assembly& assembly, SliceRequest& request) {
  request.slice.turn = orient_assembly(session, assembly, *request.orient);
  measure_assembly(session, assembly);
}

ExitCode run(const Session& session, SliceRequest& request) {
  const Stopwatch total;
  Stopwatch watch;
  Timing timing;
  check_request(request);
  Assembly assembly = read_assembly(session, request.parts, request.materials);
  refuse_inputs_as_outputs(places_of(request), assembly.material_files);
  assembly.table.policy = request.policy;
  require_solid(assembly.scene, request.slice.allow_open);
  timing.read = watch.lap();

  measure_assembly(session, assembly);
  if (request.orient) turn_assembly(session, assembly, request);
  const std::vector<SolidId> solids = choose_solids(assembly.scene, assembly.measures, request.slice.allow_open);
  PlanOptions plan_options = request.plan;
  std::optional<accuracy::LatticeChoice> choice;
  if (request.accuracy && !request.adaptive) {
    choice = apply_accuracy(session, assembly, solids, *request.accuracy, request.machine, plan_options);
  }
  LayerPlan plan = plan_layers(bounds_of(assembly), plan_options);
  std::optional<AdaptivePlan> adaptive;
  if (request.adaptive) adaptive = choose_layers(session, request, assembly, solids, plan);
  if (request.accuracy && adaptive) {
    choice = adaptive_accuracy(session, assembly, solids, *request.accuracy, plan, adaptive->largest_deviation);
  }
  session.print(lattice_text(plan) + "\n");
  if (choice) session.print(accuracy_line(*choice) + "\n");
  if (adaptive) session.print(adaptive_text(*adaptive, assembly, request.adaptive->deviation));
  const Json adaptive_report = adaptive ? adaptive_json(*adaptive, assembly, request.adaptive->deviation) : Json();
  const SlabEngine engine = make_engine(assembly.scene, assembly.measures, solids, request.slice, session.progress());
  timing.prepare = watch.lap();

  if (request.dry_run) {
    const Estimate estimate = estimate_run(session, request, assembly, plan, engine);
    if (session.json()) {
      Json object = with_accuracy(estimate_json(estimate, plan), choice);
      if (adaptive) object["adaptive"] = adaptive_report;
      session.print(object);
    }
    session.print(estimate_text(estimate));
    return ExitCode::ok;
  }
  const SliceReport report = run_slicer(session, request, assembly, plan, engine, timing);
  if (request.adaptive_chart) write_chart(*request.adaptive_chart, *adaptive, request);
  timing.total = total.seconds();
  return finish(session, request, {assembly, plan, report, request.outputs, timing, choice, adaptive_report});
}

}  // namespace

void add_slice(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("slice", "the main job: STEP files in, material-labelled layers out");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("files", *files, "STEP files; several are one assembly")->type_name("FILE");
  add_slice_options(*verb);
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella slice grip.step -o build\n"
      "  lamella slice grip.step insert.step -o build --materials grip.xml --layer-height 0.1 --pitch 0.05\n"
      "  lamella slice grip.step -o build --dpi 600,300 --layer-height 0.027 --png images --vdb grip.vdb\n"
      "  lamella slice grip.step -o build --accuracy 0.05\n"
      "  lamella slice grip.step -o build --accuracy 0.05 --adaptive auto\n"
      "  lamella slice grip.step --png-indexed images            (no build kept)\n"
      "  lamella slice grip.step -o build --machine datasets/machines/material_jetting.xml\n"
      "  lamella slice grip.step -o build --adaptive 0.02 --adaptive-range 0.05,0.3 --adaptive-chart layers.svg\n"
      "  lamella slice grip.step -o build --hatch-spacing 0.4 --hatch-angle 45 --rotate-per-layer 90\n"
      "  lamella slice grip.step -o build --pitch 0.02 --dry-run\n"
      "  lamella slice --job tray.xml\n"
      "Exit code 0: done and trustworthy, 1: usage, 2: input, 3: done, but the error budget is exceeded, 4: an output\n"
      "could not be written, 130: cancelled.");
  verb->final_callback([verb, files, &common, &action] {
    action = [request = read_slice_request(*verb, *files, common)](const Session& session) mutable {
      request.slice.threads = session.threads();
      return run(session, request);
    };
  });
}

}  // namespace lamella::apps
