#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> dataset_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(source_dir() / "datasets")) {
    const std::string name = entry.path().filename().string();
    if (fs::exists(entry.path() / (name + ".step"))) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Options for a lattice of some 60 columns, 45 rows and 20 layers over the solids of a file.
std::string small_lattice(const fs::path& step) {
  const auto info = nlohmann::json::parse(run_lamella("info " + quoted(step) + " --json").output);
  std::array<double, 3> low{1e9, 1e9, 1e9};
  std::array<double, 3> high{-1e9, -1e9, -1e9};
  for (const auto& solid : info["solids"]) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], solid["bounds"][0][axis].get<double>());
      high[axis] = std::max(high[axis], solid["bounds"][1][axis].get<double>());
    }
  }
  std::ostringstream options;
  options << "--pitch " << (high[0] - low[0]) / 59.5 << ',' << (high[1] - low[1]) / 44.7 << " --layer-height "
          << (high[2] - low[2]) / 19.6;
  return options.str();
}

class DatasetFormats : public ::testing::TestWithParam<std::string> {};

/// Slices a data set into all formats of labels and compares them.
void expect_equal_formats(const std::string& name, const char* materials, const std::string& more, const char* kind) {
  const fs::path data = source_dir() / "datasets" / name;
  const TemporaryFolder folder;
  const fs::path step = data / (name + ".step");
  std::string line = "slice " + quoted(step) + " --materials " + quoted(data / materials) + " -o " +
                     quoted(folder / "build") + " --quiet " + small_lattice(step) + more;
  for (const char* format : {"png", "png-indexed", "sl1"}) {
    line += std::string(" --") + format + " " + quoted(folder / format);
  }
  line += " --tiff " + quoted(folder / "a.tif") + " --nrrd " + quoted(folder / "a.nrrd") + " --mhd " +
          quoted(folder / "a.mhd") + " --vti " + quoted(folder / "a.vti") + " --vdb " + quoted(folder / "a.vdb");
  const CommandResult slice = run_lamella(line);
  ASSERT_TRUE(slice.exit_code == 0 || slice.exit_code == 3) << slice.errors;
  const CommandResult compared =
      run_command("/usr/bin/python3 " + quoted(source_dir() / "tests/datasets/compare_formats.py") + " " +
                  quoted(folder / "build") + " " + quoted(folder.path()) + kind);
  ASSERT_EQ(compared.exit_code, 0) << compared.errors;
  ASSERT_EQ(compared.output.find("png-indexed\na.tif\na.nrrd\na.mhd\na.vti\na.vdb\nsl1\nvoxels "), 0U)
      << compared.output;
  // A build without material would compare nothing.
  std::istringstream counts(compared.output.substr(compared.output.rfind("voxels") + 6));
  std::int64_t voxels = 0;
  for (std::int64_t count = 0; counts >> count;) voxels += count;
  EXPECT_GT(voxels, 500);
}

TEST_P(DatasetFormats, EveryVoxelOfEveryFormatIsThatOfTheSegments) {
  expect_equal_formats(GetParam(), "materials.xml", "", "");
}

TEST(DitheredFormats, HaveTheSameVoxelsOfPlainMaterials) {
  expect_equal_formats("gradient_lens", "graded.xml", " --dither", " dithered");
}

INSTANTIATE_TEST_SUITE_P(All, DatasetFormats, ::testing::ValuesIn(dataset_names()),
                         [](const auto& dataset) { return dataset.param; });

}  // namespace
}  // namespace lamella::test
