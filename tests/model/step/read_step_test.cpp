#include "model/step/read_step.h"

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <atomic>
#include <cstdlib>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <set>

#include "model/measure.h"
#include "tests/model/step/step_files.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

Scene read(const std::filesystem::path& path, const Progress& progress = {}) {
  return read_step(std::vector<std::filesystem::path>{path}, {}, progress);
}

/// What reading complains about; empty when it succeeds.
std::string complaint(const std::filesystem::path& path, const StepOptions& options = {}) {
  try {
    (void)read_step(std::vector<std::filesystem::path>{path}, options);
  } catch (const InputError& error) {
    return std::string(error.what()) + " (" + error.where() + ")";
  }
  return {};
}

class ReadStep : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return folder_ / name; }

  /// A box of 3 x 4 x 5 mm in a file of its own.
  [[nodiscard]] std::filesystem::path box_file() const {
    test::write_step(path("box.step"), {{BRepPrimAPI_MakeBox(3, 4, 5).Shape(), "box"}});
    return path("box.step");
  }
  /// The same file with its text changed.
  [[nodiscard]] std::filesystem::path edited(const std::string& from, const std::string& to) const {
    test::write_text(path("edited.step"), test::replaced(test::read_text(box_file()), from, to));
    return path("edited.step");
  }

  test::TemporaryFolder folder_;
};

TopLoc_Location moved(double x) {
  gp_Trsf trsf;
  trsf.SetTranslation(gp_Vec(x, 0, 0));
  return trsf;
}

TEST_F(ReadStep, GivesEveryInstanceGeometryAndAPathOfItsOwn) {
  const TopoDS_Shape box = BRepPrimAPI_MakeBox(3, 4, 5).Shape();
  const TopoDS_Shape pin = BRepPrimAPI_MakeCylinder(1, 9).Shape();
  test::write_step(path("assembly.step"), {{box, "body"}, {pin, "pin"}, {pin.Moved(moved(10)), "pin"}});
  const Scene scene = read(path("assembly.step"));
  ASSERT_EQ(scene.solids.size(), 3U);
  EXPECT_EQ(scene.solids[SolidId{0}].info.path, "/assembly/body");
  EXPECT_EQ(scene.solids[SolidId{1}].info.path, "/assembly/pin.1");
  EXPECT_EQ(scene.solids[SolidId{2}].info.path, "/assembly/pin.2");
  EXPECT_EQ(scene.solids[SolidId{2}].info.name, "pin");
  EXPECT_EQ(scene.faces.size(), 6U + 3U + 3U);
  EXPECT_NEAR(measure_solid(scene, SolidId{2}).bounds.min().x(), 9.0, 1e-9);
  EXPECT_THAT(scene.findings, IsEmpty());
}

TEST_F(ReadStep, ReadsSeveralFilesAsOneAssembly) {
  const auto file = box_file();
  const Scene scene = read_step(std::vector<std::filesystem::path>{file, file});
  ASSERT_EQ(scene.files.size(), 2U);
  ASSERT_EQ(scene.solids.size(), 2U);
  EXPECT_EQ(scene.solids[SolidId{1}].info.file, 1U);
  EXPECT_NE(scene.solids[SolidId{0}].info.path, scene.solids[SolidId{1}].info.path);
  EXPECT_EQ(scene.files[0].sha256.size(), 64U);
  EXPECT_EQ(scene.files[0].schema, "AP214");
}

TEST_F(ReadStep, PlacesCopiesOfOneFile) {
  Motion turned;
  turned.turn << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  turned.shift = {10.0, 0.0, 2.0};
  const std::vector<StepPart> parts{{box_file(), "copy", {Motion{}, turned}}, {box_file(), ""}};
  const Scene scene = read_step_parts(parts);
  ASSERT_EQ(scene.files.size(), 2U);
  ASSERT_EQ(scene.solids.size(), 3U);
  const auto path_of = [&](std::size_t i) { return scene.solids[SolidId{i}].info.path; };
  EXPECT_THAT(path_of(0), StartsWith("/copy.1/"));
  EXPECT_EQ(path_of(1), "/copy.2" + path_of(0).substr(7));
  EXPECT_EQ(path_of(2), path_of(0).substr(7));
  const Box3 first = measure_solid(scene, SolidId{0}).bounds;
  const Box3 second = measure_solid(scene, SolidId{1}).bounds;
  const Vec3 expected_min(10.0 - first.max().y(), first.min().x(), first.min().z() + 2.0);
  EXPECT_NEAR((second.min() - expected_min).norm(), 0.0, 1e-12);
  EXPECT_NEAR(second.sizes().x(), first.sizes().y(), 1e-12);
  const auto& instance = scene.solids[SolidId{1}].info.instance;
  ASSERT_TRUE(instance);
  EXPECT_EQ(instance->body, scene.solids[SolidId{0}].info.instance->body);
  EXPECT_LT((instance->shift - turned.shift).norm(), 1e-12);
}

