#include "apps/dry_run.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <stdlib.h>

#include "apps/slice_report.h"
#include "apps/stopwatch.h"
#include "apps/table.h"
#include "core/error.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kFewLayers = 4;
constexpr std::size_t kManyLayers = 32;
constexpr double kPatience = 1.0;  // s; when a few layers take less, more of them say more

/// A VDB is held in memory until its end, its leaves uncompressed; measured on the shipped data sets.
constexpr double kVdbMemoryPerByte = 10.0;

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

/// `count` layers of the plan, evenly spread.
LayerPlan sample_plan(const LayerPlan& plan, std::size_t count) {
  LayerPlan sample = plan;
  sample.layers.clear();
  for (std::size_t i = 0; i < count; ++i)
    sample.layers.push_back(plan.layers[(2 * i + 1) * plan.layers.size() / (2 * count)]);
  sample.grid.size[2] = static_cast<std::int64_t>(count);
  return sample;
}

double bytes_in(const fs::path& path) {
  double bytes = 0.0;
  for (const WrittenFile& file : list_files(path)) bytes += static_cast<double>(file.bytes);
  return bytes;
}

Estimate run_sample(const Session& session, const SliceRequest& request, const Assembly& assembly,
                    const LayerPlan& plan, const CastFunction& cast, std::size_t count) {
  const ScratchFolder scratch;
  TeeSink tee;
  Estimate estimate;
  for (const Output& output : request.outputs) {
    const Output stand_in{output.format, scratch.path() / (output.format + ".out")};
    tee.add(make_sink(stand_in, request.format));
    estimate.outputs.push_back({stand_in, 0.0});
  }
  const Stopwatch watch;
  (void)slice_with(cast, assembly.scene, assembly.table, assembly.measures, sample_plan(plan, count), request.slice,
                   tee, session.progress());
  const double scale = static_cast<double>(plan.layers.size()) / static_cast<double>(count);
  estimate.sampled_layers = count;
  estimate.seconds = watch.seconds() * scale;
  estimate.memory_bytes = static_cast<double>(peak_memory());
  for (std::size_t i = 0; i < request.outputs.size(); ++i) {
    Estimate::Bytes& entry = estimate.outputs[i];
    entry.bytes = bytes_in(entry.output.path) * scale;
    entry.output = request.outputs[i];
    if (entry.output.format == "vdb") estimate.memory_bytes += kVdbMemoryPerByte * entry.bytes;
  }
  return estimate;
}

}  // namespace

Estimate estimate_run(const Session& session, const SliceRequest& request, const Assembly& assembly,
                      const LayerPlan& plan, const CastFunction& cast) {
  const std::size_t few = std::min(kFewLayers, plan.layers.size());
  const Stopwatch watch;
  const Estimate first = run_sample(session, request, assembly, plan, cast, few);
  const std::size_t many = std::min(kManyLayers, plan.layers.size());
  if (watch.seconds() > kPatience || many == few) return first;
  return run_sample(session, request, assembly, plan, cast, many);
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
