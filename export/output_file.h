#pragma once

#include <filesystem>
#include <fstream>

#include "core/atomic_file.h"

namespace lamella {

/// Creates the parent folder of an output file and refuses a target that exists but isn't a regular file, such as a
/// folder or a device. Throws ExportError; call it before long work starts.
void prepare_target(const std::filesystem::path& target);

/// A text or binary file written as a stream, which appears under its name when it is whole. Destroyed without
/// commit() it leaves nothing.
class OutputFile {
 public:
  /// Opens a temporary file beside `target`. Throws ExportError.
  explicit OutputFile(const std::filesystem::path& target);

  [[nodiscard]] std::ostream& stream() { return stream_; }
  /// Throws ExportError when a write has failed since the file was opened.
  void check();
  /// Flushes, checks and renames. Throws ExportError.
  void commit();

 private:
  AtomicFile file_;
  std::ofstream stream_;
};

}  // namespace lamella
