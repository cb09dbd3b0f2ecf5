#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "core/atomic_file.h"
#include "slicing/store/build_file.h"
#include "slicing/store/build_folder.h"
#include "slicing/store/layer_digest.h"
#include "slicing/store/packed_layer.h"
#include "slicing/store/shard_writer.h"
#include "slicing/store/store.h"

namespace lamella {

namespace {

namespace fs = std::filesystem;

void check_options(const StoreOptions& options) {
  if (options.layers_per_shard == 0 || options.layers_per_shard > kMaxStoredLayers) {
    throw UsageError("layers per shard must lie between 1 and " + std::to_string(kMaxStoredLayers));
  }
  if (options.compression < 0 || options.compression > 9) throw UsageError("compression must lie between 0 and 9");
}

/// Writes shards as layers come, build.xml last: a folder without it is not a build.
class StoreSink final : public LayerSink {
 public:
  StoreSink(fs::path folder, const StoreOptions& options) : folder_(std::move(folder)), options_(options) {}

  void begin(const BuildInfo& info) override {
    if (info.plan.layers.size() > kMaxStoredLayers) {
      throw UsageError("a build stores at most " + std::to_string(kMaxStoredLayers) + " layers", {},
                       "choose a greater layer height");
    }
    build_.info = info;
    build_.layers_per_shard = options_.layers_per_shard;
    prepare_build_folder(folder_);
    owns_folder_ = true;
    // First of all the file by which a run that is killed from here on is recognised.
    write_file_atomically(folder_ / kUnfinishedName, write_build_xml(build_, false));
    make_folder(folder_ / kShardFolder);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    auto packed = std::make_shared<PackedLayer>(pack_layer(layer, options_.compression));
    return [this, packed = std::move(packed), entry = describe(layer)] { add(*packed, entry); };
  }

  void finish(const SliceReport& report) override {
    if (shard_) close_shard();
    if (build_.layers.size() != build_.info.plan.layers.size()) {
      throw ExportError("a build needs all layers of its plan", folder_.string());
    }
    build_.report = report;
    write_master_file(folder_ / kMasterName, build_.info, options_.layers_per_shard);
    write_file_atomically(folder_ / kBuildName, write_build_xml(build_, true));
    std::error_code ignored;
    fs::remove(folder_ / kUnfinishedName, ignored);
  }

  void abandon() noexcept override {
    shard_.reset();
    if (owns_folder_) remove_build_files(folder_);
  }

 private:
  static MixtureEntry describe(const Mixtures& mixtures) {
    return {mixtures.segment.size(), mixtures.x.size(), mixtures.fraction.size()};
  }

  static LayerEntry describe(const Layer& layer) {
    LayerEntry entry;
    entry.segments = layer.raster.segments.size();
    entry.mixtures = describe(layer.raster.mixtures);
    entry.has_hatch = layer.hatch.has_value();
    if (layer.hatch) {
      entry.hatch_rows = layer.hatch->rows.rows();
      entry.hatch_segments = layer.hatch->rows.segments.size();
      entry.hatch_mixtures = describe(layer.hatch->rows.mixtures);
    }
    if (layer.contours) {
      entry.contours = {layer.contours->loops.size(), layer.contours->points.size(), layer.contours->curves.size()};
    }
    entry.sha256 = digest_of(layer);
    return entry;
  }

  void add(const PackedLayer& layer, const LayerEntry& entry) {
    if (layer.index != build_.layers.size()) throw ExportError("layers came out of order", folder_.string());
    if (!shard_) shard_ = std::make_unique<ShardWriter>(shard_path(), build_.info, options_.compression);
    shard_->add(layer);
    build_.layers.push_back(entry);
    if (build_.layers.size() % options_.layers_per_shard == 0) close_shard();
  }

  [[nodiscard]] fs::path shard_path() const { return folder_ / shard_name(build_.shards.size()); }

  void close_shard() {
    build_.shards.push_back({shard_->finish()});
    shard_.reset();
  }

  fs::path folder_;
  StoreOptions options_;
  bool owns_folder_ = false;  ///< begin() has found it empty or ours
  BuildFile build_;
  std::unique_ptr<ShardWriter> shard_;
};

}  // namespace

std::unique_ptr<LayerSink> make_store_sink(const fs::path& build, const StoreOptions& options) {
  check_options(options);
  return std::make_unique<StoreSink>(build, options);
}

}  // namespace lamella
