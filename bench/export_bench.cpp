// How fast layers of 1000 x 1000 pixels become files: nested wavy discs of three materials, five segments a row.

#include <benchmark/benchmark.h>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

#include "export/png_stack.h"
#include "export/vdb/vdb_sink.h"
#include "export/xml_slices.h"

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

std::vector<Layer> make_layers(const BuildInfo& info) {
  std::vector<Layer> layers(kLayers);
  for (int k = 0; k < kLayers; ++k) {
    const LayerSpan& span = info.plan.layers[static_cast<std::size_t>(k)];
    Layer& layer = layers[static_cast<std::size_t>(k)];
    layer.index = static_cast<std::uint32_t>(k);
    layer.z_bottom = span.z_bottom;
    layer.z_sample = span.z_sample;
    layer.z_top = span.z_top;
    for (int j = 0; j < kSide; ++j) append_row(layer.raster, j, k);
  }
  return layers;
}

template <class MakeSink>
void export_layers(benchmark::State& state, MakeSink make_sink) {
  const BuildInfo info = make_info();
  const std::vector<Layer> layers = make_layers(info);
  const fs::path target = fs::temp_directory_path() / ("lamella-bench-" + std::to_string(::getpid()));
  for (auto _ : state) {
    const std::unique_ptr<LayerSink> sink = make_sink(target);
    sink->begin(info);
    for (const Layer& layer : layers) sink->write(layer);
    sink->finish({});
  }
  fs::remove_all(target);
  const double count = static_cast<double>(state.iterations()) * kLayers;
  state.counters["layers"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
  state.counters["voxels"] = benchmark::Counter(count * kSide * kSide, benchmark::Counter::kIsRate);
}

void indexed_png(benchmark::State& state) {
  export_layers(state, [](const fs::path& p) { return make_indexed_png_sink(p); });
}
void png_per_material(benchmark::State& state) {
  export_layers(state, [](const fs::path& p) { return make_png_sink(p); });
}
void vdb(benchmark::State& state) {
  export_layers(state, [](const fs::path& p) { return make_vdb_sink(p); });
}
void xml_binary(benchmark::State& state) {
  export_layers(state, [](const fs::path& p) { return make_xml_sink(p); });
}
void xml_text(benchmark::State& state) {
  export_layers(state, [](const fs::path& p) { return make_xml_sink(p, XmlPayload::text); });
}

BENCHMARK(indexed_png)->Unit(benchmark::kMillisecond);
BENCHMARK(png_per_material)->Unit(benchmark::kMillisecond);
BENCHMARK(vdb)->Unit(benchmark::kMillisecond);
BENCHMARK(xml_binary)->Unit(benchmark::kMillisecond);
BENCHMARK(xml_text)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamella
