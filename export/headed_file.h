#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "export/output_file.h"

namespace lamella {

/// A file that begins with a header which is known only when the rest has been written.
class HeadedFile {
 public:
  /// Leaves `header_bytes` free at the beginning. Throws ExportError.
  HeadedFile(const std::filesystem::path& path, std::size_t header_bytes);

  [[nodiscard]] std::size_t header_bytes() const { return header_bytes_; }
  /// Bytes behind the header so far.
  [[nodiscard]] std::uint64_t appended() const { return appended_; }

  /// Throws ExportError when a write has failed.
  void append(std::string_view bytes);

  /// Writes at a place in the header; what is beside it must have been or be written too.
  void write_header(std::size_t at, std::string_view bytes);

  /// Gives the file its name. Throws ExportError.
  void commit() { file_.commit(); }

 private:
  OutputFile file_;
  std::size_t header_bytes_;
  std::uint64_t appended_ = 0;
};

}  // namespace lamella
