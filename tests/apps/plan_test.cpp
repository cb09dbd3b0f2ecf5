#include <gmock/gmock.h>
#include <regex>
#include <set>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string machine(const char* name) { return quoted(datasets_dir() / "machines" / (std::string(name) + ".xml")); }

/// A build that all tests of this file plan, with hatch rows.
class Plan : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const CommandResult result = run_lamella(
        "slice " + quoted(datasets_dir() / "connector/connector.step") + " --materials " +
        quoted(datasets_dir() / "connector/materials.xml") + " --machine " + machine("multi_nozzle") +
        " --hatch-spacing 0.4 --hatch-angle 45 --rotate-per-layer 90 -o " + quoted(*folder_ / "build") + " --json");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    sliced_ = new Json(parse_output(result));
  }
  static void TearDownTestSuite() {
    delete folder_;
    delete sliced_;
  }

  static std::string build() { return quoted(*folder_ / "build"); }
  static const TemporaryFolder& folder() { return *folder_; }
  static const Json& sliced() { return *sliced_; }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
  static inline Json* sliced_ = nullptr;
};

TEST_F(Plan, TheMachineGivesPitchAndLayerHeight) { EXPECT_EQ(sliced()["grid"]["pitch"], Json::array({0.1, 0.2, 0.2})); }

TEST_F(Plan, HasTheKeysOfTheContractAndTheReportsVolumes) {
  const CommandResult result =
      run_lamella("plan " + build() + " --machine " + machine("multi_nozzle") + " -o " + quoted(folder() / "plan.xml") +
                  " --page " + quoted(folder() / "plan.html") + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json plan = parse_output(result);
  expect_keys(plan, {"layers", "tool_changes", "time", "cost", "materials"});
  EXPECT_EQ(plan["layers"], sliced()["layers"]);
  EXPECT_EQ(plan["lattice"], "hatch");
  EXPECT_GE(plan["matchings"].get<int>(), 1);
  EXPECT_EQ(plan["matching_proved"], true);
  ASSERT_EQ(plan["materials"].size(), sliced()["materials"].size());
  for (std::size_t m = 0; m < plan["materials"].size(); ++m) {
    const Json& planned = plan["materials"][m];
    const Json& reported = sliced()["materials"][m];
    expect_keys(planned, {"name", "tool", "volume", "mass", "length", "time", "cost"});
    EXPECT_EQ(planned["name"], reported["name"]);
    EXPECT_NEAR(planned["volume"].get<double>(), reported["volume"].get<double>(), 1e-9);
    EXPECT_NEAR(planned["mass"].get<double>(), reported["mass"].get<double>(), 1e-9);
    EXPECT_TRUE(planned["tool"].is_number_integer());
  }
  EXPECT_EQ(run_lamella("check " + quoted(folder() / "plan.xml")).exit_code, 0);
  const std::string page = contents(folder() / "plan.html");
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, HasSubstr("area in mm"));
  EXPECT_THAT(page, Not(HasSubstr("http")));
  EXPECT_THAT(page, Not(HasSubstr("src=")));
}

/// The heads' accelerations make the plan's time longer, move by move, and nothing else.
TEST_F(Plan, TakesLongerWhereTheMachineMustAccelerate) {
  const auto planned = [&](const std::string& acceleration) {
    std::string text = contents(datasets_dir() / "machines/multi_nozzle.xml");
    text = std::regex_replace(text, std::regex(" (travel_)?acceleration=\"[^\"]*\""), "");
    text = std::regex_replace(text, std::regex("<deposition "), "<deposition " + acceleration);
    write_text(folder() / "accelerating.xml", text);
    const CommandResult result = run_lamella("plan " + build() + " --machine " + quoted(folder() / "accelerating.xml") +
                                             " -o " + quoted(folder() / "accelerated.xml") + " --json --quiet");
    EXPECT_EQ(result.exit_code, acceleration.find("0.5") == std::string::npos ? 0 : 2) << result.errors;
    return parse_output(result);
  };
  const Json none = planned("");
  const Json fast = planned("acceleration=\"1e9\" ");
  const Json slow = planned("acceleration=\"300\" ");
  EXPECT_NEAR(fast["time"].get<double>(), none["time"].get<double>(), 0.01);
  EXPECT_GT(slow["time"].get<double>(), 1.2 * none["time"].get<double>());
  EXPECT_EQ(slow["tool_changes"], none["tool_changes"]);
  EXPECT_EQ(slow["change_time"], none["change_time"]);
  const Json other = planned("travel_acceleration=\"0.5\" acceleration=\"300\" ");
  EXPECT_FALSE(other.contains("time"));
}

