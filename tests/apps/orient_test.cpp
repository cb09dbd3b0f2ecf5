#include <cmath>
#include <gmock/gmock.h>
#include <sstream>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string connector() { return quoted(datasets_dir() / "connector/connector.step"); }
std::string shipped_machine(const char* name) {
  return quoted(datasets_dir() / "machines" / (std::string(name) + ".xml"));
}

/// The first number behind `key` in some XML.
double attribute(const std::string& xml, const std::string& key) {
  const std::size_t at = xml.find(" " + key + "=\"");
  EXPECT_NE(at, std::string::npos) << key;
  return at == std::string::npos ? std::nan("") : std::stod(xml.substr(at + key.size() + 3));
}

TEST(Orient, HasTheKeysOfTheContract) {
  const CommandResult result = run_lamella("orient " + connector() + " --axis x --axis y --layer-height 0.1 --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json object = parse_output(result);
  expect_keys(object, {"candidates", "least_height", "axis_scheme", "present_height", "weights", "layer_height"});
  ASSERT_EQ(object["candidates"].size(), 5U);
  double score = 0.0;
  for (const Json& one : object["candidates"]) {
    expect_keys(one, {"rotation", "height", "layers", "support_area", "cusp_error", "score", "support_volume",
                      "contact_area", "size", "fits", "tool_changes"});
    EXPECT_GE(one["score"].get<double>(), score - 1e-9);
    score = one["score"];
    EXPECT_EQ(one["layers"].get<long>(), std::lround(std::ceil(one["height"].get<double>() / 0.1 - 1e-6)));
    EXPECT_NEAR(one["size"][2].get<double>(), one["height"].get<double>(), 1e-9);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        double dot = 0.0;
        for (int k = 0; k < 3; ++k) dot += one["rotation"][i][k].get<double>() * one["rotation"][j][k].get<double>();
        EXPECT_NEAR(dot, i == j ? 1.0 : 0.0, 1e-12);
      }
    }
  }
  const double least = object["least_height"]["height"];
  EXPECT_NEAR(object["candidates"][0]["height"].get<double>(), least, 1e-9);
  EXPECT_LE(least, object["axis_scheme"]["height"].get<double>());
  EXPECT_LE(object["least_height"]["gap"].get<double>(), 1e-7);
  EXPECT_LE(object["axis_scheme"]["height"].get<double>(), object["present_height"].get<double>());
}

TEST(Orient, WritesAPageWithAPictureOfEachCandidate) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella("orient " + connector() + " --count 3 --samples 3000 --page " + quoted(folder / "o.html"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = contents(folder / "o.html");
  std::size_t pictures = 0;
  for (std::size_t at = page.find("data:image/png;base64,iVBOR"); at != std::string::npos;
       at = page.find("data:image/png;base64,iVBOR", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 6U) << "from above and from below";
  EXPECT_THAT(page, HasSubstr("Least height over all orientations: 8.65407 mm"));
  EXPECT_EQ(run_lamella("orient " + connector() + " --page " + connector()).exit_code, 1);
  EXPECT_EQ(run_lamella("orient " + connector() + " --page " + quoted(folder / "o.html/below")).exit_code, 4);
}

TEST(Orient, GivesTheSameWithOneThreadAndWithAll) {
  const std::string line = "orient " + connector() + " --weights height=1,support=2 --samples 3000 --json";
  EXPECT_EQ(run_lamella(line + " --threads 1").output, run_lamella(line).output);
}

TEST(Orient, SaysWhenNothingFitsInTheMachine) {
  const TemporaryFolder folder;
  std::string text = contents(datasets_dir() / "machines/material_jetting.xml");
  const std::size_t at = text.find("<volume");
  text.replace(at, text.find("/>", at) + 2 - at, "<volume x=\"9\" y=\"9\" z=\"9\"/>");
  write_text(folder / "small.xml", text);
  const CommandResult small =
      run_lamella("orient " + connector() + " --machine " + quoted(folder / "small.xml") + " --json");
  EXPECT_EQ(small.exit_code, 3);
  EXPECT_THAT(small.errors, HasSubstr("no orientation fits in the machine"));
  EXPECT_FALSE(parse_output(small)["candidates"][0]["fits"].get<bool>());
  const CommandResult large =
      run_lamella("orient " + connector() + " --machine " + shipped_machine("multi_nozzle") + " --json");
  EXPECT_EQ(large.exit_code, 0) << large.errors;
  EXPECT_TRUE(parse_output(large)["candidates"][0]["fits"].get<bool>());
}

TEST(Orient, ANamedSolidsFaceLiesDownAndUnknownNamesAreListed) {
  const CommandResult down = run_lamella("orient " + connector() + " --down '*Row A/Pin.1' --json");
  ASSERT_EQ(down.exit_code, 0) << down.errors;
  EXPECT_EQ(parse_output(down)["candidates"][0]["origin"], "named face down");
  const CommandResult unknown = run_lamella("orient " + connector() + " --down nobody --json");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.errors, HasSubstr("Pin.1"));
  EXPECT_EQ(parse_output(unknown)["error"]["code"], 2);
  EXPECT_EQ(run_lamella("orient " + connector() + " --unsupported '#999999'").exit_code, 2);
}

TEST(Orient, FacesThatCanNotStayFreeOfSupportAreAnError) {
  // A ball has an underside however it lies.
  const std::string ball = quoted(datasets_dir() / "nested_spheres/nested_spheres.step");
  const CommandResult result = run_lamella("orient " + ball + " --unsupported '*' --samples 2000 --gap 1e-3");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("free of support"));
}

