#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lamella {

/// A folder for one file per material and nothing else. One that it made goes with the object where nothing is in it.
class MaterialFolder {
 public:
  explicit MaterialFolder(std::filesystem::path root) : root_(std::move(root)) {}
  ~MaterialFolder();
  MaterialFolder(const MaterialFolder&) = delete;
  MaterialFolder& operator=(const MaterialFolder&) = delete;

  /// Makes the folder. Refuses one that holds anything but files of these `names`, also such as a killed run left
  /// incomplete, and leaves it as it is. Throws ExportError.
  void open(const std::vector<std::string>& names);

  /// Notes a file that is complete.
  void add(std::filesystem::path file) { files_.push_back(std::move(file)); }

  /// Removes the files that are complete, after a failed run: they would lie among those of an earlier one.
  void abandon() noexcept;

  [[nodiscard]] const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
  std::vector<std::filesystem::path> files_;
  bool made_root_ = false;
};

}  // namespace lamella
