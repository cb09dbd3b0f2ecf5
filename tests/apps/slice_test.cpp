#include <gmock/gmock.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr const char* kCoarse = " --pitch 1 --layer-height 2 ";

TEST(Slice, JsonHasTheDocumentedKeys) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella("slice " + boxes() + kCoarse + "--json -o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  expect_keys(report, {"grid", "layers", "rows", "rays", "hits", "segments", "unclosed_rays", "repaired_rays",
                       "uncertain_hits", "solids", "materials", "overlaps", "gaps", "timing", "peak_memory_bytes"});
  expect_keys(report["grid"], {"origin", "pitch", "size"});
  expect_keys(report["solids"][0], {"id", "name", "material", "volume_sliced", "volume_exact", "status"});
  expect_keys(report["materials"][0], {"name", "volume", "mass"});
  expect_keys(report["timing"], {"read", "prepare", "slice", "write", "total"});
  EXPECT_EQ(report["grid"]["pitch"], Json::array({1.0, 1.0, 2.0}));
  EXPECT_EQ(report["layers"], report["grid"]["size"][2]);
  EXPECT_EQ(report["rows"].get<int>(), report["layers"].get<int>() * report["grid"]["size"][1].get<int>());
  EXPECT_EQ(report["rays"], report["rows"]);
  EXPECT_GT(report["segments"], 0);
}

TEST(Slice, WritesTheBuildWithItsTimingsApart) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder / "build")).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "build/build.xml"));
  const Json run = Json::parse(contents(folder / "build/run.json"));
  expect_keys(run, {"version", "arguments", "timing", "peak_memory_bytes", "exit_code"});
  EXPECT_GT(run["timing"]["total"], 0);
  EXPECT_THAT(run["arguments"].dump(), HasSubstr("--layer-height"));
}

TEST(Slice, FirstSaysItsLatticeAndLastWhereTheOutputsAre) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder / "build"));
  EXPECT_THAT(result.output, StartsWith("lattice: "));
  EXPECT_THAT(result.output, HasSubstr("mass [g]"));
  EXPECT_THAT(result.output, ContainsRegex("store: [^\n]*build \\([0-9.]+ kB\\)\n$"));
}

TEST(Slice, WithoutABuildWritesTheSamePictures) {
  const TemporaryFolder folder;
  const std::string slice = "slice " + boxes() + kCoarse;
  ASSERT_EQ(run_lamella(slice + "-o " + quoted(folder / "build") + " --png " + quoted(folder / "png")).exit_code, 0);
  const CommandResult result = run_lamella(slice + "--json --png " + quoted(folder / "alone"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_GT(parse_output(result)["segments"], 0);
  std::size_t pictures = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "png")) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(contents(entry.path()),
              contents(folder / "alone" / std::filesystem::relative(entry.path(), folder / "png")));
    ++pictures;
  }
  EXPECT_GT(pictures, 0U);
  const auto at = std::filesystem::directory_iterator(folder.path());
  EXPECT_EQ(std::distance(begin(at), end(at)), 3) << "nothing but the build and the two folders";
}

TEST(Slice, BothEnginesGiveTheSameVolumes) {
  const TemporaryFolder folder;
  std::vector<Json> reports;
  for (const std::string engine :
       {"", " --engine span", " --engine reference", " --engine reference --solver newton"}) {
    const CommandResult result =
        run_lamella("slice " + boxes() + kCoarse + "--json -o " + quoted(folder / "build") + engine);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    reports.push_back(parse_output(result));
  }
  for (std::size_t i = 0; i < reports[0]["solids"].size(); ++i) {
    const double expected = reports[2]["solids"][i]["volume_sliced"];
    EXPECT_EQ(reports[0]["solids"][i]["volume_sliced"], reports[1]["solids"][i]["volume_sliced"]);
    EXPECT_NEAR(reports[1]["solids"][i]["volume_sliced"], expected, 1e-9 * expected);
    EXPECT_NEAR(reports[3]["solids"][i]["volume_sliced"], expected, 1e-2 * expected);
  }
}

TEST(Slice, NeverWritesOverWhatTheMaterialsFileNames) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder / name) << text; };
  const std::string head = "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.0\"><library>";
  write(
      "library.xml",
      head + "<material name=\"A\" color=\"#ff0000\"/><material name=\"B\" color=\"#0000ff\"/></library></materials>");
  write("table.csv", "0,1,0\n100,0,1\n");
  write(
      "m.xml",
      head +
          "<include href=\"library.xml\"/><graded name=\"G\"><component material=\"A\"/><component material=\"B\"/>"
          "<axis direction=\"0 0 1\" table=\"table.csv\"/></graded></library><assignments default=\"G\"/></materials>");
  const std::string slice = "slice " + boxes() + kCoarse + "--materials " + quoted(folder / "m.xml");
  for (const std::string& output : {"--xml " + quoted(folder / "library.xml"), "--cli " + quoted(folder / "table.csv"),
                                    "--mhd " + quoted(folder / "x.mhd") + " --xml " + quoted(folder / "table.csv")}) {
    const auto before = contents_below(folder.path());
    const CommandResult result = run_lamella(slice + " " + output);
    EXPECT_EQ(result.exit_code, 1) << output << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("overwrite an input"));
    EXPECT_EQ(contents_below(folder.path()), before);
  }
  EXPECT_EQ(run_lamella(slice + " --xml " + quoted(folder / "s.xml")).exit_code, 0);
}

