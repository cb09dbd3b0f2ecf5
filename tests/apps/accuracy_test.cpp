#include <algorithm>
#include <gmock/gmock.h>
#include <sstream>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

/// The study that most tests look at, made once.
class Accuracy : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    result_ = new CommandResult(run_lamella("accuracy " + spheres() + " --deflections 0.1,1,1e-6 --rays 5000" +
                                            " --max-triangles 100000 -o " + quoted(*folder_ / "page.html") + " --csv " +
                                            quoted(*folder_ / "a.csv") + " --json"));
  }
  static void TearDownTestSuite() {
    delete result_;
    delete folder_;
  }

  static const TemporaryFolder& folder() { return *folder_; }
  static const CommandResult& result() { return *result_; }

 private:
  static TemporaryFolder* folder_;
  static CommandResult* result_;
};

TemporaryFolder* Accuracy::folder_ = nullptr;
CommandResult* Accuracy::result_ = nullptr;

TEST_F(Accuracy, HasTheContractsKeys) {
  ASSERT_EQ(result().exit_code, 0) << result().errors;
  const Json report = parse_output(result());
  expect_keys(report, {"direct", "stl", "lattices", "volume", "file_tolerance", "pitch"});
  expect_keys(report["direct"],
              {"rays", "hits", "time", "max_error", "rms_error", "missed", "false", "oracle_rays", "occt"});
  expect_keys(report["direct"]["occt"], {"rays", "odd_rays", "max_error", "missed", "false"});
  ASSERT_EQ(report["stl"].size(), 3U);
  for (const Json& stl : report["stl"]) {
    expect_keys(stl, {"deflection", "triangles", "bytes", "max_error", "rms_error", "volume_error", "time", "skipped"});
  }
  EXPECT_EQ(report["stl"][0]["deflection"], 1.0);
  EXPECT_EQ(report["stl"][1]["deflection"], 0.1);
  EXPECT_GT(report["stl"][0]["rms_error"], report["stl"][1]["rms_error"]);
  EXPECT_LT(report["direct"]["max_error"], 1e-6);
  EXPECT_LT(report["direct"]["occt"]["max_error"], 1e-5);
}

TEST_F(Accuracy, AFineDeflectionOfABigModelStopsWithAReason) {
  const Json fine = parse_output(result())["stl"][2];
  EXPECT_THAT(fine["skipped"].get<std::string>(), StartsWith("over 0.1 million triangles"));
  EXPECT_TRUE(fine["triangles"].is_null());
  EXPECT_TRUE(fine["time"].is_null());
}

TEST_F(Accuracy, TheCsvHasALineForEachMeasurementAndEqualCells) {
  std::istringstream lines(contents(folder() / "a.csv"));
  std::string line;
  std::getline(lines, line);
  EXPECT_THAT(line, StartsWith("kind,deflection,pitch,"));
  const auto columns = std::count(line.begin(), line.end(), ',');
  std::map<std::string, int> kinds;
  while (std::getline(lines, line)) {
    ++kinds[line.substr(0, line.find(','))];
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns) << line;
  }
  EXPECT_EQ(kinds["direct"], 1);
  EXPECT_EQ(kinds["stl"], 3);
  EXPECT_GE(kinds["lattice"], 3);
}

TEST_F(Accuracy, ThePageHasChartsAndNeedsNothingElse) {
  const std::string page = contents(folder() / "page.html");
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  for (const char* text : {"Error of crossings along the rays", "deflection in mm", "error in mm", "time in s", "bytes",
                           "pitch in mm", "skipped: over 0.1 million triangles", "prefers-color-scheme:dark"}) {
    EXPECT_THAT(page, HasSubstr(text));
  }
  for (const char* text : {"http://", "https://", "<script", "src=", "nan", "inf<"}) {
    EXPECT_THAT(page, Not(HasSubstr(text)));
  }
}

