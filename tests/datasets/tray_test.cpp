// Trays: how copies are laid out, and that our own reader finds every one of them in the file that the program writes.
#include "datasets/generator/tray.h"

#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "datasets/generator/catalog.h"
#include "materials/material_rules.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "slicing/copies.h"
#include "tests/support/paths.h"

namespace lamella::datasets {
namespace {

using nlohmann::json;
using test::datasets_dir;
using test::TemporaryFolder;
using testing::ElementsAre;

json manifest_entry(const std::string& name) {
  const json manifest = json::parse(std::ifstream(datasets_dir() / "manifest.json"));
  for (const json& set : manifest["datasets"])
    if (set["name"] == name) return set;
  throw std::logic_error("no such data set");
}

int run_program(const std::string& arguments) {
  const std::string command = "\"" LAMELLA_DATASETS_PROGRAM "\" " + arguments;
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct TrayCase {
  std::string name;
  std::array<double, 3> size;
  std::array<int, 3> copies;
  friend void PrintTo(const TrayCase& tray, std::ostream* out) { *out << tray.name; }
};

class TrayFile : public testing::TestWithParam<TrayCase> {
 protected:
  [[nodiscard]] std::filesystem::path write() const {
    std::ostringstream arguments;
    arguments << "--tray " << GetParam().name << " --size";
    for (const double size : GetParam().size) arguments << ' ' << size;
    const std::filesystem::path file = folder_ / "tray.step";
    arguments << " --gap 2 \"" << file.string() << "\" > \"" << (folder_ / "log").string() << '"';
    EXPECT_EQ(run_program(arguments.str()), 0);
    return file;
  }
  TemporaryFolder folder_;
};

TEST_P(TrayFile, HoldsEverySolidOfEveryCopyWithItsVolumeAndMaterial) {
  const std::filesystem::path file = write();
  const Scene scene = read_step({&file, 1});
  const json set = manifest_entry(GetParam().name);
  const json& solids = set["solids"];
  const auto copies = static_cast<std::size_t>(GetParam().copies[0] * GetParam().copies[1] * GetParam().copies[2]);
  ASSERT_GT(copies, 1u);
  ASSERT_EQ(scene.solids.size(), copies * solids.size());
  const MaterialTable table = assign_materials(scene, read_material_rules(folder_ / "materials.xml"));
  const auto measures = measure_solids(scene);
  std::set<std::string> paths;
  Box3 bounds;
  for (const SolidId id : scene.solids.ids()) {
    const json& expected = solids[id.value() % solids.size()];
    EXPECT_EQ(scene.solids[id].info.name, expected["name"]);
    EXPECT_EQ(scene.solids[id].info.status, SolidStatus::ok);
    EXPECT_EQ(table.materials[table.assignments[id].material].name, expected["step_material"]);
    EXPECT_EQ(table.assignments[id].priority, expected["priority"].get<int>());
    EXPECT_NEAR(measures[id].volume / expected["volume"].get<double>(), 1.0, 1e-7) << expected["name"];
    paths.insert(scene.solids[id].info.path);
    bounds.extend(measures[id].bounds);
  }
  EXPECT_EQ(paths.size(), scene.solids.size());
  for (int axis = 0; axis < 3; ++axis) {
    const double size = GetParam().size[static_cast<std::size_t>(axis)];
    EXPECT_NEAR(bounds.min()[axis], 0.0, 1e-6);
    if (GetParam().copies[static_cast<std::size_t>(axis)] > 1) {
      EXPECT_NEAR(bounds.max()[axis], size, 1e-6);
    } else {
      EXPECT_LE(bounds.max()[axis], size + 1e-6);
    }
  }
}

TEST_P(TrayFile, KeepsCopiesApartByTheGap) {
  const std::filesystem::path file = write();
  const Scene scene = read_step({&file, 1});
  const auto measures = measure_solids(scene);
  const std::size_t solids = manifest_entry(GetParam().name)["solids"].size();
  std::vector<Box3> boxes(scene.solids.size() / solids);
  for (const SolidId id : scene.solids.ids()) boxes[id.value() / solids].extend(measures[id].bounds);
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const Vec3 apart = (boxes[a].min() - boxes[b].max()).cwiseMax(boxes[b].min() - boxes[a].max());
      EXPECT_GE(apart.maxCoeff(), 2.0 - 1e-6);
    }
  }
}

TEST_P(TrayFile, IsRecognisedAsCopiesWhereverSolidsAreApart) {
  const std::filesystem::path file = write();
  const Scene scene = read_step({&file, 1});
  std::vector<SolidId> solids;
  for (const SolidId id : scene.solids.ids()) solids.push_back(id);
  std::size_t copied = 0;
  for (const CopiedCluster& cluster : find_copies(scene, measure_solids(scene), solids))
    copied += cluster.copies.size() * cluster.copies.front().solids.size();
  EXPECT_EQ(copied, solids.size());
}

// Unturned, turned, in inches, and with an instance that is a mirror image.
INSTANTIATE_TEST_SUITE_P(All, TrayFile,
                         testing::Values(TrayCase{"bone_screw", {60, 40, 40}, {3, 2, 1}},
                                         TrayCase{"overmoulded_grip", {80, 160, 40}, {2, 1, 1}},
                                         TrayCase{"connector", {50, 12, 12}, {3, 1, 1}},
                                         TrayCase{"mirrored_brackets", {120, 60, 30}, {1, 2, 2}}),
                         [](const auto& tray) { return tray.param.name; });

TEST(Tray, TurnsThePartSoThatMostFit) {
  // The screw is 18 x 18 x 33 mm.
  const DataSet screw = bone_screw();
  EXPECT_THAT(make_tray(screw, {{33, 18, 18}, 2}).copies, ElementsAre(1, 1, 1));
  EXPECT_THAT(make_tray(screw, {{18, 33, 38}, 2}).copies, ElementsAre(1, 1, 2));
  const Tray lying = make_tray(screw, {{70, 19, 40}, 2});
  EXPECT_THAT(lying.copies, ElementsAre(2, 1, 2));
  EXPECT_NEAR(lying.part_size[0], 33, 1e-6);
  EXPECT_NEAR(lying.distance[0], 4, 1e-6);
  EXPECT_EQ(lying.distance[1], 0);
}

TEST(Tray, SharesOneAssemblyAmongItsCopies) {
  const Tray tray = make_tray(overmoulded_grip(), {{490, 390, 200}, 2});
  EXPECT_EQ(tray.count(), 165);
  EXPECT_EQ(tray.set.shared.size(), 1u);
  EXPECT_EQ(tray.set.root.children.size(), 165u);
  EXPECT_EQ(walk(tray.set).size(), 1155u);
  EXPECT_EQ(tray.set.overlaps.size(), 495u);
}

TEST(Tray, RefusesWhatCantBe) {
  const DataSet screw = bone_screw();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW((void)make_tray(screw, {{10, 390, 200}, 2}), std::invalid_argument);
  EXPECT_THROW((void)make_tray(screw, {{0, 390, 200}, 2}), std::invalid_argument);
  EXPECT_THROW((void)make_tray(screw, {{490, 390, 200}, -1}), std::invalid_argument);
  EXPECT_THROW((void)make_tray(screw, {{490, kNan, 200}, 2}), std::invalid_argument);
  EXPECT_THROW((void)make_tray(screw, {{490, 390, 200}, kNan}), std::invalid_argument);
  EXPECT_THROW((void)make_tray(screw, {{1e9, 1e9, 1e9}, 2}), std::invalid_argument);
}

TEST(TrayProgram, ExplainsItselfAndItsUsage) {
  EXPECT_EQ(run_program("--help > /dev/null"), 0);
  EXPECT_EQ(run_program("2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray nothing --size 9 9 9 out.step 2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray bone_screw --size 9 9 out.step 2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray bone_screw --size 9 9 9 out.step 2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray bone_screw --size 90 90 90 2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray bone_screw --gap x --size 90 90 90 out.step 2> /dev/null"), 1);
  EXPECT_EQ(run_program("--tray bone_screw --size 90 90 90 /dev/null/out.step 2> /dev/null"), 4);
}

}  // namespace
}  // namespace lamella::datasets
