#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "core/error.h"
#include "slicing/plan/build_plan.h"
#include "tests/support/schema_samples.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

std::string written(const BuildPlan& plan) {
  std::ostringstream stream;
  write_plan_xml(plan, stream);
  return stream.str();
}

TEST(PlanXml, SchemaAndReaderJudgeTheSamplesAlike) { test::expect_samples_to_be_judged("plan", 4, 35, read_plan_xml); }

TEST(PlanXml, ReadsBackAsItWasWritten) {
  const BuildPlan plan = read_plan_xml(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  EXPECT_EQ(plan.layers.size(), 3U);
  EXPECT_EQ(plan.materials[1].name, "Grün & weich");
  EXPECT_FALSE(plan.materials[1].mass);
  EXPECT_EQ(plan.layers[2].steps[0].tool, ToolId{1});
  const test::TemporaryFolder folder;
  std::ofstream(folder / "again.xml") << written(plan);
  EXPECT_TRUE(test::schema_accepts("plan", folder / "again.xml"));
  EXPECT_EQ(written(read_plan_xml(folder / "again.xml")), written(plan));
}

TEST(PlanXml, SaysHowTheToolsWereChosen) {
  const BuildPlan plan = read_plan_xml(test::source_dir() / "schemas/valid/plan/weighed.xml");
  ASSERT_TRUE(plan.matching);
  EXPECT_EQ(plan.matching->weighed, 2U);
  EXPECT_TRUE(plan.matching->is_proved);
  const test::TemporaryFolder folder;
  std::ofstream(folder / "again.xml") << written(plan);
  EXPECT_TRUE(test::schema_accepts("plan", folder / "again.xml"));
  EXPECT_EQ(written(read_plan_xml(folder / "again.xml")), written(plan));
  EXPECT_FALSE(read_plan_xml(test::source_dir() / "schemas/valid/plan/two_tools.xml").matching);
}

TEST(PlanXml, SaysHowTheAssemblyWasTurned) {
  BuildPlan plan = read_plan_xml(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  EXPECT_FALSE(plan.turn.has_value());
  EXPECT_EQ(written(plan).find("orientation"), std::string::npos);
  plan.turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const test::TemporaryFolder folder;
  std::ofstream(folder / "turned.xml") << written(plan);
  EXPECT_TRUE(test::schema_accepts("plan", folder / "turned.xml"));
  const BuildPlan again = read_plan_xml(folder / "turned.xml");
  ASSERT_TRUE(again.turn.has_value());
  EXPECT_EQ(*again.turn, *plan.turn);
  plan.turn = Mat3(0.5 * *plan.turn);
  std::ofstream(folder / "shrunk.xml") << written(plan);
  EXPECT_THROW((void)read_plan_xml(folder / "shrunk.xml"), InputError);
}

/// A plan of so many layers of so many materials, in which every figure of a step differs from its neighbours'.
BuildPlan plan_of(std::size_t layers, std::size_t materials) {
  BuildPlan plan;
  plan.machine = "large";
  plan.currency = "EUR";
  plan.width = 0.4;
  for (std::size_t m = 0; m < materials; ++m) {
    plan.tools.push_back("tool " + std::to_string(m));
    PlanMaterial& material = plan.materials.emplace_back();
    material.name = "material " + std::to_string(m);
    material.tools = {ToolId{m}};
    material.density = 1.1;
  }
  for (std::size_t k = 0; k < layers; ++k) {
    const double z = 0.1 * static_cast<double>(k);
    PlanLayer& layer = plan.layers.emplace_back();
    layer.index = static_cast<std::uint32_t>(k);
    layer.z_bottom = z;
    layer.z_top = z + 0.1;
    layer.time = 17.0 + 1e-3 * static_cast<double>(k);
    plan.time += layer.time;
    for (std::size_t m = 0; m < materials; ++m) {
      const double figure = static_cast<double>(k * materials + m + 1);
      PlanStep& step = layer.steps.emplace_back();
      step.material = MaterialId{m};
      step.tool = ToolId{m};
      step.is_change = k + m > 0 && (m > 0 || materials > 1);
      plan.tool_changes += step.is_change ? 1 : 0;
      step.time = 1.0 / figure;
      step.change_time = step.is_change ? 1.0 / 3.0 : 0.0;
      step.volume = figure / 7.0;
      plan.materials[m].volume += step.volume;
      step.statistics = {
          MaterialId{m}, 2 * k + m, figure / 3.0, figure / 11.0, figure / 0.7, 1.0 / (figure + 2.0), 0.125, 3, 1,
          figure / 13.0, 1.0 / 9.0};
    }
  }
  return plan;
}

TEST(PlanXml, OfFiveThousandLayersOfEightMaterialsIsReadBack) {
  const test::TemporaryFolder folder;
  const BuildPlan plan = plan_of(5000, 8);
  const std::string text = written(plan);
  std::ofstream(folder / "large.xml") << text;
  const BuildPlan again = read_plan_xml(folder / "large.xml");
  EXPECT_EQ(again.layers.size(), 5000U);
  EXPECT_EQ(again.layers.back().steps.size(), 8U);
  EXPECT_TRUE(written(again) == text);
}

TEST(PlanXml, LargerThanASettingsFileMayBeIsReadBack) {
  const test::TemporaryFolder folder;
  const std::string text = written(plan_of(9000, 24));
  ASSERT_GT(text.size(), std::size_t{64} << 20);
  std::ofstream(folder / "larger.xml") << text;
  EXPECT_TRUE(written(read_plan_xml(folder / "larger.xml")) == text);
}

TEST(PlanXml, BombsAreRefused) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& text) -> std::string {
    std::ofstream(folder / "bomb.xml") << text;
    try {
      (void)read_plan_xml(folder / "bomb.xml");
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  std::ifstream stream(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  const std::string sample{std::istreambuf_iterator<char>(stream), {}};
  const std::size_t layer = sample.find("  <layer ");
  const std::string head = sample.substr(0, layer);
  EXPECT_THAT(refusal(head + "<!DOCTYPE p [<!ENTITY a '&b;&b;'>]>" + sample.substr(layer)), HasSubstr("document type"));
  const std::string step =
      sample.substr(sample.find("<step"), sample.find("/>", sample.find("<step")) + 2 - sample.find("<step"));
  std::string steps;
  while (steps.size() < (std::size_t{66} << 20)) steps += step;
  EXPECT_THAT(refusal(head + "<layer index=\"0\" z_bottom=\"0\" z_top=\"1\" time=\"0\">" + steps + "</layer></plan>"),
              HasSubstr("too large"));
  EXPECT_THAT(
      refusal(head + "<layer index=\"0\" z_bottom=\"0\" z_top=\"1\" time=\"0\">" + step + step + "</layer></plan>"),
      HasSubstr("twice"));
  std::filesystem::resize_file(folder / "bomb.xml", kMaxPlanBytes + 1);
  EXPECT_THROW((void)read_plan_xml(folder / "bomb.xml"), InputError);
}

TEST(PlanXml, PartsInTheWrongOrderAreRefused) {
  std::ifstream stream(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const test::TemporaryFolder folder;
  const auto cut = [&](const char* from, const char* to) {
    const std::size_t begin = text.find(from);
    return text.substr(begin, text.find(to, begin) + std::string(to).size() - begin);
  };
  const std::string tools = cut("<tools>", "</tools>");
  const std::string findings = cut("<findings>", "</findings>");
  const auto judge = [&](const std::string& was, const std::string& becomes) {
    std::string changed = text;
    changed.replace(changed.find(was), was.size(), becomes);
    std::ofstream(folder / "p.xml") << changed;
    EXPECT_FALSE(test::schema_accepts("plan", folder / "p.xml")) << becomes;
    EXPECT_FALSE(test::reader_accepts(read_plan_xml, folder / "p.xml")) << becomes;
  };
  judge(findings, "");
  judge(findings, findings + findings);
  judge(findings, findings + "<support material=\"gel\" volume=\"20\"/>");
  judge(tools, "");
  judge("</plan>", tools + "</plan>");
  judge("</plan>", "<other/></plan>");
}

TEST(PlanXml, CutOffAnywhereIsAnInputError) {
  std::ifstream stream(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  const test::TemporaryFolder folder;
  for (std::size_t size = 0; size + 10 < text.size(); size += 11) {
    std::ofstream(folder / "cut.xml") << text.substr(0, size);
    EXPECT_THROW((void)read_plan_xml(folder / "cut.xml"), InputError) << size;
  }
}

/// Totals that the schema can't compare with the layers.
class PlanSlip : public ::testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(PlanSlip, IsRefused) {
  std::ifstream stream(test::source_dir() / "schemas/valid/plan/two_tools.xml");
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  const std::string was = GetParam().first;
  ASSERT_NE(text.find(was), std::string::npos);
  text.replace(text.find(was), was.size(), GetParam().second);
  const test::TemporaryFolder folder;
  std::ofstream(folder / "p.xml") << text;
  EXPECT_TRUE(test::schema_accepts("plan", folder / "p.xml"));
  EXPECT_FALSE(test::reader_accepts(read_plan_xml, folder / "p.xml"));
}

INSTANTIATE_TEST_SUITE_P(
    PlanXml, PlanSlip,
    ::testing::Values(std::pair{"layers=\"3\"", "layers=\"4\""}, std::pair{"tool_changes=\"2\"", "tool_changes=\"1\""},
                      std::pair{"tool_changes_bound=\"2\"", "tool_changes_bound=\"3\""},
                      std::pair{"reloads_bound=\"0\"", "reloads_bound=\"0\" matchings=\"2\""},
                      std::pair{"reloads=\"0\"", "reloads=\"1\""}, std::pair{"time=\"60\"", "time=\"61\""},
                      std::pair{"volume=\"40\"", "volume=\"41\""}, std::pair{"z_top=\"0.2\"", "z_top=\"-1\""},
                      std::pair{"tools=\"0\"", "tools=\"7\""}));

}  // namespace
}  // namespace lamella
