// The shipped data sets as our own reader and integrals see them, against the manifest's exact values.
#include <cmath>
#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "materials/material_rules.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

using nlohmann::json;

const json& manifest() {
  static const json content = json::parse(std::ifstream(datasets_dir() / "manifest.json"));
  return content;
}

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const json& set : manifest()["datasets"]) result.push_back(set["name"]);
  return result;
}

std::string hex(const Color& color) {
  std::array<char, 8> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "#%02x%02x%02x", static_cast<int>(std::lround(color[0] * 255)),
                static_cast<int>(std::lround(color[1] * 255)), static_cast<int>(std::lround(color[2] * 255)));
  return buffer.data();
}

class DatasetScene : public testing::TestWithParam<std::string> {
 protected:
  static const json& entry() {
    for (const json& set : manifest()["datasets"])
      if (set["name"] == GetParam()) return set;
    throw std::logic_error("no such data set");
  }
  static Scene read() {
    const std::filesystem::path file = datasets_dir() / entry()["file"].get<std::string>();
    return read_step({&file, 1});
  }
};

TEST_P(DatasetScene, NamesColoursMaterialsAndUnitAreThoseOfTheManifest) {
  const Scene scene = read();
  ASSERT_EQ(scene.solids.size(), entry()["solids"].size());
  EXPECT_NEAR(scene.files[0].unit_in_mm, entry()["unit"] == "inch" ? 25.4 : 1.0, 1e-12);
  std::size_t i = 0;
  for (const Solid& solid : scene.solids) {
    const json& expected = entry()["solids"][i++];
    const SolidInfo& info = solid.info;
    EXPECT_EQ(info.name, expected["name"]);
    EXPECT_EQ(info.step_material, expected["step_material"]) << info.name;
    ASSERT_TRUE(info.step_density) << info.name;
    EXPECT_NEAR(*info.step_density, expected["density"].get<double>(), 1e-9) << info.name;
    ASSERT_TRUE(info.color) << info.name;
    EXPECT_EQ(hex(*info.color), expected["color"]) << info.name;
    EXPECT_EQ(info.status, SolidStatus::ok) << info.name;
    EXPECT_EQ(solid.shells.count, expected["shells"].get<unsigned>()) << info.name;
  }
}

TEST_P(DatasetScene, ReadsWithoutWarnings) {
  const Scene scene = read();
  for (const Finding& finding : scene.findings) {
    if (finding.severity == Severity::note) continue;
    ADD_FAILURE() << finding.solid << " " << finding.face << " " << finding.entity << ": " << finding.what;
  }
}

TEST_P(DatasetScene, MaterialFileCoversEverySolidWithTheManifestsMaterialAndPriority) {
  const Scene scene = read();
  const MaterialRules rules = read_material_rules(datasets_dir() / entry()["materials"].get<std::string>());
  const MaterialTable table = assign_materials(scene, rules);
  ASSERT_EQ(table.assignments.size(), entry()["solids"].size());
  for (std::size_t i = 0; i < scene.solids.size(); ++i) {
    const json& expected = entry()["solids"][i];
    const Assignment& assigned = table.assignments[SolidId(i)];
    EXPECT_EQ(table.materials[assigned.material].name, expected["step_material"]);
    EXPECT_EQ(assigned.priority, expected["priority"].get<int>());
  }
}

TEST_P(DatasetScene, OurVolumesAreTheExactOnes) {
  const Scene scene = read();
  ASSERT_EQ(scene.solids.size(), entry()["solids"].size());
  for (std::size_t i = 0; i < scene.solids.size(); ++i) {
    const json& expected = entry()["solids"][i];
    const double exact = expected["volume"], bound = expected["relative_bound"];
    const SolidMeasure measure = measure_solid(scene, SolidId(i), 1e-10);
    EXPECT_TRUE(measure.converged) << expected["name"];
    EXPECT_NEAR(measure.volume / exact, 1.0, std::max(1e-9, bound)) << expected["name"];
  }
}

INSTANTIATE_TEST_SUITE_P(All, DatasetScene, testing::ValuesIn(names()), [](const auto& set) { return set.param; });

// OpenCASCADE 7.6 reads a mirror placement as a rotation.
TEST(MirroredBrackets, RightArmIsTheMirrorImageOfTheLeft) {
  const std::filesystem::path file = datasets_dir() / "mirrored_brackets" / "mirrored_brackets.step";
  const Scene scene = read_step({&file, 1});
  const auto measures = measure_solids(scene);
  ASSERT_EQ(measures.size(), 8u);
  for (std::size_t i = 0; i < 4; ++i) {
    const Box3& left = measures[SolidId(i)].bounds;
    const Box3& right = measures[SolidId(i + 4)].bounds;
    EXPECT_NEAR(left.min().x(), -right.max().x(), 1e-9);
    EXPECT_NEAR(left.max().x(), -right.min().x(), 1e-9);
    EXPECT_NEAR(left.min().y(), right.min().y(), 1e-9);
    EXPECT_NEAR(left.max().z(), right.max().z(), 1e-9);
  }
}

}  // namespace
}  // namespace lamella::test
