// How fast the span engine finds the crossings of a raster lattice with exact solids, beside what a user would pick
// instead: OpenCASCADE's rays, and casters of triangles. One run, one thread, the same rows for all.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <fstream>
#include <iostream>

#include "bench/model_bench.h"

namespace lamella::bench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kModels[] = {"knot_tube.step", "wavy_block.step", "analytic_assembly.step", "impeller.step"};

/// Of the corpus: free-form, analytic, many small features, assemblies.
constexpr const char* kCorpus[] = {"free_c2d_curved_extrude.stp",   "mech_b123d_m6_1x12_countersunk_screw.step",
                                   "fusion_nw_poloidal_magnet.stp", "mech_elmer_bent_waveguide.step",
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
  fs::path json;
  std::string commit;
};

void add_options(CLI::App& app, Arguments& arguments) {
  BenchOptions& options = arguments.options;
  app.add_option("files", arguments.files, "STEP files; default: the benchmark models and ten of the corpus");
  app.add_option("--json", arguments.json, "write everything measured to this file");
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

int run(Arguments& arguments) {
  if (arguments.files.empty()) arguments.files = default_files();
  nlohmann::json results;
  results["models"] = nlohmann::json::array();
  for (const fs::path& file : arguments.files) {
    if (!fs::exists(file)) {
      std::fprintf(stderr, "%s: not there, left out\n", file.c_str());
      continue;
    }
    results["models"].push_back(bench_model(file, arguments.options));
  }
  if (!arguments.json.empty()) std::ofstream(arguments.json) << results.dump(1) << '\n';
  return 0;
}

}  // namespace
}  // namespace lamella::bench

int main(int argc, char** argv) {
  CLI::App app("Measures the span engine beside its peers.");
  lamella::bench::Arguments arguments;
  lamella::bench::add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  try {
    return lamella::bench::run(arguments);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "span_bench: %s\n", failure.what());
    return 1;
  }
}