TEST(Slice, EveryFormatComesFromTheSamePass) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder / "build") + " --png " + quoted(folder / "png") +
                  " --png-indexed " + quoted(folder / "labels") + " --xml " + quoted(folder / "s.xml") + " --vdb " +
                  quoted(folder / "v.vdb") + " --xml-payload text --vdb-ids --json");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(parse_output(result)["outputs"].size(), 5U);
  EXPECT_THAT(files_below(folder / "png"), Not(IsEmpty()));
  EXPECT_THAT(files_below(folder / "labels"), Not(IsEmpty()));
  EXPECT_THAT(contents(folder / "s.xml"), HasSubstr("<slices"));
  EXPECT_GT(std::filesystem::file_size(folder / "v.vdb"), 1000U);
  EXPECT_THAT(files_below(folder.path()), Each(Not(HasSubstr(".part-"))));
}

TEST(Slice, ThreadsDontChangeTheBytes) {
  const TemporaryFolder folder;
  for (const char* threads : {"1", "3"}) {
    ASSERT_EQ(run_lamella("slice " + boxes() + kCoarse + "--threads " + threads + " -o " + quoted(folder / threads))
                  .exit_code,
              0);
  }
  for (const char* file : {"build.xml", "layers/000000.h5"}) {
    EXPECT_EQ(contents(folder / "1" / file), contents(folder / "3" / file)) << file;
    EXPECT_FALSE(contents(folder / "1" / file).empty()) << file;
  }
}

TEST(Slice, DryRunEstimatesAndWritesNothing) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella("slice " + boxes() + kCoarse + "--dry-run --json -o " +
                                           quoted(folder / "build") + " --vdb " + quoted(folder / "v.vdb"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json plan = parse_output(result);
  expect_keys(plan, {"grid", "layers", "rows", "rays", "estimate"});
  expect_keys(plan["estimate"], {"time", "memory_bytes", "outputs"});
  ASSERT_EQ(plan["estimate"]["outputs"].size(), 2U);
  for (const Json& output : plan["estimate"]["outputs"]) EXPECT_GT(output["bytes"], 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Slice, DryRunCountsWhatTheRunCounts) {
  const TemporaryFolder folder;
  const std::string line = "slice " + boxes() + kCoarse + "--json -o " + quoted(folder / "build");
  const Json plan = parse_output(run_lamella(line + " --dry-run"));
  const Json report = parse_output(run_lamella(line));
  for (const char* key : {"grid", "layers", "rows", "rays"}) EXPECT_EQ(plan[key], report[key]) << key;
}

TEST(Slice, DpiAndOriginSetTheLattice) {
  const TemporaryFolder folder;
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  const double low = info["solids"][0]["bounds"][0][0].get<double>() - 1000.0;
  const std::string origin = std::to_string(low) + "," + std::to_string(low) + "," + std::to_string(low);
  const Json plan = parse_output(run_lamella("slice " + boxes() + " --dpi 25.4,12.7 --layer-height 50 --origin " +
                                             origin + " --dry-run --json -o " + quoted(folder / "build")));
  EXPECT_EQ(plan["grid"]["pitch"], Json::array({1.0, 2.0, 50.0}));
  EXPECT_NEAR(plan["grid"]["origin"][0].get<double>(), low, 1e-5);
}

TEST(Slice, AForeignFolderIsRefusedAndLeftAlone) {
  const TemporaryFolder folder;
  write_text(folder / "thesis.txt", "ten years of work");
  const CommandResult result = run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder.path()));
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_EQ(files_below(folder.path()).size(), 1U);
  const CommandResult png =
      run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder / "build") + " --png " + quoted(folder.path()));
  EXPECT_NE(png.exit_code, 0);
  EXPECT_EQ(contents(folder / "thesis.txt"), "ten years of work");
}

TEST(Slice, AnUnwritableOutputIsExitCodeFour) {
  const TemporaryFolder folder;
  write_text(folder / "file", "");
  std::filesystem::create_directory(folder / "folder");
  for (const std::string& output : std::vector<std::string>{
           "-o " + quoted(folder / "file"), "-o " + quoted(folder / "file" / "build"),
           "-o " + quoted(folder / "build") + " --xml " + quoted(folder / "folder"), "-o /proc/nowhere/build"}) {
    const CommandResult result = run_lamella("slice " + boxes() + kCoarse + output);
    EXPECT_EQ(result.exit_code, 4) << output << "\n" << result.errors;
  }
  EXPECT_EQ(files_below(folder.path()).size(), 1U);
}

