#pragma once

#include <string>
#include <vector>

namespace lamella::apps {

/// Aligned columns for people: a head and rows of cells, numbers to the right.
class TextTable {
 public:
  struct Column {
    std::string head;
    bool is_number = false;
  };

  explicit TextTable(std::vector<Column> columns) : columns_(std::move(columns)) {}

  /// As many cells as there are columns; characters that steer terminals are replaced.
  void add(std::vector<std::string> cells);
  [[nodiscard]] std::string text() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Six significant digits, "-" when it isn't a finite number.
[[nodiscard]] std::string short_number(double value);
/// "1.5 MB"
[[nodiscard]] std::string short_bytes(double bytes);

}  // namespace lamella::apps
