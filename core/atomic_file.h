#pragma once

#include <filesystem>
#include <string_view>

namespace lamella {

/// A file that appears under its name only when it is whole: write to `temporary()`, then `commit()`.
/// Without a commit the temporary file is removed, so a killed or failed run leaves nothing half-written.
class AtomicFile {
 public:
  /// Reserves a temporary name beside `target` (same folder, so the rename is atomic). Creates no file.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(AtomicFile&& other) noexcept;
  AtomicFile& operator=(AtomicFile&& other) noexcept;

  [[nodiscard]] const std::filesystem::path& temporary() const { return temporary_; }
  [[nodiscard]] const std::filesystem::path& target() const { return target_; }

  /// Renames the temporary file to the target. Throws ExportError.
  void commit();

 private:
  void discard() noexcept;

  std::filesystem::path target_;
  std::filesystem::path temporary_;
};

/// Writes `bytes` to `target` by way of a temporary name. Throws ExportError.
void write_file_atomically(const std::filesystem::path& target, std::string_view bytes);

/// Creates `folder` and its parents. Throws ExportError.
void make_folder(const std::filesystem::path& folder);

}  // namespace lamella