TEST(AccuracyVerb, SaysInWordsWhatItFound) {
  const CommandResult result = run_lamella("accuracy " + boxes() + " --deflections 1 --rays 100 --quiet");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("against the certified engine"));
  EXPECT_THAT(result.output, HasSubstr("against OpenCASCADE"));
  EXPECT_THAT(result.output, HasSubstr("deflection mm"));
  EXPECT_THAT(result.errors, IsEmpty());
}

TEST(AccuracyVerb, LeavesOutOpenSolidsAndSaysSo) {
  const TemporaryFolder folder;
  const std::string some = write_open_boxes(folder / "open.step", false);
  const CommandResult result = run_lamella("accuracy " + some + " --deflections 1 --rays 100 --json");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.errors, HasSubstr("left out"));
  EXPECT_FALSE(parse_output(result)["warnings"].empty());
  const std::string all = write_open_boxes(folder / "all.step", true);
  EXPECT_EQ(run_lamella("accuracy " + all + " --json").exit_code, 2);
}

TEST(AccuracyVerb, KeepsStlFilesWhenAsked) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella("accuracy " + boxes() + " --deflections 0.5 --rays 10 --keep-stl " + quoted(folder / "meshes"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(std::filesystem::file_size(folder / "meshes/0.5mm/solid_0.stl"), 684U);
}

TEST(AccuracyVerb, WritesNothingWhereItCant) {
  EXPECT_EQ(run_lamella("accuracy " + boxes() + " --deflections 1 --rays 9 -o /dev/null/page.html").exit_code, 4);
  EXPECT_EQ(run_lamella("accuracy " + boxes() + " --deflections 1 --rays 9 --keep-stl /dev/null/x").exit_code, 4);
  const TemporaryFolder folder;
  const std::string name = quoted(folder / "one");
  EXPECT_EQ(run_lamella("accuracy " + boxes() + " -o " + name + " --csv " + name).exit_code, 1);
  EXPECT_THAT(files_below(folder.path()), IsEmpty());
}

TEST(SliceAccuracy, PicksPitchAndLayerHeight) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella("slice " + spheres() + " --accuracy 0.3 --json -o " + quoted(folder / "build"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  const double pitch = report["grid"]["pitch"][0].get<double>();
  EXPECT_EQ(report["grid"]["pitch"][2], pitch);
  EXPECT_DOUBLE_EQ(pitch, 0.29);  // balls: T / 1.01, two digits
  EXPECT_EQ(report["accuracy"]["wanted"], 0.3);
  EXPECT_LE(report["accuracy"]["surface_bound"], 0.3);
  EXPECT_LE(report["accuracy"]["offset_bound"], 0.3);
  EXPECT_GE(report["accuracy"]["file_tolerance"], 0.0);
}

TEST(SliceAccuracy, KeepsToTheMachine) {
  const std::string machine = " --machine " + quoted(datasets_dir() / "machines/material_jetting.xml");
  const TemporaryFolder folder;
  const std::string slice = "slice " + spheres() + machine + " --json --dry-run -o " + quoted(folder / "build");
  const CommandResult can = run_lamella(slice + " --accuracy 0.05");
  ASSERT_EQ(can.exit_code, 0) << can.errors;
  EXPECT_DOUBLE_EQ(parse_output(can)["grid"]["pitch"][2].get<double>(), 0.0135);
  EXPECT_LE(parse_output(can)["accuracy"]["offset_bound"], 0.05);
  const CommandResult cant = run_lamella(slice + " --accuracy 0.01");
  EXPECT_EQ(cant.exit_code, 1);
  EXPECT_THAT(cant.errors, HasSubstr("with its pitch and thinnest layers it reaches"));
}

TEST(SliceAccuracy, WarnsWhenTheFileIsLessAccurate) {
  LAMELLA_NEEDS_CORPUS();
  const TemporaryFolder folder;
  // Its edges are stated to 0.014 mm.
  const CommandResult result = run_lamella("slice " + quoted(corpus_dir() / "mech_elmer_pump_carter_sup.stp") +
                                           " --accuracy 0.01 --dry-run --quiet -o " + quoted(folder / "build"));
  EXPECT_THAT(result.errors, HasSubstr("the STEP file states its edges to"));
}

}  // namespace
}  // namespace lamella::test
