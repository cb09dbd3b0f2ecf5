#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include "core/xml.h"

namespace lamella {

/// Reads an XML file whose root has many children, child by child, so that memory is that of the largest child and not
/// the file's.
///
/// Input is hostile: each child, and what stands around the children, is refused what XmlDocument refuses, its size and
/// number of elements included; the whole file is refused over a size of the caller's.
class XmlParts {
 public:
  /// Reads up to the first child. Throws InputError with file and line.
  XmlParts(const std::filesystem::path& path, std::uint64_t most_bytes);

  /// The root with its attributes, as if it had no children.
  [[nodiscard]] const XmlDocument& root() const { return *root_; }
  /// The next child, as the root of a document of its own whose lines are the file's; nothing behind the last one, once
  /// the rest of the file has been looked at. Throws InputError with file and line.
  [[nodiscard]] std::optional<XmlDocument> next();

 private:
  enum class Markup { start, empty, end, other };

  bool load();
  [[nodiscard]] bool has(std::size_t bytes);
  std::size_t skip_text();
  void skip_past(const char* end, const char* what);
  Markup skip_markup();
  Markup skip_start_tag();
  [[nodiscard]] std::string take();
  void read_root();
  void check_between(std::size_t length);
  void read_end();
  [[noreturn]] void fail(const std::string& what, const std::string& hint) const;

  std::string name_;
  std::uint64_t most_bytes_;
  std::uint64_t bytes_ = 0;
  std::ifstream stream_;
  std::string buffer_;
  std::size_t begin_ = 0;  ///< in the buffer, behind what has been taken
  std::size_t at_ = 0;     ///< in the buffer, behind what has been looked at
  int first_line_ = 1;     ///< at begin_
  std::string root_name_;
  std::optional<XmlDocument> root_;
  bool is_done_ = false;
};

}  // namespace lamella
