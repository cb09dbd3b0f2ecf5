#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "tests/slicing/contact/touching_solids.h"
#include "tests/support/step_scenes.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

constexpr double kRows = 120.0;
constexpr double kLayers = 40.0;
/// command.md: two solids touch within the larger of their faces' own tolerances, at least this (mm).
constexpr double kLeastTolerance = 1e-6;

/// Data sets whose solids touch, and the files of the corpus of which its manifest says so.
std::vector<fs::path> touching_files() {
  std::vector<fs::path> files;
  for (const fs::path& file : test::dataset_files()) {
    const std::string name = file.stem().string();
    if (name == "touching_boxes" || name == "nested_spheres" || name == "connector") files.push_back(file);
  }
  for (const test::CorpusFile& file : test::corpus_files("ok")) {
    if (file.number("pairs_touching") > 0.0) files.push_back(file.path());
  }
  return files;
}

/// What any two faces of the solid and of another one may be apart and still touch, at the least.
double least_tolerance(const Scene& scene, SolidId solid) {
  double least = std::numeric_limits<double>::infinity();
  for (const Face& face : scene.faces) {
    if (scene.shells[face.shell].solid == solid) least = std::min(least, face.tolerance);
  }
  return std::max(least, kLeastTolerance);
}

struct Flaws {
  std::size_t neighbours = 0;  ///< segments of different solids that meet
  std::size_t holes = 0;       ///< runs of void between different solids that are no longer than both may be apart
  std::size_t slivers = 0;     ///< segments no longer than that between two others
};

class FlawCounter {
 public:
  explicit FlawCounter(const Scene& scene) {
    for (const SolidId id : scene.solids.ids()) tolerance_.push_back(least_tolerance(scene, id));
  }

  void count(const SegmentRows& rows, Flaws& flaws) const {
    for (std::size_t r = 0; r < rows.rows(); ++r) {
      const auto row = rows.row(r);
      for (std::size_t i = 0; i + 1 < row.size(); ++i) {
        if (row[i].solid == row[i + 1].solid) continue;
        const double open = row[i + 1].x_begin - row[i].x_end;
        const double tolerance = std::max(tolerance_[row[i].solid.value()], tolerance_[row[i + 1].solid.value()]);
        flaws.neighbours += open == 0.0 ? 1 : 0;
        flaws.holes += open > 0.0 && open <= tolerance ? 1 : 0;
        if (open != 0.0 || i + 2 >= row.size() || row[i + 2].x_begin != row[i + 1].x_end) continue;
        const double length = row[i + 1].x_end - row[i + 1].x_begin;
        flaws.slivers += length <= tolerance ? 1 : 0;
      }
    }
  }

 private:
  std::vector<double> tolerance_;
};

class TouchingFile : public ::testing::TestWithParam<fs::path> {
 protected:
  /// Counts over raster and hatch rows. `report` is that of the run.
  static Flaws slice_and_count(const Scene& scene, SliceReport& report) {
    Box3 bounds;
    for (const SolidMeasure& measure : measure_solids(scene)) bounds.extend(measure.bounds);
    PlanOptions plan;
    plan.pitch = Vec2::Constant(bounds.sizes().head<2>().maxCoeff() / kRows);
    plan.layer_height = bounds.sizes().z() / kLayers;
    plan.hatch = HatchLattice{plan.pitch->y(), 0.53, 1.17};
    const test::SlicedScene sliced = test::slice_scene(scene, test::one_material_each(scene), plan, {});
    report = sliced.report;
    const FlawCounter counter(scene);
    Flaws flaws;
    for (const Layer& layer : sliced.layers) {
      counter.count(layer.raster, flaws);
      counter.count(layer.hatch->rows, flaws);
    }
    return flaws;
  }
};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(TouchingFile);

TEST_P(TouchingFile, HasNeitherHolesNorSliversAtItsInterfaces) {
  SliceReport report;
  const Flaws flaws = slice_and_count(test::read_scene(GetParam()), report);
  EXPECT_EQ(flaws.holes, 0U);
  EXPECT_EQ(flaws.slivers, 0U);
}

/// So that no interface is horizontal, and rows cross all of them.
TEST_P(TouchingFile, HasNoneWhenItIsTurned) {
  SliceReport report;
  const auto turned = test::Placement::turned(Vec3(0.6, 0.48, 0.64), std::numbers::pi / 6.0);
  const Flaws flaws = slice_and_count(test::placed(test::read_scene(GetParam()), turned), report);
  EXPECT_EQ(flaws.holes, 0U);
  EXPECT_EQ(flaws.slivers, 0U);
  EXPECT_EQ(flaws.neighbours > 0, !report.interfaces.empty() || !report.overlaps.empty());
}

INSTANTIATE_TEST_SUITE_P(All, TouchingFile, ::testing::ValuesIn(touching_files()),
                         [](const auto& param) { return test::test_name(param.param); });

}  // namespace
}  // namespace lamella