TEST_F(ReadStep, RefusesPlacementsThatAreNoRigidMotion) {
  Motion scaled;
  scaled.turn *= 2.0;
  Motion mirrored;
  mirrored.turn(0, 0) = -1.0;
  Motion far;
  far.shift.x() = std::numeric_limits<double>::infinity();
  for (const Motion& motion : {scaled, mirrored, far}) {
    const std::vector<StepPart> parts{{box_file(), "", {motion}}};
    EXPECT_THROW((void)read_step_parts(parts), InputError);
  }
  const std::vector<StepPart> many{{box_file(), "", std::vector<Motion>(kMaxPlacements + 1)}};
  EXPECT_THROW((void)read_step_parts(many), InputError);
}

TEST_F(ReadStep, ReadsColorLayerMaterialAndDensity) {
  test::write_part(path("part.step"), BRepPrimAPI_MakeBox(1, 1, 1).Shape(), "clip", {0.25, 0.5, 0.75}, "inserts",
                   {"Steel", 7.9});
  const Scene scene = read(path("part.step"));
  ASSERT_EQ(scene.solids.size(), 1U);
  const SolidInfo& info = scene.solids[SolidId{0}].info;
  EXPECT_EQ(info.name, "clip");
  ASSERT_TRUE(info.color);
  EXPECT_NEAR((*info.color)[0], 0.25, 1e-3);
  EXPECT_NEAR((*info.color)[2], 0.75, 1e-3);
  EXPECT_EQ(info.layer, "inserts");
  EXPECT_EQ(info.step_material, "Steel");
  ASSERT_TRUE(info.step_density);
  EXPECT_NEAR(*info.step_density, 7.9, 1e-9) << "the import itself says 0.0079";
}

TEST_F(ReadStep, ConvertsEveryLengthUnitToMillimetres) {
  const std::string from = "SI_UNIT(.MILLI.,.METRE.)";
  const std::vector<std::pair<std::string, double>> units = {
      {"SI_UNIT($,.METRE.)", 1000.0}, {"SI_UNIT(.CENTI.,.METRE.)", 10.0}, {"SI_UNIT(.MICRO.,.METRE.)", 1e-3}};
  for (const auto& [unit, factor] : units) {
    const Scene scene = read(edited(from, unit));
    EXPECT_DOUBLE_EQ(scene.files.at(0).unit_in_mm, factor) << unit;
    EXPECT_NEAR(measure_solid(scene, SolidId{0}).bounds.sizes().z(), 5.0 * factor, 1e-7 * factor) << unit;
  }
}

TEST_F(ReadStep, MakesNamesOfAnyEncodingUtf8) {
  const std::vector<std::pair<std::string, std::string>> names = {{"K\\X\\F6rper", "K\xC3\xB6rper"},
                                                                  {"\\X2\\03B1\\X0\\-part", "\xCE\xB1-part"},
                                                                  {"K\xC3\xB6rper", "K\xC3\xB6rper"},
                                                                  {"K\xF6rper", "K\xC3\xB6rper"},
                                                                  {"a/b", "a/b"}};
  for (const auto& [written, expected] : names) {
    const Scene scene = read(edited("'box'", "'" + written + "'"));
    EXPECT_EQ(scene.solids[SolidId{0}].info.name, expected) << written;
  }
  EXPECT_EQ(read(path("edited.step")).solids[SolidId{0}].info.path.find("/a_b"), 0U);
}

TEST_F(ReadStep, NamesAnOpenShellThatTheImportWouldClose) {
  const Scene scene = read(edited("CLOSED_SHELL", "OPEN_SHELL"));
  ASSERT_EQ(scene.solids.size(), 1U);
  ASSERT_FALSE(scene.findings.empty());
  EXPECT_THAT(scene.findings[0].what, HasSubstr("OPEN_SHELL"));
  EXPECT_THAT(scene.findings[0].entity, HasSubstr("#"));
  EXPECT_EQ(scene.findings[0].solid, "/box");
}

TEST_F(ReadStep, NamesAMissingFaceAndLeavesTheSolidOpen) {
  const std::string text = test::read_text(box_file());
  const std::size_t shell = text.find("CLOSED_SHELL(''");
  const std::size_t comma = text.find(',', text.find(',', shell) + 1);
  const std::size_t last = text.find("));", comma);
  test::write_text(path("open.step"), text.substr(0, comma) + text.substr(last));
  const Scene scene = read(path("open.step"));
  ASSERT_EQ(scene.solids.size(), 1U);
  EXPECT_FALSE(scene.solids[SolidId{0}].info.closed);
  EXPECT_NE(scene.solids[SolidId{0}].info.status, SolidStatus::ok);
  EXPECT_FALSE(scene.findings.empty());
}

