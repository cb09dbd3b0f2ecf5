/// Formats of contours and tracks as users make them: sliced by the command, read back by programs of others or by
/// decoders of our own in Python, and compared with the build voxel by voxel (check_*.py beside this file).

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <regex>
#include <string>
#include <vector>

#include "tests/support/command.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

std::string step_of(const std::string& name) {
  const fs::path set = datasets_dir() / name;
  return quoted(set / (name + ".step")) + " --materials " + quoted(set / "materials.xml");
}

/// A data set sliced into a fresh folder, with a format besides.
class VectorFormat : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path path(const std::string& name) const { return folder_ / name; }

  /// How often a word stands in a file.
  [[nodiscard]] std::size_t count_of(const std::string& word, const std::string& name) const {
    std::ifstream stream(path(name), std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
  }

  void slice(const std::string& name, const std::string& options) const {
    const CommandResult run =
        run_lamella("slice " + step_of(name) + " -o " + quoted(path("build")) + " --quiet " + options);
    ASSERT_EQ(run.exit_code, 0) << run.errors;
  }

  [[nodiscard]] CommandResult export_to(const std::string& format, const std::string& name,
                                        const std::string& options = {}) const {
    return run_lamella("export " + quoted(path("build")) + " --to " + format + " -o " + quoted(path(name)) +
                       " --quiet " + options);
  }

  [[nodiscard]] CommandResult judge(const std::string& script, const std::string& name,
                                    const std::string& more = {}) const {
    return run_command("/usr/bin/python3 " + quoted(source_dir() / "tests" / "export" / script) + " " +
                       quoted(path("build")) + " " + quoted(path(name)) + " " + more);
  }

  void expect_judged(const std::string& script, const std::string& name, const std::string& more = {}) const {
    const CommandResult result = judge(script, name, more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    if (result.exit_code == 0) std::printf("%s: %s", script.c_str(), result.output.c_str());
  }

  /// Changes the first place where `from` stands in a file.
  void damage(const std::string& name, const std::string& from, const std::string& to) const {
    std::string bytes = read(name);
    const std::size_t at = bytes.find(from);
    ASSERT_NE(at, std::string::npos);
    bytes.replace(at, from.size(), to);
    std::ofstream(path(name), std::ios::binary) << bytes;
  }

  [[nodiscard]] std::string read(const std::string& name) const {
    std::ifstream stream(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  /// A build without contours: the export says which option it lacks, and writes nothing.
  void expect_contours_needed(const std::string& format) const {
    slice("nested_spheres", "--layer-height 7 --pitch 2");
    const CommandResult run = export_to(format, "out");
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.errors, HasSubstr("--contours"));
    EXPECT_FALSE(fs::exists(path("out")));
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(VectorFormat, ContoursAreAskedForByANumberOrWithoutOne) {
  slice("nested_spheres", "--layer-height 7 --pitch 2 --contours 0.25");
  EXPECT_THAT(read("build/build.xml"), HasSubstr("<contours chord_error=\"0.25\""));
  slice("nested_spheres", "--layer-height 7 --pitch 2 --contours");
  EXPECT_THAT(read("build/build.xml"), HasSubstr("<contours chord_error=\"0.01\""));
  EXPECT_EQ(run_lamella("check " + quoted(path("build"))).exit_code, 0);
}

TEST_F(VectorFormat, ContoursAreRefusedByTheReferenceEngine) {
  const std::string options = " -o " + quoted(path("build")) + " --engine reference ";
  for (const char* more : {"--contours", "--svg out"}) {
    const CommandResult run = run_lamella("slice " + step_of("nested_spheres") + options + more);
    EXPECT_EQ(run.exit_code, 1) << more;
    EXPECT_THAT(run.errors, HasSubstr("--engine reference"));
  }
}

TEST_F(VectorFormat, ContoursAreTheSameForAnyNumberOfThreads) {
  const std::string options = "--layer-height 0.5 --pitch 1 --contours 0.01 --threads ";
  slice("lattice_in_shell", options + "1");
  const std::string one = read("build/layers/000000.h5");
  slice("lattice_in_shell", options + "2");
  EXPECT_EQ(one, read("build/layers/000000.h5"));
}

TEST_F(VectorFormat, SvgIsReadByPrintrunAndHasEveryVoxel) {
  slice("overmoulded_grip", "--layer-height 4 --pitch 0.31 --svg " + quoted(path("svg")));
  expect_judged("check_svg.py", "svg");
  EXPECT_EQ(run_command("xmllint --noout " + (path("svg") / "*.svg").string()).exit_code, 0);
}

TEST_F(VectorFormat, SvgOfALayerRangeHasOverlapsWhereTheyBelong) {
  slice("interpenetrating_bodies", "--layer-height 1 --pitch 0.17 --contours 0.002");
  EXPECT_EQ(export_to("svg", "svg", "--layers 3:8").exit_code, 0);
  expect_judged("check_svg.py", "svg", "3 8");
}

TEST_F(VectorFormat, SvgWithAWrongColourOrPointIsNoticed) {
  slice("interpenetrating_bodies", "--layer-height 5 --pitch 0.5 --svg " + quoted(path("svg")));
  expect_judged("check_svg.py", "svg");
  damage("svg/layer_000001.svg", "slic3r:type=\"contour\" d=\"M", "slic3r:type=\"contour\" d=\"M9 2 L");
  EXPECT_NE(judge("check_svg.py", "svg").exit_code, 0);
}

TEST_F(VectorFormat, SvgNeedsContours) { expect_contours_needed("svg"); }

TEST_F(VectorFormat, CliHasTheHatchRowsAndContoursOfEveryMaterial) {
  slice("overmoulded_grip",
        "--layer-height 4 --pitch 0.4 --hatch-spacing 0.7 --hatch-angle 30 --rotate-per-layer 67 --cli " +
            quoted(path("a.cli")) + " --cli-binary " + quoted(path("b.cli")));
  EXPECT_THAT(read("a.cli"), StartsWith("$$HEADERSTART\n$$ASCII\n$$UNITS/1.0\n$$VERSION/200\n"));
  expect_judged("check_cli.py", "a.cli");
  expect_judged("check_cli.py", "b.cli");
}

TEST_F(VectorFormat, CliWithoutContoursOrHatchRowsHasTheRasterRows) {
  slice("interpenetrating_bodies", "--layer-height 1 --pitch 0.3");
  EXPECT_EQ(export_to("cli", "a.cli", "--layers 2:9").exit_code, 0);
  EXPECT_EQ(export_to("cli-binary", "b.cli").exit_code, 0);
  expect_judged("check_cli.py", "a.cli", "2 9");
  expect_judged("check_cli.py", "b.cli");
}

TEST_F(VectorFormat, ContoursFollowThePoliciesOfOverlapsAsRowsDo) {
  // The materials of the data set, all of one priority.
  std::ifstream stream(datasets_dir() / "interpenetrating_bodies" / "materials.xml");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::ofstream(path("equal.xml")) << std::regex_replace(text, std::regex("priority=\"[0-9]+\""), "priority=\"1\"");
  for (const char* policy : {"entry", "exit", "average"}) {
    const std::string step = (datasets_dir() / "interpenetrating_bodies/interpenetrating_bodies.step").string();
    const CommandResult run = run_lamella("slice " + step + " --materials " + quoted(path("equal.xml")) + " -o " +
                                          quoted(path("build")) + " --layer-height 1 --pitch 0.13 --contours 0.001" +
                                          " --quiet --svg " + quoted(path("svg")) + " --overlap " + policy);
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    expect_judged("check_svg.py", "svg");
  }
}

TEST_F(VectorFormat, DamagedCliIsNoticed) {
  slice("interpenetrating_bodies", "--layer-height 5 --pitch 0.5 --cli " + quoted(path("a.cli")));
  expect_judged("check_cli.py", "a.cli");
  damage("a.cli", "$$HATCHES/2,", "$$HATCHES/1,");
  EXPECT_NE(judge("check_cli.py", "a.cli").exit_code, 0);
}

TEST_F(VectorFormat, SlcHasTheBoundariesOfEveryMaterial) {
  slice("overmoulded_grip", "--layer-height 4 --pitch 0.4 --slc " + quoted(path("slc")));
  expect_judged("check_slc.py", "slc");
}

TEST_F(VectorFormat, SlcOfALayerRangeHasItsOwnLayers) {
  slice("nested_spheres", "--layer-height 2 --pitch 0.4 --contours 0.003");
  EXPECT_EQ(export_to("slc", "slc", "--layers 5:9").exit_code, 0);
  expect_judged("check_slc.py", "slc", "5 9");
}

TEST_F(VectorFormat, SlcLeavesAFolderOfOtherFilesAlone) {
  slice("nested_spheres", "--layer-height 7 --pitch 2 --contours");
  fs::create_directory(path("slc"));
  std::ofstream(path("slc") / "notes.txt") << "mine";
  EXPECT_EQ(export_to("slc", "slc").exit_code, 4);
  EXPECT_EQ(read("slc/notes.txt"), "mine");
}

TEST_F(VectorFormat, DamagedSlcIsNoticed) {
  slice("nested_spheres", "--layer-height 7 --pitch 1 --slc " + quoted(path("slc")));
  expect_judged("check_slc.py", "slc");
  damage("slc/Lead.slc", "-UNIT MM", "-UNIT IN");
  EXPECT_NE(judge("check_slc.py", "slc").exit_code, 0);
}

TEST_F(VectorFormat, SlcNeedsContours) { expect_contours_needed("slc"); }

/// Skips the test where lib3mf isn't there, which is asked for by exit code 77.
#define LAMELLA_EXPECT_3MF(...)                                                          \
  do {                                                                                   \
    const CommandResult result = judge("check_3mf.py", __VA_ARGS__);                     \
    if (result.exit_code == 77) GTEST_SKIP() << "no lib3mf: run npm ci in tests/export"; \
    ASSERT_EQ(result.exit_code, 0) << result.errors;                                     \
    std::printf("check_3mf.py: %s", result.output.c_str());                              \
  } while (false)

TEST_F(VectorFormat, ThreemfIsReadByLib3mfInStrictModeAndHasEveryVoxel) {
  slice("overmoulded_grip", "--layer-height 3 --pitch 0.4 --3mf " + quoted(path("a.3mf")));
  LAMELLA_EXPECT_3MF("a.3mf");
}

TEST_F(VectorFormat, ThreemfOfManyLayersHasAClosedMeshOfBlocks) {
  slice("lattice_in_shell", "--layer-height 0.2 --pitch 0.9 --contours 0.02");
  EXPECT_EQ(export_to("3mf", "a.3mf").exit_code, 0);
  LAMELLA_EXPECT_3MF("a.3mf");
}

TEST_F(VectorFormat, ThreemfOfALayerRangeBeginsAtItsFirstLayer) {
  slice("nested_spheres", "--layer-height 1.5 --pitch 0.5 --contours 0.005");
  EXPECT_EQ(export_to("3mf", "a.3mf", "--layers 4:11").exit_code, 0);
  LAMELLA_EXPECT_3MF("a.3mf", "4 11");
}

TEST_F(VectorFormat, ThreemfHasTheSameBytesInEveryTimeZone) {
  slice("nested_spheres", "--layer-height 5 --pitch 2 --contours");
  EXPECT_EQ(export_to("3mf", "a.3mf").exit_code, 0);
  EXPECT_EQ(run_command("env TZ=Asia/Tokyo " + quoted(lamella_binary()) + " export " + quoted(path("build")) +
                        " --to 3mf -o " + quoted(path("b.3mf")))
                .exit_code,
            0);
  EXPECT_EQ(read("a.3mf"), read("b.3mf"));
}

TEST_F(VectorFormat, ThreemfOfAnotherBuildIsNoticed) {
  slice("nested_spheres", "--layer-height 5 --pitch 0.7 --3mf " + quoted(path("a.3mf")));
  LAMELLA_EXPECT_3MF("a.3mf");
  slice("nested_spheres", "--layer-height 4 --pitch 0.7 --contours");
  EXPECT_EQ(judge("check_3mf.py", "a.3mf").exit_code, 1);
}

TEST_F(VectorFormat, ThreemfNeedsContours) { expect_contours_needed("3mf"); }

TEST_F(VectorFormat, VtpHasEverySegmentAndContour) {
  slice("overmoulded_grip",
        "--layer-height 4 --pitch 0.4 --hatch-spacing 0.6 --hatch-angle 20 --vtp " + quoted(path("vtp")));
  expect_judged("check_vtp.py", "vtp");
  EXPECT_EQ(
      run_command("xmllint --noout " + (path("vtp") / "*.vtp").string() + " " + quoted(path("vtp") / "layers.pvd"))
          .exit_code,
      0);
}

TEST_F(VectorFormat, VtpWithoutContoursHasTheRasterRows) {
  slice("interpenetrating_bodies", "--layer-height 1 --pitch 0.3");
  EXPECT_EQ(export_to("vtp", "vtp", "--layers 2:9").exit_code, 0);
  expect_judged("check_vtp.py", "vtp", "2 9");
}

TEST_F(VectorFormat, VtpIsReadByParaview) {
  if (run_command("which pvpython").exit_code != 0) GTEST_SKIP() << "no pvpython (Debian: python3-paraview)";
  slice("interpenetrating_bodies", "--layer-height 3 --pitch 0.5 --vtp " + quoted(path("vtp")));
  const CommandResult result = run_command("pvpython --force-offscreen-rendering " +
                                           quoted(source_dir() / "tests" / "export" / "check_vtp_paraview.py") + " " +
                                           quoted(path("build")) + " " + quoted(path("vtp")));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
}

TEST_F(VectorFormat, DamagedVtpIsNoticed) {
  slice("nested_spheres", "--layer-height 7 --pitch 1 --vtp " + quoted(path("vtp")));
  expect_judged("check_vtp.py", "vtp");
  fs::copy_file(path("vtp") / "layer_000001.vtp", path("vtp") / "layer_000002.vtp",
                fs::copy_options::overwrite_existing);
  EXPECT_NE(judge("check_vtp.py", "vtp").exit_code, 0);
}

TEST_F(VectorFormat, StepIsReadByGmshAndHasEveryOutline) {
  slice("overmoulded_grip", "--layer-height 4 --pitch 0.4 --step " + quoted(path("a.step")));
  expect_judged("check_step.py", "a.step");
}

TEST_F(VectorFormat, StepOfCurvesIsReadByGmshAndHasEveryCurveAndHatch) {
  slice("overmoulded_grip",
        "--layer-height 4 --pitch 0.8 --hatch-spacing 1.5 --hatch-angle 30 --curves --contours 0.1");
  EXPECT_EQ(export_to("step", "a.step", "--step-hatches").exit_code, 0);
  // Its chamfers lean.
  EXPECT_GT(count_of("RATIONAL_B_SPLINE_CURVE", "a.step"), 20U);
  expect_judged("check_step_curves.py", "a.step");
  slice("interpenetrating_bodies",
        "--layer-height 1.3 --pitch 0.3 --hatch-spacing 1 --curves --step-hatches --step " + quoted(path("b.step")));
  expect_judged("check_step_curves.py", "b.step");
}

TEST_F(VectorFormat, StepHatchesNeedHatchRows) {
  slice("nested_spheres", "--layer-height 4 --pitch 1 --contours");
  const CommandResult run = export_to("step", "a.step", "--step-hatches");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.errors, ::testing::HasSubstr("--hatch-spacing"));
}

TEST_F(VectorFormat, StepOfALayerRangeHasItsOwnLayers) {
  slice("interpenetrating_bodies", "--layer-height 1 --pitch 0.3 --contours 0.002");
  EXPECT_EQ(export_to("step", "a.step", "--layers 2:9").exit_code, 0);
  expect_judged("check_step.py", "a.step", "2 9");
  EXPECT_NE(judge("check_step.py", "a.step", "3 10").exit_code, 0);
}

TEST_F(VectorFormat, StepNeedsContours) { expect_contours_needed("step"); }

/// Names in the folder of the outputs but the build's.
std::vector<std::string> left_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = fs::relative(entry.path(), folder).string();
    if (name.substr(0, 5) != "build" && entry.is_regular_file()) names.push_back(name);
  }
  return names;
}

TEST_F(VectorFormat, AFullDiskLeavesNothingAndSaysSo) {
  slice("overmoulded_grip", "--layer-height 8 --pitch 1 --contours");
  for (const char* format : {"svg", "cli", "cli-binary", "slc", "3mf", "vtp", "step"}) {
    // A limit on the size of files stands for the disk's end; the signal that comes with it is ignored.
    const CommandResult run =
        run_command("bash -c \"trap '' XFSZ; ulimit -f 4; exec " + lamella_binary().string() + " export " +
                    path("build").string() + " --to " + format + " -o " + path("out").string() + "\"");
    EXPECT_EQ(run.exit_code, 4) << format << run.errors;
    EXPECT_THAT(left_in(path("")), IsEmpty()) << format;
  }
}

TEST_F(VectorFormat, OneThreadAndManyGiveTheSameBytes) {
  const std::string options = "--layer-height 0.5 --pitch 1 --cli " + quoted(path("cli")) + " --3mf " +
                              quoted(path("3mf")) + " --step " + quoted(path("step")) + " --threads ";
  slice("lattice_in_shell", options + "1");
  const std::vector<std::string> one{read("cli"), read("3mf"), read("step")};
  slice("lattice_in_shell", options + "3");
  EXPECT_EQ(one, (std::vector<std::string>{read("cli"), read("3mf"), read("step")}));
}

TEST_F(VectorFormat, TheSameBuildGivesTheSameBytes) {
  slice("interpenetrating_bodies", "--layer-height 4 --pitch 0.5 --contours");
  for (const char* format : {"cli", "cli-binary", "3mf", "step"}) {
    EXPECT_EQ(export_to(format, "first").exit_code, 0);
    EXPECT_EQ(export_to(format, "second").exit_code, 0);
    // The file's own name stands in a STEP file.
    EXPECT_EQ(std::regex_replace(read("first"), std::regex("'first'"), "'second'"), read("second")) << format;
  }
}

}  // namespace
}  // namespace lamella::test
