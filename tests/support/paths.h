#pragma once

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <random>
#include <string>

/// Where tests find their inputs and put their outputs.
namespace lamella::test {

inline std::filesystem::path source_dir() { return LAMELLA_SOURCE_DIR; }
inline std::filesystem::path datasets_dir() { return source_dir() / "datasets"; }

/// Third-party STEP files that stay outside the repository; LAMELLA_STEP_DIR overrides the place.
inline std::filesystem::path corpus_dir() {
  if (const char* folder = std::getenv("LAMELLA_STEP_DIR")) return folder;
  return source_dir().parent_path() / "shared" / "step";
}

/// A fresh folder that is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lamella-test-XXXXXX").string();
    path_ = ::mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

}  // namespace lamella::test

/// Skips the test with a message when the third-party STEP files aren't there.
#define LAMELLA_NEEDS_CORPUS()                                                \
  if (!std::filesystem::exists(lamella::test::corpus_dir() / "manifest.tsv")) \
  GTEST_SKIP() << "no STEP corpus at " << lamella::test::corpus_dir() << " (set LAMELLA_STEP_DIR)"
