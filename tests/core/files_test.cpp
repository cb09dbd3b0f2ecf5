#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/sha256.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

std::string contents(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(AtomicFile, AppearsOnlyWhenCommitted) {
  const test::TemporaryFolder folder;
  const auto target = folder / "result.txt";
  {
    AtomicFile file(target);
    std::ofstream(file.temporary()) << "whole";
    EXPECT_FALSE(std::filesystem::exists(target));
    file.commit();
  }
  EXPECT_EQ(contents(target), "whole");
}

TEST(AtomicFile, LeavesNothingWithoutCommit) {
  const test::TemporaryFolder folder;
  { std::ofstream(AtomicFile(folder / "result.txt").temporary()) << "half"; }
  {
    AtomicFile file(folder / "result.txt");
    std::ofstream(file.temporary()) << "half";
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(AtomicFile, UnwritableTargetIsAnExportError) {
  EXPECT_THROW(write_file_atomically("/proc/nowhere/result.txt", "x"), ExportError);
}

// FIPS 180-4 example: the digest of "abc".
TEST(Sha256, MatchesThePublishedExample) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "abc", "abc");
  EXPECT_EQ(sha256_of_file(folder / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

}  // namespace
}  // namespace lamella
