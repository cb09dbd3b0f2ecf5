#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include "export/output_file.h"

namespace lamella {

/// A ZIP archive written entry by entry, so that it needs no more memory than its table of contents. Entries are stored
/// as they are: what goes in is compressed already. Their date is always 1 January 1980.
class ZipWriter {
 public:
  /// Throws ExportError.
  explicit ZipWriter(const std::filesystem::path& file) : file_(file) {}

  /// Appends a file of less than 4 GiB with a unique name. Throws ExportError when a write has failed, UsageError when
  /// the archive would pass 4 GiB or 65 535 entries, beyond which printers don't read it.
  void add(std::string_view name, std::string_view bytes);

  /// Writes the table of contents and gives the archive its name. Throws ExportError.
  void commit();

 private:
  OutputFile file_;
  std::string contents_;
  std::uint64_t size_ = 0;
  std::size_t entries_ = 0;
};

}  // namespace lamella
