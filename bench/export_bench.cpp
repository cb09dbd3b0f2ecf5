// How fast layers become files, on one thread: nested wavy discs of three materials, 1000 x 1000 pixels, five segments
// a row; and the builds that the environment names:
//
//   LAMELLA_BENCH_BUILDS=/tmp/impeller:/tmp/wavy_block export_bench

#include <benchmark/benchmark.h>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

#include "export/nrrd_file.h"
#include "export/png_image.h"
#include "export/png_stack.h"
#include "export/raster_row.h"
#include "export/tiff_file.h"
#include "export/vdb/vdb_sink.h"
#include "export/vti_file.h"
#include "export/xml_slices.h"
#include "slicing/store/store.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

constexpr int kSide = 1000;
constexpr int kLayers = 64;
constexpr double kPitch = 0.1;

BuildInfo make_info() {
  BuildInfo info;
  info.plan.grid.pitch = {kPitch, kPitch, kPitch};
  info.plan.grid.size = {kSide, kSide, kLayers};
  for (const char* name : {"shell", "ring", "core"}) {
    const MaterialId id = info.materials.push_back({name, 1.0, {0.5, 0.5, 0.5}});
    info.solids.push_back({name, name, id, 0, 0.0, {}});
  }
  for (int k = 0; k < kLayers; ++k) info.plan.layers.push_back({k * kPitch, (k + 0.5) * kPitch, (k + 1) * kPitch});
  return info;
}

/// Half the length in pixels of the chord at distance `y` from the centre of a disc, 0 outside.
double half_chord(double radius, double y) { return radius > std::abs(y) ? std::sqrt(radius * radius - y * y) : 0.0; }

void append_row(SegmentRows& rows, int j, int k) {
  const double y = j + 0.5 - kSide / 2;
  const double outer = half_chord(470.0 + 20.0 * std::sin(0.02 * j + 0.1 * k), y);
  const double ring = half_chord(300.0 + 0.2 * k, y);
  const double core = half_chord(120.0, y);
  const double ends[] = {-outer, -ring, -core, core, ring, outer};
  const std::size_t materials[] = {0, 1, 2, 1, 0};
  for (std::size_t i = 0; i < 5; ++i) {
    if (!(ends[i] < ends[i + 1])) continue;
    rows.segments.push_back({(ends[i] + kSide / 2) * kPitch, (ends[i + 1] + kSide / 2) * kPitch,
                             MaterialId{materials[i]}, SolidId{materials[i]}});
  }
  rows.row_start.push_back(rows.segments.size());
}

/// A build in memory.
struct Sample {
  std::string name;
  BuildInfo info;
  std::vector<Layer> layers;
};

Sample make_discs() {
  Sample sample{"discs", make_info(), std::vector<Layer>(kLayers)};
  for (int k = 0; k < kLayers; ++k) {
    const LayerSpan& span = sample.info.plan.layers[static_cast<std::size_t>(k)];
    Layer& layer = sample.layers[static_cast<std::size_t>(k)];
    layer.index = static_cast<std::uint32_t>(k);
    layer.z_bottom = span.z_bottom;
    layer.z_sample = span.z_sample;
    layer.z_top = span.z_top;
    for (int j = 0; j < kSide; ++j) append_row(layer.raster, j, k);
  }
  return sample;
}

Sample read_build(const std::string& folder) {
  const StoreReader reader(folder);
  Sample sample{fs::path(folder).filename(), reader.info(), {}};
  for (std::uint32_t k = 0; k < reader.info().plan.layers.size(); ++k) sample.layers.push_back(reader.read_layer(k));
  return sample;
}

void count_rates(benchmark::State& state, const Sample& sample) {
  const auto& size = sample.info.plan.grid.size;
  const double count = static_cast<double>(state.iterations()) * static_cast<double>(sample.layers.size());
  state.counters["layers"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
  state.counters["voxels"] =
      benchmark::Counter(count * static_cast<double>(size[0] * size[1]), benchmark::Counter::kIsRate);
}

void export_layers(benchmark::State& state, const Sample& sample,
                   std::unique_ptr<LayerSink> (*make_sink)(const fs::path&)) {
  const fs::path target = fs::temp_directory_path() / ("lamella-bench-" + std::to_string(::getpid()));
  for (auto _ : state) {
    const std::unique_ptr<LayerSink> sink = make_sink(target);
    sink->begin(sample.info);
    for (const Layer& layer : sample.layers) sink->write(layer);
    sink->finish({});
    state.PauseTiming();
    state.counters["bytes"] = static_cast<double>(fs::is_directory(target) ? 0 : fs::file_size(target));
    fs::remove_all(target);
    state.ResumeTiming();
  }
  count_rates(state, sample);
}

std::size_t count_filled(const Sample& sample) {
  const RowRaster raster(sample.info.plan.grid);
  std::vector<LabelRun> runs;
  std::size_t filled = 0;
  for (const Layer& layer : sample.layers) {
    for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
      runs.clear();
      raster.append_runs(layer.raster.row(row), runs);
      for (const LabelRun& run : runs) filled += static_cast<std::size_t>(run.end - run.begin);
    }
  }
  return filled;
}

