#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "slicing/store/store.h"
#include "tests/support/layers.h"

namespace lamella::test {

inline std::string read_file(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_file(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream(path, std::ios::binary) << bytes;
}

/// Path below `folder` and bytes of each file in it.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file())
      files[std::filesystem::relative(entry.path(), folder).string()] = read_file(entry.path());
  }
  return files;
}

/// A build with names that need escaping and layers large enough to be compressed.
struct Sample {
  BuildInfo info;
  SliceReport report;
  std::vector<Layer> layers;
};

inline Sample make_sample(std::int64_t layer_count = 5, bool hatch = true, unsigned seed = 1) {
  Sample sample;
  Grid grid;
  grid.origin = Vec3(-1.0 / 3.0, 1e-3, -7);
  grid.pitch = Vec3(0.1, 0.2, 0.3);
  grid.size = {40, 60, layer_count};
  sample.info = make_build(grid, {"PA 12", "TPU <\"&'>", "Kupfer \xC3\xA4\n2"});
  sample.info.policy = OverlapPolicy::average;
  sample.info.solids[SolidId{1}].priority = -5;
  sample.info.solids[SolidId{1}].bounds = Box3();
  sample.info.materials[MaterialId{2}].density.reset();
  if (hatch) sample.info.plan.hatch = HatchLattice{0.3, 0.1, 1.0};
  std::mt19937 random(seed);
  for (std::int64_t k = 0; k < layer_count; ++k) {
    sample.layers.push_back(random_layer(sample.info, k, random, hatch));
  }
  sample.report.layers = static_cast<std::uint64_t>(layer_count);
  sample.report.rows = sample.report.rays = 60 * sample.report.layers;
  sample.report.segments = 1234;
  sample.report.cast.hits = 1ULL << 40;
  sample.report.solids.resize(3);
  sample.report.solids[SolidId{1}] = {0.1, 0.2, 0.3, true, "open"};
  sample.report.materials.resize(3);
  sample.report.materials[MaterialId{0}] = {1.0 / 3.0, 2e-300};
  sample.report.overlaps.push_back({SolidId{0}, SolidId{2}, 0.7, 3, 0.2});
  sample.report.interfaces.push_back({SolidId{0}, SolidId{1}, 1.0 / 7.0, 0.0, 0.0, 1e-7, 2});
  sample.report.open_gaps.push_back({SolidId{0}, SolidId{1}, 3.5, 0.3, 1e-3, 0.1, 4});
  sample.report.gaps.push_back({SolidId{1}, SolidId{2}, 1e-9, 1});
  sample.report.findings.push_back({Severity::error, "/a/b", "face 3", "#12", "what & why", "a \"hint\""});
  return sample;
}

inline void write_sample(const Sample& sample, const std::filesystem::path& folder,
                         const StoreOptions& options = {2, 4}) {
  const auto sink = make_store_sink(folder, options);
  sink->begin(sample.info);
  for (const Layer& layer : sample.layers) sink->write(layer);
  sink->finish(sample.report);
}

}  // namespace lamella::test
