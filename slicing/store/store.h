#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "core/progress.h"
#include "slicing/layer_sink.h"

namespace lamella {

struct StoreOptions {
  std::uint32_t layers_per_shard = 64;
  int compression = 1;  ///< deflate level, 0 to 9; higher ones take half as long again for 1 % less
};

/// Writes a build: `build.xml`, `layers/NNNNNN.h5` shards, `layers.h5` that links them (docs/formats/store.md).
/// Refuses a folder that isn't empty and isn't a build. Same layers, same bytes.
[[nodiscard]] std::unique_ptr<LayerSink> make_store_sink(const std::filesystem::path& build,
                                                         const StoreOptions& options = {});

/// A build on disk, opened for reading. Every shard's checksum is verified before its layers are handed out.
class StoreReader {
 public:
  /// Throws InputError with file and place when it isn't a build or is damaged.
  explicit StoreReader(std::filesystem::path build);
  ~StoreReader();
  StoreReader(StoreReader&&) noexcept;

  [[nodiscard]] const BuildInfo& info() const;
  [[nodiscard]] const SliceReport& report() const;
  [[nodiscard]] Layer read_layer(std::uint32_t index) const;

  /// Checks layers.h5, which this class does not need but other programs open: every layer's link is there and leads
  /// to a group. Throws InputError.
  void check_links() const;

  /// Streams the layers of `range` to `sink` in increasing z: begin, prepare and its rest ..., finish; on all cores.
  /// begin() gets info() with `range` as what is given.
  void replay(LayerSink& sink, LayerRange range = {}, const Progress& progress = {}) const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace lamella