/// The grids of a VDB without their file.
void fill_vdb(benchmark::State& state, const Sample& sample, const VdbOptions& options) {
  const fs::path target = fs::temp_directory_path() / ("lamella-bench-" + std::to_string(::getpid()));
  for (auto _ : state) {
    const std::unique_ptr<LayerSink> sink = make_vdb_sink(target, options);
    sink->begin(sample.info);
    for (const Layer& layer : sample.layers) sink->write(layer);
  }
  count_rates(state, sample);
  state.counters["filled"] = benchmark::Counter(
      static_cast<double>(state.iterations()) * static_cast<double>(count_filled(sample)), benchmark::Counter::kIsRate);
}

/// Pictures of labels without their files.
void encode_labels(benchmark::State& state, const Sample& sample, int bits) {
  const Grid& grid = sample.info.plan.grid;
  const RowRaster raster(grid);
  PngStyle style{{1, 1}, std::vector<Color>(std::size_t{1} << bits)};
  std::vector<LabelRun> runs;
  std::size_t bytes = 0;
  for (auto _ : state) {
    bytes = 0;
    for (const Layer& layer : sample.layers) {
      PackedImage image(grid.size[0], grid.size[1], bits);
      for (std::size_t row = 0; row < layer.raster.rows(); ++row) {
        runs.clear();
        raster.append_runs(layer.raster.row(row), runs);
        for (const LabelRun& run : runs) image.fill(static_cast<std::int64_t>(row), run.begin, run.end, run.label);
      }
      bytes += encode_png(image, style).size();
    }
  }
  state.counters["bytes_a_layer"] = static_cast<double>(bytes) / static_cast<double>(sample.layers.size());
  count_rates(state, sample);
}

void register_all(const Sample& sample) {
  const auto add = [&](const char* name, auto run) {
    benchmark::RegisterBenchmark((std::string(name) + "/" + sample.name).c_str(), run)->Unit(benchmark::kMillisecond);
  };
  const auto add_sink = [&](const char* name, std::unique_ptr<LayerSink> (*make)(const fs::path&)) {
    add(name, [&sample, make](benchmark::State& state) { export_layers(state, sample, make); });
  };
  for (const int bits : {2, 4, 8}) {
    const std::string name = "encode_" + std::to_string(bits) + "_bits";
    if (sample.info.materials.size() >= (std::size_t{1} << bits)) continue;
    add(name.c_str(), [&sample, bits](benchmark::State& state) { encode_labels(state, sample, bits); });
  }
  add_sink("indexed_png", [](const fs::path& p) { return make_indexed_png_sink(p); });
  add_sink("png_per_material", [](const fs::path& p) { return make_png_sink(p); });
  add("fill_vdb", [&sample](benchmark::State& state) { fill_vdb(state, sample, {}); });
  add("fill_fog", [&sample](benchmark::State& state) { fill_vdb(state, sample, {.density = false, .labels = false}); });
  add_sink("tiff", [](const fs::path& p) { return make_tiff_sink(p); });
  add_sink("nrrd", [](const fs::path& p) { return make_nrrd_sink(p); });
  add_sink("vti", [](const fs::path& p) { return make_vti_sink(p); });
  add_sink("vdb", [](const fs::path& p) { return make_vdb_sink(p); });
  add_sink("xml_binary", [](const fs::path& p) { return make_xml_sink(p); });
  add_sink("xml_text", [](const fs::path& p) { return make_xml_sink(p, XmlPayload::text); });
}

}  // namespace
}  // namespace lamella

int main(int argc, char** argv) {
  std::vector<lamella::Sample> samples{lamella::make_discs()};
  if (const char* builds = std::getenv("LAMELLA_BENCH_BUILDS")) {
    std::istringstream list(builds);
    for (std::string folder; std::getline(list, folder, ':');) samples.push_back(lamella::read_build(folder));
  }
  for (const lamella::Sample& sample : samples) lamella::register_all(sample);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
