#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string>
#include <vector>

#include "model/step/read_step.h"
#include "tests/support/corpus.h"
#include "tests/support/paths.h"

/// STEP files as scenes for tests of slicing.
namespace lamella::test {

inline Scene read_scene(const std::filesystem::path& file) {
  const std::array<std::filesystem::path, 1> files{file};
  return read_step(files);
}

/// The project's own data sets, by name.
inline std::vector<std::filesystem::path> dataset_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(datasets_dir())) {
    const std::filesystem::path file = entry.path() / (entry.path().filename().string() + ".step");
    if (std::filesystem::exists(file)) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The models of the benchmark, outside of the repository.
inline std::vector<std::filesystem::path> bench_files() {
  std::vector<std::filesystem::path> files;
  const std::filesystem::path folder = corpus_dir().parent_path() / "bench";
  if (!std::filesystem::exists(folder)) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".step") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// The sound part of the corpus.
inline std::vector<std::filesystem::path> sound_corpus_files() {
  std::vector<std::filesystem::path> files;
  for (const CorpusFile& file : corpus_files("ok")) files.push_back(file.path());
  return files;
}

/// A file as the name of a parameterised test.
inline std::string test_name(const std::filesystem::path& file) {
  std::string name = file.stem().string();
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  }
  return name;
}

}  // namespace lamella::test
