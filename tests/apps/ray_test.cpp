#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <sstream>
#include <vector>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

/// The middle of the first solid of the boxes, "x,y,z".
std::string middle(const Json& info) {
  const Json& bounds = info["solids"][0]["bounds"];
  std::string text;
  for (int axis = 0; axis < 3; ++axis) {
    const double value = 0.5 * (bounds[0][axis].get<double>() + bounds[1][axis].get<double>());
    text.append(axis == 0 ? "" : ",").append(Json(value).dump());
  }
  return text;
}

TEST(Ray, JsonHasTheDocumentedKeys) {
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  const CommandResult result = run_lamella("ray " + boxes() + " --from " + middle(info) + " --dir 0.3,0.1,0.2 --json");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json ray = parse_output(result);
  expect_keys(ray, {"hits", "spans", "segments"});
  ASSERT_FALSE(ray["hits"].empty());
  expect_keys(ray["hits"][0], {"t", "point", "solid", "face", "sense", "uv"});
  expect_keys(ray["spans"][0], {"solid", "t_in", "t_out"});
  expect_keys(ray["segments"][0], {"t_begin", "t_end", "material", "solid"});
  EXPECT_EQ(ray["hits"].front()["sense"], "entry");
  EXPECT_EQ(ray["hits"].back()["sense"], "exit");
}

TEST(Ray, TheLengthThroughABoxIsItsSize) {
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  const Json ray = parse_output(run_lamella("ray " + boxes() + " --from " + middle(info) + " --dir 0,0,7 --json"));
  const Json& bounds = info["solids"][0]["bounds"];
  const double height = bounds[1][2].get<double>() - bounds[0][2].get<double>();
  for (const Json& span : ray["spans"]) {
    if (span["solid"] != 0) continue;
    EXPECT_NEAR(span["t_out"].get<double>(), height / 2, 1e-9);
    EXPECT_NEAR(span["t_in"].get<double>(), -height / 2, 1e-9);
    return;
  }
  FAIL() << ray;
}

TEST(Ray, ManyRaysGiveOneObjectALineInOrder) {
  const TemporaryFolder folder;
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  std::string from = middle(info);
  std::replace(from.begin(), from.end(), ',', ' ');
  write_text(folder / "rays.txt", from + " 1 0 0\n\n1e6 1e6 1e6 1 0 0\r\n  " + from + "\t0 1e-3 0 \n");
  for (const std::string& input : {quoted(folder / "rays.txt"), "- < " + quoted(folder / "rays.txt")}) {
    const CommandResult result = run_lamella("ray " + boxes() + " --json --rays " + input);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    std::istringstream lines(result.output);
    std::vector<Json> rays;
    for (std::string line; std::getline(lines, line);) rays.push_back(Json::parse(line));
    ASSERT_EQ(rays.size(), 3U);
    EXPECT_FALSE(rays[0]["hits"].empty());
    EXPECT_TRUE(rays[1]["hits"].empty());
    EXPECT_FALSE(rays[2]["hits"].empty());
  }
}

TEST(Ray, ABadLineIsNamed) {
  const TemporaryFolder folder;
  for (const char* line : {"1 2 3", "1 2 3 4 5 x", "1 2 3 4 5 6 7", "0 0 0 0 0 0", "nan 0 0 1 0 0", "1,2,3,4,5,6"}) {
    write_text(folder / "rays.txt", std::string("0 0 0 1 0 0\n") + line + "\n");
    const CommandResult result = run_lamella("ray " + boxes() + " --rays " + quoted(folder / "rays.txt"));
    EXPECT_EQ(result.exit_code, 2) << line << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("rays.txt:2")) << line;
  }
}

TEST(Ray, AFolderOfRaysAndAPointOutOfReachAreRefused) {
  const TemporaryFolder folder;
  EXPECT_EQ(run_lamella("ray " + boxes() + " --rays " + quoted(folder.path())).exit_code, 2);
  EXPECT_EQ(run_lamella("ray " + boxes() + " --from 1e300,0,5 --dir 1,0,0").exit_code, 1);
}

/// Rays through the middle of the grip: horizontal ones in several directions.
std::vector<std::string> horizontal_rays() {
  return {"20 0.3 1.7 1 0 0", "20 0.3 1.7 0 -1 0", "60 2 -3.1 0.6 0.8 0", "24 -4 6.3 -0.8 0.6 0", "0 0 0.01 1 0 0"};
}

TEST(Ray, BothEnginesGiveTheSameHits) {
  const std::string grip = quoted(datasets_dir() / "overmoulded_grip/overmoulded_grip.step");
  const TemporaryFolder folder;
  std::string lines;
  for (const std::string& ray : horizontal_rays()) lines += ray + "\n";
  write_text(folder / "rays.txt", lines);
  std::vector<std::vector<Json>> found;
  for (const std::string engine : {"span", "reference"}) {
    const CommandResult result =
        run_lamella("ray " + grip + " --json --rays " + quoted(folder / "rays.txt") + " --engine " + engine);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    std::istringstream stream(result.output);
    found.emplace_back();
    for (std::string line; std::getline(stream, line);) found.back().push_back(Json::parse(line));
  }
  ASSERT_EQ(found[0].size(), horizontal_rays().size());
  for (std::size_t r = 0; r < found[0].size(); ++r) {
    const Json& spans = found[0][r]["hits"];
    const Json& rays = found[1][r]["hits"];
    ASSERT_EQ(spans.size(), rays.size()) << r;
    ASSERT_FALSE(rays.empty());
    for (const Json& expected : rays) {
      // Faces that touch have hits of one depth, in either order.
      const auto is_same = [&](const Json& hit) {
        return hit["face"] == expected["face"] && hit["sense"] == expected["sense"] &&
               std::abs(hit["t"].get<double>() - expected["t"].get<double>()) < 1e-6;
      };
      const auto hit = std::find_if(spans.begin(), spans.end(), is_same);
      ASSERT_NE(hit, spans.end()) << r << expected;
      for (int axis = 0; axis < 2; ++axis) {
        EXPECT_NEAR((*hit)["uv"][axis].get<double>(), expected["uv"][axis].get<double>(), 1e-5) << *hit << expected;
      }
    }
  }
}

TEST(Ray, TheSpanEngineTakesHorizontalRaysOnly) {
  const TemporaryFolder folder;
  write_text(folder / "rays.txt", "0 0 0 1 0 0\n0 0 0 1 0 1e-9\n");
  const CommandResult result = run_lamella("ray " + boxes() + " --engine span --rays " + quoted(folder / "rays.txt"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("rays.txt:2"));
  EXPECT_THAT(result.errors, HasSubstr("--engine reference"));
}

TEST(Ray, TextNamesUnitsAndSolids) {
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  const CommandResult result = run_lamella("ray " + boxes() + " --from " + middle(info) + " --dir 1,0,0");
  EXPECT_THAT(result.output, HasSubstr("t [mm]"));
  EXPECT_THAT(result.output, HasSubstr(info["solids"][0]["path"].get<std::string>()));
}

}  // namespace
}  // namespace lamella::test
