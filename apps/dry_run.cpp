#include "apps/dry_run.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

#include "apps/slice_report.h"
#include "apps/stopwatch.h"
#include "apps/table.h"
#include "core/error.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kBlocks = 3;
constexpr std::size_t kFewLayers = 2;    // of each block
constexpr std::size_t kManyLayers = 16;  // whole leaves of a VDB, which are 8 voxels high
constexpr double kPatience = 1.0;        // s; when a few layers take less, more of them say more

/// A VDB is held in memory until its end, its leaves uncompressed: 10 to 11 times the file on overmoulded_grip.
constexpr double kVdbMemoryPerByte = 11.0;

/// A folder of our own in the system's place for temporary files, removed with the object.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::error_code failure;
    std::string pattern = (fs::temp_directory_path(failure) / "lamella-XXXXXX").string();
    if (failure || ::mkdtemp(pattern.data()) == nullptr) {
      throw ExportError("can't create a temporary folder", pattern, "set TMPDIR to a folder that can be written");
    }
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Layers [first, first + count) as a plan of their own; neighbours, because a VDB takes nothing else.
LayerPlan block_plan(const LayerPlan& plan, std::size_t first, std::size_t count) {
  LayerPlan block = plan;
  const auto begin = plan.layers.begin() + static_cast<std::ptrdiff_t>(first);
  block.layers.assign(begin, begin + static_cast<std::ptrdiff_t>(count));
  block.grid.origin.z() = block.layers.front().z_bottom;
  block.grid.size[2] = static_cast<std::int64_t>(count);
  return block;
}

double bytes_in(const fs::path& path) {
  double bytes = 0.0;
  for (const WrittenFile& file : list_files(path)) bytes += static_cast<double>(file.bytes);
  return bytes;
}

/// Runs one block and adds what it took.
void run_block(const Session& session, const SliceRequest& request, const Assembly& assembly, const LayerPlan& block,
               const SlabEngine& engine, Estimate& sum) {
  const ScratchFolder scratch;
  TeeSink tee;
  std::vector<fs::path> places;
  for (const Output& output : request.outputs) {
    places.push_back(scratch.path() / (output.format + ".out"));
    tee.add(make_sink({output.format, places.back()}, request.format));
  }
  const Stopwatch watch;
  (void)slice_with(engine, assembly.scene, assembly.table, assembly.measures, block, request.slice, tee,
                   session.progress());
  sum.seconds += watch.seconds();
  sum.sampled_layers += block.layers.size();
  for (std::size_t i = 0; i < places.size(); ++i) sum.outputs[i].bytes += bytes_in(places[i]);
}

/// Blocks of up to `count` layers around 1/6, 1/2 and 5/6 of the height, or all layers when they are that few.
Estimate run_sample(const Session& session, const SliceRequest& request, const Assembly& assembly,
                    const LayerPlan& plan, const SlabEngine& engine, std::size_t count) {
  Estimate estimate;
  for (const Output& output : request.outputs) estimate.outputs.push_back({output, 0.0});
  const std::size_t layers = plan.layers.size();
  if (layers <= kBlocks * count) {
    run_block(session, request, assembly, plan, engine, estimate);
  } else {
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const std::size_t first = (2 * b + 1) * layers / (2 * kBlocks) - count / 2;
      run_block(session, request, assembly, block_plan(plan, first, count), engine, estimate);
    }
  }
  const double scale = static_cast<double>(layers) / static_cast<double>(estimate.sampled_layers);
  estimate.seconds *= scale;
  estimate.memory_bytes = static_cast<double>(peak_memory());
  for (Estimate::Bytes& entry : estimate.outputs) {
    entry.bytes *= scale;
    if (entry.output.format == "vdb") estimate.memory_bytes += kVdbMemoryPerByte * entry.bytes;
  }
  return estimate;
}

}  // namespace

Estimate estimate_run(const Session& session, const SliceRequest& request, const Assembly& assembly,
                      const LayerPlan& plan, const SlabEngine& engine) {
  const Stopwatch watch;
  Estimate first = run_sample(session, request, assembly, plan, engine, kFewLayers);
  if (watch.seconds() > kPatience || first.sampled_layers == plan.layers.size()) return first;
  return run_sample(session, request, assembly, plan, engine, kManyLayers);
}

Json estimate_json(const Estimate& estimate, const LayerPlan& plan) {
  Json outputs = Json::array();
  for (const Estimate::Bytes& entry : estimate.outputs) {
    outputs.push_back({{"format", entry.output.format},
                       {"path", entry.output.path.string()},
                       {"bytes", static_cast<std::uint64_t>(entry.bytes)}});
  }
  const auto rows = plan.layers.size() * static_cast<std::uint64_t>(plan.grid.size[1]);
  return {{"dry_run", true},
          {"grid", grid_json(plan.grid)},
          {"layers", plan.layers.size()},
          {"rows", rows},
          {"rays", rows},
          {"estimate",
           {{"sampled_layers", estimate.sampled_layers},
            {"time", estimate.seconds},
            {"memory_bytes", static_cast<std::uint64_t>(estimate.memory_bytes)},
            {"outputs", outputs}}}};
}

std::string estimate_text(const Estimate& estimate) {
  std::string out = fmt::format("estimate from {} layers: {:.3g} s, memory {}\n", estimate.sampled_layers,
                                estimate.seconds, short_bytes(estimate.memory_bytes));
  for (const Estimate::Bytes& entry : estimate.outputs) {
    out += fmt::format("{}: about {} in {}\n", entry.output.format, short_bytes(entry.bytes),
                       printable(entry.output.path.string()));
  }
  return out + "nothing was written\n";
}

}  // namespace lamella::apps
