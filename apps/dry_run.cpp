#include "apps/dry_run.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

#include "apps/slice_report.h"
#include "apps/stopwatch.h"
#include "apps/table.h"
#include "apps/timed_sink.h"
#include "core/error.h"
#include "core/parallel.h"

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

/// Slices blocks of layers and adds up what they took.
class Sampler {
 public:
  Sampler(const Session& session, const SliceRequest& request, const Assembly& assembly, const SlabEngine& engine)
      : session_(session), request_(request), assembly_(assembly), engine_(engine) {
    for (const Output& output : request.outputs) estimate_.outputs.push_back({output, 0.0});
  }

  void run(const LayerPlan& block) {
    const ScratchFolder scratch;
    TeeSink tee;
    std::vector<fs::path> places;
    FormatOptions format = request_.format;
    format.is_sample = true;
    for (const Output& output : request_.outputs) {
      places.push_back(scratch.path() / (output.format + ".out"));
      tee.add(make_sink({output.format, places.back()}, format));
    }
    TimedSink timed(tee);
    const Stopwatch watch;
    (void)slice_with(engine_, assembly_.scene, assembly_.table, assembly_.measures, block, request_.slice, timed,
                     session_.progress());
    seconds_ += watch.seconds();
    writing_ += timed.seconds();
    is_one_slab_ = block.layers.size() <= engine_.slab_layers;
    estimate_.sampled_layers += block.layers.size();
    for (std::size_t i = 0; i < places.size(); ++i) estimate_.outputs[i].bytes += bytes_in(places[i]);
  }

  [[nodiscard]] Estimate scale_to(std::size_t layers) const {
    Estimate out = estimate_;
    const double scale = static_cast<double>(layers) / static_cast<double>(out.sampled_layers);
    out.seconds = scale * seconds_at_work(layers);
    out.memory_bytes = static_cast<double>(peak_memory());
    for (Estimate::Bytes& entry : out.outputs) {
      entry.bytes *= scale;
      if (entry.output.format == "vdb") out.memory_bytes += kVdbMemoryPerByte * entry.bytes;
    }
    return out;
  }

 private:
  /// A block of one slab is cut by one thread and then written; a run cuts slabs on all threads and writes beside it.
  [[nodiscard]] double seconds_at_work(std::size_t layers) const {
    if (!is_one_slab_ || engine_.slab_layers == 1) return seconds_;
    const std::size_t slabs = (layers + engine_.slab_layers - 1) / engine_.slab_layers;
    const std::size_t workers = std::min<std::size_t>(slabs, count_threads(request_.slice.threads));
    return std::max(writing_, (seconds_ - writing_) / static_cast<double>(workers));
  }

  const Session& session_;
  const SliceRequest& request_;
  const Assembly& assembly_;
  const SlabEngine& engine_;
  Estimate estimate_;
  double seconds_ = 0.0;
  double writing_ = 0.0;
  bool is_one_slab_ = false;
};

/// Blocks of up to `count` layers around 1/6, 1/2 and 5/6 of the height, or all layers when they are that few.
Estimate run_sample(Sampler sampler, const LayerPlan& plan, std::size_t count) {
  const std::size_t layers = plan.layers.size();
  if (layers <= kBlocks * count) {
    sampler.run(plan);
  } else {
    for (std::size_t b = 0; b < kBlocks; ++b) {
      const std::size_t first = (2 * b + 1) * layers / (2 * kBlocks) - count / 2;
      sampler.run(block_plan(plan, first, count));
    }
  }
  return sampler.scale_to(layers);
}

}  // namespace

Estimate estimate_run(const Session& session, const SliceRequest& request, const Assembly& assembly,
                      const LayerPlan& plan, const SlabEngine& engine) {
  const Stopwatch watch;
  const Sampler sampler(session, request, assembly, engine);
  Estimate first = run_sample(sampler, plan, kFewLayers);
  if (watch.seconds() > kPatience || first.sampled_layers == plan.layers.size()) return first;
  return run_sample(sampler, plan, kManyLayers);
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
