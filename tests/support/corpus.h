#pragma once

#include <fstream>
#include <map>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/paths.h"

namespace lamella::test {

/// One row of the corpus' manifest.tsv.
struct CorpusFile {
  std::string name;
  std::map<std::string, std::string> columns;

  [[nodiscard]] std::filesystem::path path() const { return corpus_dir() / name; }
  [[nodiscard]] const std::string& text(const std::string& column) const { return columns.at(column); }
  /// The column as a number, 0 when it is empty.
  [[nodiscard]] double number(const std::string& column) const {
    const std::string& value = columns.at(column);
    return value.empty() ? 0.0 : std::stod(value);
  }
  [[nodiscard]] bool is_ok() const { return text("group") == "ok"; }
};

inline void PrintTo(const CorpusFile& file, std::ostream* stream) { *stream << file.name; }

/// All rows of the manifest, or none when the corpus isn't there.
inline std::vector<CorpusFile> corpus_files() {
  std::ifstream stream(corpus_dir() / "manifest.tsv");
  const auto split = [](const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream source(line);
    for (std::string cell; std::getline(source, cell, '\t');) cells.push_back(cell);
    return cells;
  };
  std::string line;
  if (!std::getline(stream, line)) return {};
  const std::vector<std::string> header = split(line);
  std::vector<CorpusFile> files;
  while (std::getline(stream, line)) {
    std::vector<std::string> cells = split(line);
    cells.resize(header.size());
    CorpusFile file{cells.front(), {}};
    for (std::size_t i = 0; i < header.size(); ++i) file.columns[header[i]] = cells[i];
    files.push_back(file);
  }
  return files;
}

/// The part of the corpus with one group, "ok" or "bad".
inline std::vector<CorpusFile> corpus_files(const std::string& group) {
  std::vector<CorpusFile> files;
  for (CorpusFile& file : corpus_files()) {
    if (file.text("group") == group) files.push_back(std::move(file));
  }
  return files;
}

/// A file's name as the name of a parameterised test.
inline std::string test_name(const CorpusFile& file) {
  std::string name = file.name;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

}  // namespace lamella::test
