#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "materials/material_table.h"
#include "slicing/layer.h"
#include "slicing/layer_plan.h"
#include "slicing/report.h"

namespace lamella {

/// One solid as exporters and readers of a build see it.
struct BuildSolid {
  std::string name;
  std::string path;
  MaterialId material;
  int priority = 0;
  double volume_exact = 0.0;  ///< mm^3
  Box3 bounds;
};

/// Layers [first, last) of a build.
struct LayerRange {
  std::uint32_t first = 0;
  std::uint32_t last = UINT32_MAX;
};

/// All that an exporter knows about a build besides its layers.
struct BuildInfo {
  std::vector<SourceFile> sources;
  IdVector<MaterialId, Material> materials;
  IdVector<SolidId, BuildSolid> solids;
  OverlapPolicy policy = OverlapPolicy::priority;
  LayerPlan plan;
  std::optional<Mat3> turn = {};  ///< how the assembly was turned to be built: p -> turn p, from the files' frame
  LayerRange given = {};  ///< of the plan's layers, those that a sink gets; more than the plan has are all of it
};

/// Whether the build has graded materials.
[[nodiscard]] bool is_graded(const BuildInfo& info);

/// Takes the layers of one build in increasing z: begin, write once per layer, finish.
/// A replay of a range of layers writes fewer than the plan holds, those that `BuildInfo::given` says; `Layer::index`
/// keeps its place in the plan.
/// An implementation writes to temporary names and renames in finish(); destroyed without finish() it leaves nothing.
class LayerSink {
 public:
  virtual ~LayerSink() = default;
  /// Throws ExportError before any layer is cut when the target can't be written, UsageError when an option is missing.
  virtual void begin(const BuildInfo& info) = 0;
  virtual void write(const Layer& layer) = 0;
  /// Does what of write() needs no order, for a sink that has such a part: called once a layer between begin() and
  /// finish(), from several threads at once. What it returns does the rest and is called, with `layer` as it was, in
  /// increasing z and in place of write().
  [[nodiscard]] virtual std::function<void()> prepare(const Layer& layer);
  virtual void finish(const SliceReport& report) = 0;
  /// Called instead of finish() when the run failed for good: removes also the files that were complete. After a
  /// cancelled run it isn't called; complete files may stay.
  virtual void abandon() noexcept {}
};

/// Feeds several sinks from one stream, in order.
class TeeSink final : public LayerSink {
 public:
  void add(std::unique_ptr<LayerSink> sink) { sinks_.push_back(std::move(sink)); }
  void begin(const BuildInfo& info) override;
  void write(const Layer& layer) override;
  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override;
  void finish(const SliceReport& report) override;
  void abandon() noexcept override;

 private:
  std::vector<std::unique_ptr<LayerSink>> sinks_;
};

}  // namespace lamella
