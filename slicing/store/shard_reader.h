#pragma once

#include <cstddef>
#include <filesystem>

#include "slicing/layer.h"
#include "slicing/layer_plan.h"
#include "slicing/store/build_file.h"
#include "slicing/store/hdf5.h"

namespace lamella {

/// Reads layers from one shard. The file is hostile: only hard links to plain arrays of the stated type and size are
/// followed, and no more memory is taken than the file's own bytes can justify.
class ShardReader {
 public:
  /// Opens the file after its bytes have been found to have the digest of `entry`. Throws InputError.
  ShardReader(std::filesystem::path path, const ShardEntry& entry);
  ~ShardReader();
  ShardReader(const ShardReader&) = delete;
  ShardReader& operator=(const ShardReader&) = delete;

  /// Reads one layer. `rows` is the number of its raster rows. The content is not judged. Throws InputError.
  [[nodiscard]] Layer read(std::size_t index, const LayerSpan& span, const LayerEntry& entry, std::size_t rows) const;

 private:
  std::filesystem::path path_;
  std::uintmax_t file_bytes_ = 0;
  hdf5::File file_;
};

}  // namespace lamella
