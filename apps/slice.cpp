#include <algorithm>
#include <fmt/format.h>

#include "apps/assembly.h"
#include "apps/dry_run.h"
#include "apps/machine_options.h"
#include "apps/options.h"
#include "apps/slice_options.h"
#include "apps/slice_report.h"
#include "apps/stopwatch.h"
#include "apps/timed_sink.h"
#include "apps/verbs.h"
#include "core/atomic_file.h"
#include "slicing/slicer.h"

namespace lamella::apps {

namespace {

/// Solids that are left out count for the lattice too, so that it doesn't depend on --allow-open; but not where a
/// broken one claims to be larger than 1000 km.
constexpr double kFarthest = 1e9;  // mm

Box3 bounds_of(const Assembly& assembly) {
  Box3 bounds;
  for (const SolidId id : assembly.scene.solids.ids()) {
    const Box3& box = assembly.measures[id].bounds;
    if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) continue;
    const double reach = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).maxCoeff();
    if (reach <= kFarthest || is_sliceable(assembly.scene.solids[id].info)) bounds.extend(box);
  }
  return bounds;
}

void check_request(const SliceRequest& request) {
  std::vector<std::filesystem::path> places;
  for (const Output& output : request.outputs) places.push_back(output.path);
  std::vector<std::string> inputs;
  for (const StepPart& part : request.parts) inputs.push_back(part.file.string());
  if (request.job) inputs.push_back(*request.job);
  if (request.materials) inputs.push_back(*request.materials);
  if (request.machine) inputs.push_back(*request.machine);
  if (request.format.plan) inputs.push_back(*request.format.plan);
  refuse_inputs_as_outputs(places, inputs);
  for (const Output& output : request.outputs) check_writable(output);
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
  write_file_atomically(std::filesystem::path(request.build) / "run.json",
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

ExitCode finish(const Session& session, const SliceRequest& request, const SliceOutcome& outcome) {
  const ExitCode code = outcome.report.within_budget() ? ExitCode::ok : ExitCode::budget;
  write_run_file(session, request, outcome.timing, code);
  session.warn(outcome.report.findings);
  if (code != ExitCode::ok) {
    session.terminal().warn("the error budget is exceeded: the outputs are written but can't be fully trusted");
  }
  if (session.json()) session.print(with_accuracy(slice_json(outcome), outcome.accuracy));
  session.print(slice_text(outcome));
  return code;
}

ExitCode run(const Session& session, const SliceRequest& request) {
  const Stopwatch total;
  Stopwatch watch;
  Timing timing;
  check_request(request);
  Assembly assembly = read_assembly(session, request.parts, request.materials);
  assembly.table.policy = request.policy;
  require_solid(assembly.scene, request.slice.allow_open);
  timing.read = watch.lap();

  measure_assembly(session, assembly);
  const std::vector<SolidId> solids = choose_solids(assembly.scene, assembly.measures, request.slice.allow_open);
  PlanOptions plan_options = request.plan;
  std::optional<accuracy::LatticeChoice> choice;
  if (request.accuracy) {
    choice = apply_accuracy(session, assembly, solids, *request.accuracy, request.machine, plan_options);
  }
  const LayerPlan plan = plan_layers(bounds_of(assembly), plan_options);
  session.print(lattice_text(plan) + "\n");
  if (choice) session.print(accuracy_line(*choice) + "\n");
  const SlabEngine engine = make_engine(assembly.scene, assembly.measures, solids, request.slice, session.progress());
  timing.prepare = watch.lap();

  if (request.dry_run) {
    const Estimate estimate = estimate_run(session, request, assembly, plan, engine);
    if (session.json()) session.print(with_accuracy(estimate_json(estimate, plan), choice));
    session.print(estimate_text(estimate));
    return ExitCode::ok;
  }
  const SliceReport report = run_slicer(session, request, assembly, plan, engine, timing);
  timing.total = total.seconds();
  return finish(session, request, {assembly, plan, report, request.outputs, timing, choice});
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
      "  lamella slice grip.step -o build --machine datasets/machines/material_jetting.xml\n"
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