TEST_F(Plan, GivesTheSameBytesAgain) {
  for (const char* name : {"first.xml", "second.xml"}) {
    const CommandResult result = run_lamella("plan " + build() + " --machine " + machine("multi_nozzle") + " -o " +
                                             quoted(folder() / name) + " --quiet");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  EXPECT_EQ(contents(folder() / "first.xml"), contents(folder() / "second.xml"));
}

TEST_F(Plan, ALayerHeightThatTheMachineCannotBuildIsRefused) {
  const CommandResult slice = run_lamella("slice " + boxes() + " --machine " + machine("material_jetting") +
                                          " --layer-height 0.1 -o " + quoted(folder() / "none"));
  EXPECT_EQ(slice.exit_code, 1);
  EXPECT_THAT(slice.errors, HasSubstr("0.0135 to 0.027 mm"));
  const CommandResult plan = run_lamella("plan " + build() + " --machine " + machine("material_jetting") + " -o " +
                                         quoted(folder() / "none.xml") + " --json");
  EXPECT_EQ(plan.exit_code, 2);
  EXPECT_THAT(parse_output(plan)["error"]["what"].get<std::string>(), HasSubstr("0.0135 to 0.027 mm"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "none.xml"));
}

TEST_F(Plan, ExplicitOptionsWinOverTheMachine) {
  const CommandResult result =
      run_lamella("slice " + boxes() + " --machine " + machine("multi_nozzle") + " --layer-height 0.3 --pitch 1 -o " +
                  quoted(folder() / "coarse") + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(parse_output(result)["grid"]["pitch"], Json::array({1.0, 1.0, 0.3}));
}

TEST_F(Plan, APartThatDoesNotFitIsExitCodeThree) {
  std::string text = contents(datasets_dir() / "machines/multi_nozzle.xml");
  text.replace(text.find("<volume x=\"360\""), 15, "<volume x=\"5\"");
  write_text(folder() / "small.xml", text);
  const CommandResult result = run_lamella("plan " + build() + " --machine " + quoted(folder() / "small.xml") + " -o " +
                                           quoted(folder() / "small-plan.xml") + " --json");
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  EXPECT_EQ(parse_output(result)["fits"], false);
  EXPECT_THAT(result.errors, HasSubstr("the machine has 5 x 360 x 300 mm"));
}

TEST_F(Plan, NeverWritesOverItsInputs) {
  write_text(folder() / "mine.xml", contents(datasets_dir() / "machines/multi_nozzle.xml"));
  const std::string mine = quoted(folder() / "mine.xml");
  EXPECT_EQ(run_lamella("plan " + build() + " --machine " + mine + " -o " + mine).exit_code, 1);
  EXPECT_EQ(run_lamella("plan " + build() + " --machine " + mine + " -o " + build()).exit_code, 1);
}

TEST_F(Plan, CheckSaysWhatIsWrongWithMachinesAndPlans) {
  EXPECT_EQ(run_lamella("check " + machine("multi_vat")).exit_code, 0);
  for (const char* sample : {"machine/zero_size.xml", "plan/layer_index_twice.xml"}) {
    const CommandResult result = run_lamella("check " + quoted(source_dir() / "schemas/invalid" / sample) + " --json");
    EXPECT_EQ(result.exit_code, 3) << sample;
    const Json report = parse_output(result);
    EXPECT_EQ(report["ok"], false);
    EXPECT_THAT(report["findings"][0]["where"].get<std::string>(), ::testing::ContainsRegex("\\.xml:[0-9]+"));
  }
}

/// Plans the build and writes its G-code; the quoted options that gcode takes.
std::string gcode_options(const TemporaryFolder& folder, const std::string& build) {
  const CommandResult plan = run_lamella("plan " + build + " --machine " + machine("multi_nozzle") + " -o " +
                                         quoted(folder / "for-gcode.xml") + " --quiet");
  EXPECT_EQ(plan.exit_code, 0) << plan.errors;
  return " --machine " + machine("multi_nozzle") + " --plan " + quoted(folder / "for-gcode.xml");
}

TEST_F(Plan, SliceAndExportWriteTheSameGcode) {
  const std::string options = gcode_options(folder(), build());
  const CommandResult exported =
      run_lamella("export " + build() + " --to gcode -o " + quoted(folder() / "a.gcode") + options + " --json");
  ASSERT_EQ(exported.exit_code, 0) << exported.errors;
  EXPECT_EQ(parse_output(exported)["files"].size(), 1U);
  const CommandResult slice =
      run_lamella("slice " + quoted(datasets_dir() / "connector/connector.step") + " --materials " +
                  quoted(datasets_dir() / "connector/materials.xml") +
                  " --hatch-spacing 0.4 --hatch-angle 45 --rotate-per-layer 90 -o " + quoted(folder() / "again") +
                  " --gcode " + quoted(folder() / "b.gcode") + options);
  ASSERT_EQ(slice.exit_code, 0) << slice.errors;
  EXPECT_EQ(contents(folder() / "a.gcode"), contents(folder() / "b.gcode"));
}

TEST_F(Plan, GcodeNeedsHatchRows) {
  const std::string options = gcode_options(folder(), build());
  ASSERT_EQ(run_lamella("slice " + boxes() + " --machine " + machine("multi_nozzle") + " -o " +
                        quoted(folder() / "unhatched"))
                .exit_code,
            0);
  const CommandResult result = run_lamella("export " + quoted(folder() / "unhatched") + " --to gcode -o " +
                                           quoted(folder() / "none.gcode") + options);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("--hatch-spacing"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "none.gcode"));
}

std::size_t count_matches(const std::string& text, const char* pattern) {
  const std::regex regex(pattern);
  return static_cast<std::size_t>(std::distance(std::sregex_iterator(text.begin(), text.end(), regex), {}));
}

/// The values of an attribute of all elements of a name, in the order of the file.
std::vector<double> numbers_of(const std::string& xml, const std::string& element, const std::string& attribute) {
  const std::regex regex("<" + element + " [^>]*\\b" + attribute + "=\"([^\"]*)\"");
  std::vector<double> out;
  for (std::sregex_iterator at(xml.begin(), xml.end(), regex), end; at != end; ++at) out.push_back(std::stod((*at)[1]));
  return out;
}

/// Plans adaptive layers of the balls on a machine, and holds the plan against the layer table of the build.
void expect_plan_of_adaptive_layers(const char* profile, const std::string& hatch) {
  const TemporaryFolder own;
  const CommandResult result = run_lamella("slice " + spheres() + " --pitch 0.4 --adaptive 0.1 --json --machine " +
                                           machine(profile) + hatch + " -o " + quoted(own / "build"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json sliced = parse_output(result);
  const CommandResult planned = run_lamella("plan " + quoted(own / "build") + " --json --quiet --machine " +
                                            machine(profile) + " -o " + quoted(own / "plan.xml"));
  ASSERT_EQ(planned.exit_code, 0) << planned.errors;
  const Json plan = parse_output(planned);

  const std::string table = contents(own / "build/build.xml");
  const std::string text = contents(own / "plan.xml");
  const std::vector<double> bottoms = numbers_of(table, "layer", "z_bottom");
  const std::vector<double> tops = numbers_of(table, "layer", "z_top");
  EXPECT_EQ(numbers_of(text, "layer", "z_bottom"), bottoms);
  EXPECT_EQ(numbers_of(text, "layer", "z_top"), tops);
  ASSERT_EQ(bottoms.size(), sliced["layers"].get<std::size_t>());
  std::set<long> thicknesses;
  for (std::size_t k = 0; k < tops.size(); ++k) thicknesses.insert(std::lround((tops[k] - bottoms[k]) * 1e6));
  EXPECT_GT(thicknesses.size(), 1U) << "all layers are alike";

  // Each layer by itself: what its steps lay down is their area times its thickness, and its time is made of theirs.
  const std::string profile_text = contents(datasets_dir() / "machines" / (std::string(profile) + ".xml"));
  const double overhead = numbers_of(profile_text, "layer", "overhead").at(0);
  const std::vector<double> times = numbers_of(text, "layer", "time");
  double total = 0.0;
  std::size_t k = 0;
  for (std::size_t at = text.find("<layer "); at != std::string::npos; ++k) {
    const std::size_t next = text.find("<layer ", at + 1);
    const std::string one = text.substr(at, next == std::string::npos ? next : next - at);
    const std::vector<double> areas = numbers_of(one, "step", "area");
    const std::vector<double> volumes = numbers_of(one, "step", "volume");
    ASSERT_EQ(areas.size(), volumes.size());
    for (std::size_t s = 0; s < areas.size(); ++s) {
      EXPECT_NEAR(volumes[s], areas[s] * (tops[k] - bottoms[k]), 1e-9 * areas[s]) << "layer " << k;
    }
    double time = overhead;
    for (const double step : numbers_of(one, "step", "time")) time += step;
    for (const double change : numbers_of(one, "step", "change_time")) time += change;
    EXPECT_NEAR(times[k], time, 1e-9 * time) << "layer " << k;
    total += times[k];
    at = next;
  }
  EXPECT_EQ(k, tops.size());
  EXPECT_NEAR(plan["time"].get<double>(), total, 1e-9 * total);
  for (std::size_t m = 0; m < plan["materials"].size(); ++m) {
    const double volume = sliced["materials"][m]["volume"].get<double>();
    EXPECT_NEAR(plan["materials"][m]["volume"].get<double>(), volume, 1e-9 * volume);
  }
}

TEST(PlanOfAdaptiveLayers, HasTheThicknessesVolumesAndTimesOfTheLayerTable) {
  expect_plan_of_adaptive_layers("multi_vat", "");
  expect_plan_of_adaptive_layers("multi_nozzle", " --hatch-spacing 0.4");
}

/// Compares what a foreign reader says of the build's G-code with its plan. `reader` prints an object of layers with
/// tracks, tool changes, length of tracks by tool in mm, and [x_min, x_max, y_min, y_max] of the tracks.
class ReadGcode : public Plan {
 protected:
  void compare(const std::string& reader) {
    const std::string options = gcode_options(folder(), build());
    ASSERT_EQ(run_lamella("export " + build() + " --to gcode -o " + quoted(folder() / "c.gcode") + options).exit_code,
              0);
    const Json plan = parse_output(run_lamella("plan " + build() + " --machine " + machine("multi_nozzle") + " -o " +
                                               quoted(folder() / "again.xml") + " --json --quiet"));
    const std::size_t filled = count_matches(contents(folder() / "again.xml"), "<layer [^/>]*>");
    const std::size_t tracks = count_matches(contents(folder() / "c.gcode"), "\nG1 X");
    const Json read = parse_output(run_command(reader + " " + quoted(folder() / "c.gcode")));
    EXPECT_EQ(read["changes"], plan["tool_changes"]);
    EXPECT_EQ(read["layers"], filled);
    EXPECT_GT(filled, 40U);
    for (const Json& material : plan["materials"]) {
      const double length = material["length"].get<double>();
      const std::string tool = std::to_string(material["tool"].get<int>());
      // Coordinates have four decimals: an end is off by 0.7e-4 at most.
      EXPECT_NEAR(read["length"][tool].get<double>(), length, 1.5e-4 * static_cast<double>(tracks)) << material["name"];
      EXPECT_NEAR(read["length"][tool].get<double>(), length, 1e-4 * length) << material["name"];
    }
    const double width = sliced()["grid"]["size"][0].get<double>() * 0.1;
    EXPECT_NEAR(read["box"][1].get<double>() - read["box"][0].get<double>(), width, 0.4);
  }
};

// printrun drives printers; its reader knows nothing of ours.
TEST_F(ReadGcode, ByPrintrunHasThePlansToolsLayersAndLengths) {
  ASSERT_EQ(run_command("/usr/bin/python3 -c 'import printrun.gcoder'").exit_code, 0)
      << "scripts/test installs printrun";
  compare("/usr/bin/python3 " + quoted(source_dir() / "tests/apps/read_gcode.py"));
}

TEST_F(ReadGcode, OfARangeThatBeginsInTheAirIsWarnedOf) {
  const std::string options = gcode_options(folder(), build());
  const std::string command = "export " + build() + " --to gcode -o " + quoted(folder() / "r.gcode") + options;
  const CommandResult above = run_lamella(command + " --layers 5:8");
  EXPECT_EQ(above.exit_code, 0) << above.errors;
  EXPECT_THAT(above.errors, ::testing::HasSubstr("in the air, at layer 5"));
  EXPECT_EQ(run_lamella(command + " --layers 0:3").errors.find("in the air"), std::string::npos);
}

// gcode-toolpath draws the ways of milling machines.
TEST_F(ReadGcode, ByGcodeToolpathHasThePlansToolsLayersAndLengths) {
  if (!std::filesystem::exists(source_dir() / "tests/export/node_modules/gcode-toolpath")) {
    GTEST_SKIP() << "needs gcode-toolpath: npm ci in tests/export";
  }
  compare("node " + quoted(source_dir() / "tests/export/read_toolpath.mjs"));
}

}  // namespace
}  // namespace lamella::test
