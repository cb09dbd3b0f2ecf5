#include <fstream>
#include <gtest/gtest.h>
#include <sstream>

#include "slicing/orient/axis_scan.h"
#include "slicing/orient/least_width.h"
#include "slicing/slicer.h"
#include "tests/support/step_scenes.h"

namespace lamella::test {
namespace {

std::vector<SolidId> sound_solids(const Scene& scene) {
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) {
    if (is_closed(scene.solids[id].info) && scene.solids[id].info.status != SolidStatus::empty) solids.push_back(id);
  }
  return solids;
}

class OrientCorpus : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(OrientCorpus, TheLeastHeightIsProvedAndNeverAboveThePapersScheme) {
  const Scene scene = read_scene(GetParam());
  const SupportFunction support(scene, sound_solids(scene));
  const LeastWidth least = find_least_width(support);
  // Round parts have optima all around; what is proved of them then is stated, not hidden.
  EXPECT_LE(least.gap(), least.cells < LeastWidthLimits{}.max_cells ? 1e-7 : 1e-4);
  EXPECT_LE(least.proved, least.height);
  EXPECT_TRUE(least.converged);
  EXPECT_NEAR(support.width(least.direction), least.height, 1e-9 * least.height);
  const double rounding = 1e-12 * least.height;
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LE(least.height, scan_axes(support, {{Vec3::Unit(axis)}, 1.0}).height + rounding) << "axis " << axis;
  const AxisScan all{{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, 1.0};
  EXPECT_LE(least.height, scan_axes(support, all).height + rounding);
}

std::vector<std::filesystem::path> all_files() {
  std::vector<std::filesystem::path> files = dataset_files();
  for (const auto& list : {sound_corpus_files(), bench_files()}) files.insert(files.end(), list.begin(), list.end());
  return files;
}

INSTANTIATE_TEST_SUITE_P(Files, OrientCorpus, ::testing::ValuesIn(all_files()),
                         [](const auto& file) { return test_name(file.param); });

/// One line of brute_heights.tsv.
struct BruteHeight {
  std::string file;
  double height = 0.0;
};

std::vector<BruteHeight> brute_heights() {
  std::ifstream stream(source_dir() / "tests/slicing/orient/brute_heights.tsv");
  std::vector<BruteHeight> heights;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream cells(line);
    BruteHeight one;
    if (std::getline(cells, one.file, '\t') && cells >> one.height) heights.push_back(one);
  }
  return heights;
}

TEST(OrientBruteForce, OpenCascadeAndAQuarterOfADegreeFindTheSameHeights) {
  LAMELLA_NEEDS_CORPUS();
  const std::vector<BruteHeight> heights = brute_heights();
  ASSERT_GE(heights.size(), 60U);
  for (const BruteHeight& one : heights) {
    std::filesystem::path file = corpus_dir() / one.file;
    if (!std::filesystem::exists(file)) file = datasets_dir() / std::filesystem::path(one.file).stem() / one.file;
    const Scene scene = read_scene(file);
    const LeastWidth least = find_least_width(SupportFunction(scene, sound_solids(scene)));
    EXPECT_NEAR(least.height, one.height, 1e-7 * one.height) << one.file;
  }
}

}  // namespace
}  // namespace lamella::test
