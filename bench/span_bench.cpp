// How fast the span engine finds the crossings of a raster lattice with exact solids, beside what a user would pick
// instead: OpenCASCADE's rays, and casters of triangles. One run, one thread, the same rows for all.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>

#include "bench/curves.h"
#include "bench/machine.h"
#include "bench/model_bench.h"
#include "bench/table.h"

namespace lamella::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModels[] = {"knot_tube.step", "wavy_block.step", "analytic_assembly.step", "impeller.step"};

/// Of the corpus: free-form, analytic, many small features, assemblies.
constexpr const char* kCorpus[] = {"free_c2d_curved_extrude.stp",   "mech_b123d_m6_1x12_countersunk_screw.step",
                                   "fusion_nw_poloidal_magnet.stp", "print_voron_brackets_1515_x2.step",
                                   "free_geouned_torus.stp",        "mech_elmer_pump_carter_sup.stp",
                                   "free_occt_trj10_b2_oc_214.stp", "nist_nist_nist_ftc_07_ap242_e2.stp",
                                   "elec_voron_fan_pcb_v1_0.step",  "fusion_geouned_rails.stp"};

/// The folder that an environment variable names, else one beside the source tree.
fs::path folder(const char* variable, const char* name) {
  if (const char* value = std::getenv(variable)) return value;
  return fs::path(LAMELLA_SOURCE_DIR).parent_path() / "shared" / name;
}

std::vector<fs::path> default_files() {
  std::vector<fs::path> files;
  for (const char* name : kModels) files.push_back(folder("LAMELLA_BENCH_DIR", "bench") / name);
  for (const char* name : kCorpus) files.push_back(folder("LAMELLA_STEP_DIR", "step") / name);
  return files;
}

struct Arguments {
  std::vector<fs::path> files;
  BenchOptions options;
  CurveOptions curve;
  fs::path json;
  std::string commit;
  bool table = false;
  bool curves = false;
};

void add_options(CLI::App& app, Arguments& arguments) {
  BenchOptions& options = arguments.options;
  app.add_option("files", arguments.files, "STEP files; default: the benchmark models and ten of the corpus");
  app.add_option("--json", arguments.json, "write everything measured to this file");
  app.add_flag("--table", arguments.table, "print the results as markdown");
  app.add_flag("--curves", arguments.curves, "instead: cost of the span engine against layers, rows and threads");
  app.add_option("--commit", arguments.commit, "noted in the results");
  app.add_option("--rows", options.rows, "rows a layer")->check(CLI::Range(1, 1'000'000))->capture_default_str();
  app.add_option("--layers", options.layers)->check(CLI::Range(1, 1'000'000))->capture_default_str();
  app.add_option("--rounds", options.rounds, "runs a peer; the median counts")->check(CLI::Range(1, 100));
  app.add_option("--least-seconds", options.measure.least_seconds, "CPU time of a run at least")->capture_default_str();
  app.add_option("--most-seconds", options.measure.most_seconds, "and at most; slower peers get a part of the layers");
  app.add_option("--sample-seconds", options.sample_seconds, "CPU time for the exact rows")->capture_default_str();
  app.add_option("--deflections", options.deflections, "of the tessellations, mm")->capture_default_str();
  app.add_option("--tessellation-cap", options.tessellation_cap, "CPU seconds")->capture_default_str();
  app.add_option("--mesh-cache", options.mesh_cache, "folder that keeps tessellations for the next run");
  app.add_option("--peers", options.peers, "only these: span span+combine reference occt contour dexel embree");
  app.add_option("--seed", options.measure.seed)->capture_default_str();
}

nlohmann::json measure(const Arguments& arguments, const fs::path& file) {
  if (!arguments.curves) return bench_model(file, arguments.options);
  CurveOptions curve = arguments.curve;
  curve.rows = arguments.options.rows;
  curve.layers = arguments.options.layers;
  curve.repeats = arguments.options.rounds;
  return measure_curves(file, curve);
}

/// Writes what there is so far, so that a run cut short has not been for nothing.
void write_json(const fs::path& path, const nlohmann::json& results) {
  if (path.empty()) return;
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
  std::ofstream stream(path);
  stream << results.dump(1) << '\n';
  if (!stream.flush()) throw std::runtime_error("can't write " + path.string());
}

void run(Arguments& arguments) {
  if (arguments.files.empty()) arguments.files = default_files();
  nlohmann::json results{{"machine", describe_machine(arguments.commit)}, {"models", nlohmann::json::array()}};
  for (const fs::path& file : arguments.files) {
    if (!fs::exists(file)) {
      std::fprintf(stderr, "%s: not there, left out\n", file.c_str());
      continue;
    }
    results["models"].push_back(measure(arguments, file));
    write_json(arguments.json, results);
  }
  if (arguments.table && !arguments.curves) std::cout << markdown_tables(results);
}

}  // namespace
}  // namespace lamella::bench

int main(int argc, char** argv) {
  CLI::App app("Measures the span engine beside its peers.");
  lamella::bench::Arguments arguments;
  lamella::bench::add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    lamella::bench::run(arguments);
    return 0;
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "span_bench: %s\n", failure.what());
    return 1;
  }
}
