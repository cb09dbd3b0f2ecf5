#include <algorithm>
#include <functional>
#include <mutex>
#include <utility>
#include <vector>

#include "core/ordered_pipeline.h"
#include "core/parallel.h"
#include "slicing/layer_check.h"
#include "slicing/store/build_file.h"
#include "slicing/store/hdf5.h"
#include "slicing/store/layer_digest.h"
#include "slicing/store/shard_reader.h"
#include "slicing/store/store.h"

namespace lamella {

namespace fs = std::filesystem;

namespace {

BuildFile open_build(const fs::path& folder) {
  std::error_code failure;
  if (fs::is_regular_file(folder / kBuildName, failure)) return read_build_xml(folder / kBuildName);
  if (fs::is_regular_file(folder / kUnfinishedName, failure)) {
    throw InputError("the build is unfinished", folder.string(), "slice again to complete it");
  }
  throw InputError("not a build: no build.xml", folder.string(), "give the folder that `lamella slice -o` wrote");
}

}  // namespace

struct StoreReader::Data {
  fs::path folder;
  BuildFile build;
  LayerLimits limits;
  std::mutex mutex;  ///< guards the open shard
  std::size_t shard_index = 0;
  std::unique_ptr<ShardReader> shard;

  const ShardReader& open_shard(std::size_t index) {
    if (!shard || shard_index != index) {
      shard.reset();
      shard = std::make_unique<ShardReader>(folder / shard_name(index), build.shards[index]);
      shard_index = index;
    }
    return *shard;
  }
};

StoreReader::StoreReader(fs::path build) : data_(std::make_unique<Data>()) {
  data_->build = open_build(build);
  data_->folder = std::move(build);
  const BuildInfo& info = data_->build.info;
  data_->limits = make_layer_limits(info.plan.grid.size[1], info.materials, info.solids.size());
}

StoreReader::~StoreReader() = default;
StoreReader::StoreReader(StoreReader&&) noexcept = default;

const BuildInfo& StoreReader::info() const { return data_->build.info; }
const SliceReport& StoreReader::report() const { return data_->build.report; }

Layer StoreReader::read_layer(std::uint32_t index) const {
  const BuildFile& build = data_->build;
  if (index >= build.layers.size()) {
    throw UsageError("no layer " + std::to_string(index), data_->folder.string(),
                     "the build has " + std::to_string(build.layers.size()) + " layers, counted from 0");
  }
  const std::lock_guard lock(data_->mutex);
  const std::size_t shard = index / build.layers_per_shard;
  const LayerEntry& entry = build.layers[index];
  Layer layer = data_->open_shard(shard).read(index, build.info.plan.layers[index], entry, data_->limits.rows);
  const std::string where = (data_->folder / shard_name(shard)).string() + ":/" + layer_group_name(index);
  if (digest_of(layer) != entry.sha256) {
    throw InputError("the layer's checksum is not that of build.xml", where, "the build is damaged; slice again");
  }
  if (const auto fault = find_layer_fault(layer, data_->limits)) {
    throw InputError("malformed layer: " + *fault, where, "the build is damaged; slice again");
  }
  return layer;
}

void StoreReader::check_links() const {
  const std::filesystem::path path = data_->folder / kMasterName;
  const hdf5::Session session;
  const hdf5::File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  const std::string hint = "slice again, or export from the shards, which are checked apart";
  if (!file.is_valid()) throw InputError("can't open the file that links the layers", path.string(), hint);
  for (std::size_t layer = 0; layer < data_->build.layers.size(); ++layer) {
    const std::string name = layer_group_name(layer);
    const hdf5::Group group(H5Gopen2(file.id(), name.c_str(), H5P_DEFAULT));
    if (!group.is_valid()) throw InputError("the link '" + name + "' leads nowhere", path.string(), hint);
  }
}

namespace {

/// Reads layers and prepares them for the sink in parallel while others, in order, are written.
void replay_layers(const StoreReader& reader, LayerSink& sink, LayerRange range, const Progress& progress) {
  const std::size_t count = range.last - range.first;
  std::vector<Layer> layers(2 * static_cast<std::size_t>(count_threads(0)));
  std::vector<std::function<void()>> rests(layers.size());
  const auto read = [&](std::size_t item, std::size_t slot) {
    progress.throw_if_cancelled();
    layers[slot] = reader.read_layer(range.first + static_cast<std::uint32_t>(item));
    rests[slot] = sink.prepare(layers[slot]);
  };
  const auto write = [&](std::size_t item, std::size_t slot) {
    progress.throw_if_cancelled();
    std::exchange(rests[slot], nullptr)();
    progress.report("reading layers", static_cast<double>(item + 1) / static_cast<double>(count));
  };
  ordered_pipeline(count, layers.size(), read, write);
}

}  // namespace

void StoreReader::replay(LayerSink& sink, LayerRange range, const Progress& progress) const {
  const auto count = static_cast<std::uint32_t>(data_->build.layers.size());
  const std::uint32_t last = std::min(range.last, count);
  if (range.first >= last) {
    throw UsageError("no layer in the range", data_->folder.string(),
                     "the build has " + std::to_string(count) + " layers, counted from 0");
  }
  BuildInfo build = info();
  build.given = {range.first, last};
  try {
    sink.begin(build);
    replay_layers(*this, sink, build.given, progress);
    sink.finish(report());
  } catch (const Cancelled&) {
    throw;
  } catch (...) {
    sink.abandon();
    throw;
  }
}

}  // namespace lamella
