#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "slicing/layer_sink.h"
#include "slicing/store/hdf5.h"
#include "slicing/store/packed_layer.h"

namespace lamella {

/// Builds one HDF5 file in memory. Memory grows with the compressed size of its layers.
class ShardWriter {
 public:
  /// `path` is where the bytes will go; it is named in errors. `compression` is the deflate level, 0 to 9.
  ShardWriter(std::filesystem::path path, const BuildInfo& info, int compression);
  ~ShardWriter();
  ShardWriter(const ShardWriter&) = delete;
  ShardWriter& operator=(const ShardWriter&) = delete;

  /// Adds the group of one layer, packed with this writer's compression. Throws ExportError.
  void add(const PackedLayer& layer);

  /// Writes the file under its name, whole or not at all, and returns the SHA-256 of its bytes. Throws ExportError.
  [[nodiscard]] std::string finish();

 private:
  std::filesystem::path path_;
  int compression_;
  hdf5::File file_;
};

/// Writes layers.h5: one external link a layer, "layer_000012" into its shard, and the tables of names. Throws
/// ExportError.
void write_master_file(const std::filesystem::path& path, const BuildInfo& info, std::size_t layers_per_shard);

}  // namespace lamella
