#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "core/error.h"
#include "slicing/plan/build_plan.h"
#include "tests/support/schema_samples.h"

namespace lamella {
namespace {

std::string written(const BuildPlan& plan) {
  std::ostringstream stream;
  write_plan_xml(plan, stream);
  return stream.str();
}

TEST(PlanXml, SchemaAndReaderJudgeTheSamplesAlike) { test::expect_samples_to_be_judged("plan", 3, 27, read_plan_xml); }

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
                      std::pair{"reloads=\"0\"", "reloads=\"1\""}, std::pair{"time=\"60\"", "time=\"61\""},
                      std::pair{"volume=\"40\"", "volume=\"41\""}, std::pair{"z_top=\"0.2\"", "z_top=\"-1\""},
                      std::pair{"tools=\"0\"", "tools=\"7\""}));

}  // namespace
}  // namespace lamella
