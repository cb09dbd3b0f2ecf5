#include "bench/model_bench.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>

#include "bench/child.h"
#include "bench/exact_sample.h"
#include "bench/mesh_peers.h"
#include "bench/occt_peer.h"
#include "bench/tessellation.h"

namespace lamella::bench {
namespace {

using Json = nlohmann::json;

void say(const std::string& text) { std::fprintf(stderr, "  %s\n", text.c_str()); }

/// Bytes of an earlier run's tessellation; empty for one that took too long.
std::optional<std::string> read_cache(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(stream), {});
}

/// The tessellation and what it took; none when it failed.
std::optional<ModelMesh> find_mesh(const std::filesystem::path& file, double deflection, const BenchOptions& options,
                                   Json& report) {
  const std::string key = deflection_key(deflection);
  const auto cache = options.mesh_cache / (file.filename().string() + "." + key + ".mesh");
  std::optional<std::string> bytes;
  if (!options.mesh_cache.empty()) bytes = read_cache(cache);
  report[key]["cached"] = bytes.has_value();
  if (!bytes) {
    bytes = run_in_child([&] { return to_bytes(tessellate(file, deflection)); }, options.tessellation_cap);
    if (!options.mesh_cache.empty()) {
      std::filesystem::create_directories(options.mesh_cache);
      std::ofstream(cache, std::ios::binary) << bytes.value_or("");
    }
  }
  if (!bytes || bytes->empty()) {
    report[key]["failed"] = "over " + std::to_string(options.tessellation_cap) + " s, or failed";
    say("tessellation at " + key + " mm failed");
    return std::nullopt;
  }
  ModelMesh mesh = mesh_from_bytes(*bytes);
  report[key]["seconds"] = mesh.seconds;
  report[key]["triangles"] = mesh.triangle_count();
  say(key + " mm: " + std::to_string(mesh.triangle_count()) + " triangles in " + std::to_string(mesh.seconds) + " s");
  return mesh;
}

std::vector<PeerEntry> exact_peers(const std::filesystem::path& file, const ExactModel& model, const Lattice& lattice) {
  return {{"span", "", [&] { return make_span_peer(model, lattice, false); }},
          {"span+combine", "", [&] { return make_span_peer(model, lattice, true); }},
          {"reference", "", [&] { return make_reference_peer(model, lattice); }},
          {"occt", "", [&file, &lattice] { return make_occt_peer(file, lattice); }}};
}

std::vector<PeerEntry> mesh_peers(const std::string& key, const ModelMesh& mesh, const Lattice& lattice) {
  return {{"contour", key, [&] { return make_contour_peer(mesh, lattice); }},
          {"dexel", key, [&] { return make_dexel_peer(mesh, lattice); }},
          {"embree", key, [&] { return make_embree_peer(mesh, lattice); }}};
}

/// A peer in its process, with what it has said so far.
struct Runner {
  Json result;
  std::unique_ptr<Child> child;
  std::vector<double> seconds;

  /// Asks for a step; nothing when the process is or has gone.
  std::optional<Json> ask(const std::string& step) {
    if (result.contains("failed")) return std::nullopt;
    if (const auto answer = child->ask(step)) return Json::parse(*answer);
    result["failed"] = step + ": " + child->error();
    say(result["peer"].get<std::string>() + " " + result["mesh"].get<std::string>() + " failed in " + step);
    return std::nullopt;
  }
};

Runner start_runner(const PeerEntry& entry, const Lattice& lattice, const std::vector<ExactRow>& exact,
                    const MeasureOptions& options) {
  Runner runner;
  runner.result = {{"peer", entry.name}, {"mesh", entry.mesh}};
  const auto make = [&]() -> Child::Answer {
    const auto measurement = std::make_shared<Measurement>(entry, lattice, exact, options);
    return [measurement](const std::string& step) {
      if (step == "prepare") return measurement->prepare().dump();
      if (step == "run") return Json(measurement->run()).dump();
      return measurement->check().dump();
    };
  };
  runner.child = std::make_unique<Child>(make, 0);
  if (const auto prepared = runner.ask("prepare")) runner.result.update(*prepared);
  return runner;
}

void finish_runner(Runner& runner) {
  if (const auto checked = runner.ask("check")) runner.result.update(*checked);
  if (!runner.result.contains("failed")) {
    runner.result["runs_s"] = runner.seconds;
    std::sort(runner.seconds.begin(), runner.seconds.end());
    const double median = runner.seconds[runner.seconds.size() / 2];
    runner.result["cast_s"] = median;
    runner.result["hits_per_s"] = runner.result["hits"].get<double>() / median;
    say(runner.result["peer"].get<std::string>() + " " + runner.result["mesh"].get<std::string>() + ": " +
        std::to_string(runner.result["hits_per_s"].get<double>() / 1e6) + " million hits/s");
  }
  runner.child.reset();
}

Json run_peers(const std::vector<PeerEntry>& entries, const Lattice& lattice, const std::vector<ExactRow>& exact,
               const BenchOptions& options) {
  std::vector<Runner> runners;
  for (const PeerEntry& entry : entries) runners.push_back(start_runner(entry, lattice, exact, options.measure));
  for (int round = 0; round < options.rounds; ++round) {
    for (Runner& runner : runners) {
      if (const auto seconds = runner.ask("run")) runner.seconds.push_back(seconds->get<double>());
    }
  }
  Json results = Json::array();
  for (Runner& runner : runners) {
    finish_runner(runner);
    results.push_back(runner.result);
  }
  return results;
}

Json describe(const ExactModel& model, const Lattice& lattice) {
  const Vec3 size = model.bounds.sizes();
  return {
      {"solids", model.solids.size()}, {"faces", model.scene.faces.size()}, {"size_mm", {size.x(), size.y(), size.z()}},
      {"rows", lattice.rows},          {"layers", lattice.layers},          {"pitch_y_mm", lattice.pitch_y},
      {"pitch_z_mm", lattice.pitch_z}};
}

}  // namespace

std::string deflection_key(double deflection) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", deflection);
  return text;
}

Json bench_model(const std::filesystem::path& file, const BenchOptions& options) {
  std::fprintf(stderr, "%s\n", file.filename().c_str());
  const ExactModel model = read_model(file.string());
  const Lattice lattice = make_lattice(model.bounds, options.rows, options.layers);
  Json report = describe(model, lattice);
  report["file"] = file.filename().string();
  report["tessellations"] = Json::object();
  std::map<double, ModelMesh> meshes;
  for (const double deflection : options.deflections) {
    if (auto mesh = find_mesh(file, deflection, options, report["tessellations"]))
      meshes[deflection] = std::move(*mesh);
  }
  const auto sample = run_in_child(
      [&] { return to_bytes(sample_rows(model, lattice, options.sample_seconds, options.measure.seed)); }, 0);
  const std::vector<ExactRow> exact = sample ? rows_from_bytes(*sample) : std::vector<ExactRow>{};
  say(std::to_string(exact.size()) + " exact rows");

  std::vector<PeerEntry> entries = exact_peers(file, model, lattice);
  for (const auto& [deflection, mesh] : meshes) {
    for (PeerEntry& entry : mesh_peers(deflection_key(deflection), mesh, lattice)) entries.push_back(std::move(entry));
  }
  std::erase_if(entries, [&](const PeerEntry& entry) {
    const auto& names = options.peers;
    return !names.empty() && std::find(names.begin(), names.end(), entry.name) == names.end();
  });
  report["peers"] = run_peers(entries, lattice, exact, options);
  return report;
}

}  // namespace lamella::bench