TEST(Slice, AnOutputInsideAnotherIsRefused) {
  const TemporaryFolder folder;
  for (const char* inner : {"build/build.xml", "build/layers.h5", "build"}) {
    const CommandResult result = run_lamella("slice " + boxes() + kCoarse + "-o " + quoted(folder / "build") +
                                             " --vdb " + quoted(folder / inner));
    EXPECT_EQ(result.exit_code, 1) << inner << result.errors;
  }
  EXPECT_THAT(files_below(folder.path()), IsEmpty());
}

TEST(Slice, ARepeatedBuildReplacesTheFirst) {
  const TemporaryFolder folder;
  const std::string build = " -o " + quoted(folder / "build");
  ASSERT_EQ(run_lamella("slice " + boxes() + kCoarse + build).exit_code, 0);
  const CommandResult again = run_lamella("slice " + boxes() + " --pitch 2 --layer-height 3 --json" + build);
  ASSERT_EQ(again.exit_code, 0) << again.errors;
  const CommandResult check = run_lamella("check --json " + quoted(folder / "build"));
  EXPECT_EQ(check.exit_code, 0) << check.output;
}

TEST(Slice, OverlapAsErrorIsExitCodeTwoAndLeavesNothing) {
  const TemporaryFolder folder;
  const auto model = quoted(datasets_dir() / "interpenetrating_bodies/interpenetrating_bodies.step");
  const CommandResult result = run_lamella("slice " + model + " --pitch 1 --layer-height 1 --overlap error --json -o " +
                                           quoted(folder / "build") + " --png " + quoted(folder / "png"));
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_THAT(parse_output(result)["error"]["what"].get<std::string>(), HasSubstr("overlap"));
  EXPECT_THAT(files_below(folder.path()), IsEmpty());
}

TEST(Slice, OverlapsAreMeasuredAndNamed) {
  const TemporaryFolder folder;
  const auto data = datasets_dir() / "interpenetrating_bodies";
  const CommandResult result = run_lamella("slice " + quoted(data / "interpenetrating_bodies.step") + " --materials " +
                                           quoted(data / "materials.xml") +
                                           " --pitch 0.5 --layer-height 0.5 --json -o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  ASSERT_FALSE(report["overlaps"].empty());
  expect_keys(report["overlaps"][0], {"solids", "volume", "layers"});
  EXPECT_EQ(report["overlaps"][0]["solids"].size(), 2U);
}

TEST(Slice, HatchRowsNeedTheirSpacingOnly) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella("slice " + boxes() + kCoarse + "--hatch-spacing 1 --hatch-angle 30 --rotate-per-layer 67 -o " +
                  quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
}

TEST(Slice, ALatticeBeyondReasonIsExitCodeOne) {
  const TemporaryFolder folder;
  for (const char* lattice : {"--layer-height 1e-12", "--pitch 1e-30", "--origin 1e6,0,0"}) {
    const CommandResult result = run_lamella("slice " + boxes() + " " + lattice + " -o " + quoted(folder / "build"));
    EXPECT_EQ(result.exit_code, 1) << lattice << result.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "build"));
  }
}

TEST(Slice, AnOpenSolidIsLeftOutAndNamedWithExitCodeThree) {
  const TemporaryFolder folder;
  const std::string model = write_open_boxes(folder / "open.step", false);
  const CommandResult result = run_lamella("slice " + model + kCoarse + "--json -o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  const Json report = parse_output(result);
  const std::vector<Json> open = solids_with_status(report, "open");
  ASSERT_EQ(open.size(), 2U);  // two instances of the part
  EXPECT_EQ(open[0]["left_out"], true);
  EXPECT_EQ(open[0]["volume_sliced"], 0);
  EXPECT_EQ(solids_with_status(report, "ok").size(), 10U);
  EXPECT_THAT(result.errors, HasSubstr("error budget"));
  EXPECT_TRUE(std::filesystem::exists(folder / "build/build.xml"));
}

TEST(Slice, ContoursOfOpenSolidsAreMissingAndSaidToBe) {
  const TemporaryFolder folder;
  const std::string model = write_open_boxes(folder / "open.step", false);
  const CommandResult result =
      run_lamella("slice " + model + kCoarse + "--allow-open --step " + quoted(folder / "layers.step") + " --json");
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("no contours: the solid is open"));
  EXPECT_TRUE(std::filesystem::exists(folder / "layers.step"));
}

TEST(Slice, OnlyOpenSolidsIsExitCodeTwoAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string model = write_open_boxes(folder / "open.step", true);
  const CommandResult result = run_lamella("slice " + model + kCoarse + "-o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("--allow-open"));
  EXPECT_FALSE(std::filesystem::exists(folder / "build"));
}

}  // namespace
}  // namespace lamella::test
