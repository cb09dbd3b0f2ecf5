#pragma once

#include <filesystem>
#include <fstream>

#include "core/atomic_file.h"

namespace lamella {

/// A file of our own beside an output, for what has to wait until the output's order wants it; removed with the object.
class ScratchFile {
 public:
  /// Throws ExportError.
  explicit ScratchFile(const std::filesystem::path& beside);

  [[nodiscard]] const std::filesystem::path& path() const { return file_.temporary(); }
  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// Throws ExportError when a write has failed.
  void check();
  /// Ends writing. Throws ExportError.
  void close();
  /// Copies the closed file's bytes. Throws ExportError when it can't be read.
  void append_to(std::ostream& out) const;

 private:
  AtomicFile file_;
  std::ofstream stream_;
};

}  // namespace lamella