TEST_F(ReadStep, ReportsItsStagesFromTheFirstSecondOn) {
  std::set<std::string> stages;
  bool in_range = true;
  (void)read(box_file(), Progress([&](std::string_view stage, double fraction) {
               stages.emplace(stage);
               in_range = in_range && fraction <= 1.0;
             }));
  EXPECT_EQ(stages, (std::set<std::string>{"converting", "reading", "transferring"}));
  EXPECT_TRUE(in_range);
}

TEST_F(ReadStep, EndsWhenCancelledInAnyStage) {
  const auto file = box_file();
  for (const std::string stage : {"reading", "transferring", "converting"}) {
    std::atomic<bool> cancel = false;
    const Progress progress([&](std::string_view now, double) { cancel = cancel || now == stage; }, &cancel);
    EXPECT_THROW((void)read(file, progress), Cancelled) << stage;
  }
  EXPECT_EQ(read(file).solids.size(), 1U) << "and reads again afterwards";
}

TEST_F(ReadStep, RefusesWhatIsNoFileOrTooLarge) {
  EXPECT_THAT(complaint(path("missing.step")), HasSubstr("no such file"));
  EXPECT_THAT(complaint(folder_.path()), HasSubstr("not a regular file"));
  EXPECT_THAT(complaint("/dev/zero"), HasSubstr("not a regular file"));
  StepOptions small;
  small.max_bytes = 100;
  EXPECT_THAT(complaint(box_file(), small), HasSubstr("more than the limit of 100"));
  StepOptions few;
  few.max_faces = 5;
  EXPECT_THAT(complaint(box_file(), few), HasSubstr("more than 5 faces"));
  EXPECT_THROW((void)read_step({}), InputError);
}

TEST_F(ReadStep, RefusesAFileCutShortAnywhere) {
  const std::string text = test::read_text(box_file());
  for (const double part : {0.0, 0.01, 0.3, 0.6, 0.9, 0.99}) {
    test::write_text(path("short.step"),
                     text.substr(0, static_cast<std::size_t>(part * static_cast<double>(text.size()))));
    EXPECT_NE(complaint(path("short.step")), "") << part;
  }
}

TEST_F(ReadStep, RefusesNumbersThatAreNone) {
  const std::string text = test::read_text(box_file());
  for (const char* number : {"1.E400", "-1.E309", "NAN", "1.E", "--3.", "5.E99999999999"}) {
    std::string bad = text;
    const std::size_t at = bad.find("(3.,");
    ASSERT_NE(at, std::string::npos);
    bad.replace(at + 1, 2, number);
    test::write_text(path("bad.step"), bad);
    EXPECT_THAT(complaint(path("bad.step")), HasSubstr("CARTESIAN_POINT: an attribute is no value")) << number;
  }
}

TEST_F(ReadStep, SurvivesRandomDamage) {
  const std::string text = test::read_text(box_file());
  const std::size_t data = text.find("DATA;");
  const char* seed = std::getenv("LAMELLA_TEST_SEED");
  std::mt19937 random(seed == nullptr ? 11U : static_cast<unsigned>(std::atoi(seed)));
  int read_all = 0;
  for (int i = 0; i < 60; ++i) {
    std::string bad = text;
    for (int k = 0; k < 1 + i % 4; ++k) {
      const std::size_t at = data + random() % (text.size() - data);
      if (random() % 2 == 0) {
        bad[at] = static_cast<char>(random() % 256);
      } else {
        bad[at] = "0123456789#(),'$*.;"[random() % 19];
      }
    }
    test::write_text(path("bad.step"), bad);
    try {
      read_all += read(path("bad.step")).solids.empty() ? 0 : 1;
    } catch (const Error& error) {
      EXPECT_STRNE(error.what(), "");
    }
  }
  EXPECT_GT(read_all, 0);
}

TEST_F(ReadStep, NeverOpensOtherFiles) {
  (void)box_file();
  test::write_text(path("outer.step"),
                   test::replaced(test::read_text(std::filesystem::path(box_file())), "ENDSEC;\nEND-ISO",
                                  "#9001=DOCUMENT_FILE('box.step','','',$,'',$);\n"
                                  "#9002=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('box.step',$,$,(#9001));\n"
                                  "ENDSEC;\nEND-ISO"));
  EXPECT_EQ(read(path("outer.step")).solids.size(), 1U) << "its own box and not the other file's";
}

}  // namespace
}  // namespace lamella