TEST(Orient, RefusesWhatMakesNoSense) {
  for (const std::string options : {"--axis 0,0,0",
                                    "--axis nan,0,0",
                                    "--axis w",
                                    "--axis 1,2",
                                    "--axis ''",
                                    "--step 1",
                                    "--axis x --step 0",
                                    "--axis x --step nan",
                                    "--axis x --step 1000",
                                    "--axis x --step 1e-9",
                                    "--weights height=-1",
                                    "--weights height=0",
                                    "--weights height=nan",
                                    "--weights beauty",
                                    "--weights ''",
                                    "--critical-angle 90",
                                    "--critical-angle x",
                                    "--count 0",
                                    "--samples 5",
                                    "--gap 0",
                                    "--gap 1",
                                    "--layer-height 0"}) {
    const CommandResult result = run_lamella("orient " + connector() + " " + options);
    EXPECT_EQ(result.exit_code, 1) << options << "\n" << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("lamella: error: ")) << options;
  }
  EXPECT_EQ(run_lamella("orient /nowhere/x.step").exit_code, 2);
  EXPECT_EQ(run_lamella("slice " + connector() + " -o /tmp/never --down '#1'").exit_code, 1);
  EXPECT_EQ(run_lamella("slice " + connector() + " -o /tmp/never --orient sideways").exit_code, 1);
}

TEST(Orient, ModelsWithoutAClosedSolidAreRefused) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_lamella("orient " + write_open_boxes(folder / "open.step", true)).exit_code, 2);
}

TEST(SliceOrient, TurnsTheAssemblyBeforeItIsSlicedAndRecordsIt) {
  const TemporaryFolder folder;
  const std::string options = " --layer-height 0.1 --pitch 0.1 --json -o ";
  const CommandResult turned =
      run_lamella("slice " + connector() + " --orient height" + options + quoted(folder / "turned"));
  const CommandResult plain = run_lamella("slice " + connector() + options + quoted(folder / "plain"));
  ASSERT_EQ(turned.exit_code, 0) << turned.errors;
  ASSERT_EQ(plain.exit_code, 0) << plain.errors;
  const Json after = parse_output(turned);
  const Json before = parse_output(plain);
  const Json oriented = parse_output(run_lamella("orient " + connector() + " --layer-height 0.1 --json"));
  EXPECT_EQ(after["layers"], oriented["candidates"][0]["layers"]);
  EXPECT_LT(after["layers"].get<int>(), before["layers"].get<int>());
  for (std::size_t i = 0; i < after["solids"].size(); ++i) {
    const double exact = before["solids"][i]["volume_exact"];
    EXPECT_NEAR(after["solids"][i]["volume_exact"].get<double>(), exact, 1e-6 * exact);
    EXPECT_EQ(after["solids"][i]["material"], before["solids"][i]["material"]);
  }
  EXPECT_EQ(after["rotation"], oriented["candidates"][0]["rotation"]);
  EXPECT_FALSE(before.contains("rotation"));
  const std::string xml = contents(folder / "turned/build.xml");
  EXPECT_THAT(xml, HasSubstr("version=\"1.3\""));
  const std::array<const char*, 9> names{"xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"};
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(attribute(xml, names[i]), oriented["candidates"][0]["rotation"][i / 3][i % 3].get<double>()) << names[i];
  EXPECT_THAT(contents(folder / "plain/build.xml"), Not(HasSubstr("orientation")));
  EXPECT_EQ(run_lamella("check " + quoted(folder / "turned")).exit_code, 0);

  // It goes on from the build to what is made of it.
  const Json& rotation = after["rotation"];
  const std::string build = quoted(folder / "turned");
  const CommandResult plan = run_lamella("plan " + build + " --json --quiet -o " + quoted(folder / "plan.xml") +
                                         " --machine " + shipped_machine("multi_nozzle"));
  ASSERT_EQ(plan.exit_code, 0) << plan.errors;
  EXPECT_EQ(parse_output(plan)["rotation"], rotation);
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ(attribute(contents(folder / "plan.xml"), names[i]), rotation[i / 3][i % 3].get<double>());
  EXPECT_EQ(run_lamella("check " + quoted(folder / "plan.xml")).exit_code, 0);
  ASSERT_EQ(run_lamella("export " + build + " --to xml -o " + quoted(folder / "s.xml")).exit_code, 0);
  EXPECT_EQ(run_lamella("check " + quoted(folder / "s.xml")).exit_code, 0);
  const std::string slices = contents(folder / "s.xml");
  const std::size_t at = slices.find("<orientation rotation=\"") + 23;
  std::istringstream rows(slices.substr(at, slices.find('"', at) - at));
  for (int i = 0; i < 9; ++i) {
    double value = 0.0;
    ASSERT_TRUE(rows >> value) << i;
    EXPECT_EQ(value, rotation[i / 3][i % 3].get<double>()) << i;
  }
  EXPECT_EQ(run_lamella("check " + quoted(folder / "turned/build.xml")).exit_code, 0);
}

TEST(SliceOrient, AJobCanAskForIt) {
  const TemporaryFolder folder;
  write_text(folder / "job.xml", "<job xmlns=\"urn:lamella:job:1\" version=\"1.0\">\n<part file=\"" +
                                     (datasets_dir() / "connector/connector.step").string() +
                                     "\"/>\n<options output=\"b\" pitch=\"0.2\" layer-height=\"0.2\" "
                                     "orient=\"height=1,cusp=0.1\" critical-angle=\"40\"/>\n</job>\n");
  const CommandResult result = run_lamella("slice --job " + quoted(folder / "job.xml") + " --json");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(contents(folder / "b/build.xml"), HasSubstr("<orientation "));
}

}  // namespace
}  // namespace lamella::test
