#include "apps/table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "apps/terminal.h"
#include "core/utf8.h"

namespace lamella::apps {

namespace {

/// Characters, which is what most terminals give one column each.
std::size_t width_of(const std::string& text) {
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size(); ++count) at += std::max<std::size_t>(decode_utf8(text, at).length, 1);
  return count;
}

void append_cell(std::string& line, const std::string& cell, std::size_t width, bool to_the_right) {
  const std::string blanks(width - std::min(width, width_of(cell)), ' ');
  line += line.empty() ? "" : "  ";
  line += to_the_right ? blanks + cell : cell + blanks;
}

}  // namespace

void TextTable::add(std::vector<std::string> cells) {
  for (std::string& cell : cells) cell = printable(cell);
  rows_.push_back(std::move(cells));
}

std::string TextTable::text() const {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    widths.push_back(width_of(columns_[c].head));
    for (const auto& row : rows_) widths[c] = std::max(widths[c], width_of(row[c]));
  }
  std::string out;
  const auto append_row = [&](const auto& cell_of) {
    std::string line;
    for (std::size_t c = 0; c < columns_.size(); ++c) append_cell(line, cell_of(c), widths[c], columns_[c].is_number);
    line.erase(line.find_last_not_of(' ') + 1);
    out += line + "\n";
  };
  append_row([this](std::size_t c) { return columns_[c].head; });
  for (const auto& row : rows_) append_row([&row](std::size_t c) { return row[c]; });
  return out;
}

std::string short_number(double value) { return std::isfinite(value) ? fmt::format("{:.6g}", value) : "-"; }

std::string short_bytes(double bytes) {
  constexpr std::array kUnits{"B", "kB", "MB", "GB", "TB", "PB"};
  std::size_t unit = 0;
  for (; bytes >= 1000.0 && unit + 1 < kUnits.size(); ++unit) bytes /= 1000.0;
  return fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

}  // namespace lamella::apps
