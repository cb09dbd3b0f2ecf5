#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "slicing/layer_sink.h"

namespace lamella {

struct ImageFolderOptions {
  std::string extension = ".png";  ///< with its dot
  bool folder_per_material = false;
  unsigned value = 1;       ///< of pixels that are wholly of a folder's material
  bool pads_number = true;  ///< to six digits
};

/// A folder with one image per layer, or one sub-folder of such images per material, and three tables:
/// `materials.csv`, `grid.csv` and, once the stack is complete, `layers.csv` (docs/formats/png.md).
///
/// Every file appears under its name when it is whole. A folder that holds anything but an earlier stack is refused;
/// an earlier stack is removed when a new one begins.
class ImageFolder {
 public:
  /// The folder itself is made by open().
  ImageFolder(std::filesystem::path root, ImageFolderOptions options);

  /// Checks and empties the folder, creates it and its sub-folders, and writes the tables but layers.csv. Throws
  /// ExportError.
  void open(const BuildInfo& info);

  /// Writes the image of that number into the given sub-folder (ignored without sub-folders). Threads may write
  /// different images at the same time. Throws ExportError.
  void write_image(std::uint32_t number, std::size_t subfolder, std::string_view bytes) const;

  /// Notes an image's layer for layers.csv.
  void add_layer(std::uint32_t number, const LayerSpan& span);

  /// Writes layers.csv, which tells a reader that the stack is complete. Throws ExportError.
  void close() const;

  /// Removes what open() and write_image() have made, after a failed run; the folder itself too if open() made it.
  void abandon() noexcept;

 private:
  [[nodiscard]] std::string image_name(std::uint32_t number) const;
  void write_tables(const BuildInfo& info) const;

  std::filesystem::path root_;
  ImageFolderOptions options_;
  std::vector<std::string> subfolders_;  ///< by material, empty when all images lie in the root
  std::string layers_csv_;
  bool is_open_ = false;  ///< all in the folder is ours
  bool made_root_ = false;
};

}  // namespace lamella
