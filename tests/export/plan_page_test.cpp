#include "export/plan_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::string page_of(const BuildPlan& plan) {
  BuildInfo info;
  info.sources = {{"a <b>.step", "AP214", "mm", 1.0, ""}};
  std::ostringstream stream;
  write_plan_page(plan, info, stream);
  return stream.str();
}

BuildPlan sample() { return read_plan_xml(test::source_dir() / "schemas/valid/plan/two_tools.xml"); }

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

TEST(PlanPage, HasThreeChartsWithUnits) {
  const std::string page = page_of(sample());
  EXPECT_EQ(count(page, "<svg "), 3U);
  EXPECT_EQ(count(page, "</svg>"), 3U);
  EXPECT_EQ(count(page, "height z in mm<"), 3U);
  EXPECT_THAT(page, HasSubstr("area in mm\u00b2"));
  EXPECT_THAT(page, HasSubstr("time per layer in s"));
  EXPECT_THAT(page, HasSubstr("prefers-color-scheme:dark"));
  EXPECT_THAT(page, HasSubstr("3.5 mm^2 lie over nothing"));
}

TEST(PlanPage, NamesCannotBecomeMarkup) {
  BuildPlan plan = sample();
  plan.machine = "<script>alert(1)</script>";
  plan.materials[0].name = "\"><img src=x>";
  plan.tools[0] = "</svg><b>";
  plan.currency = "<i>";
  plan.findings[0].what = "<u>";
  const std::string page = page_of(plan);
  for (const char* tag : {"<script", "<img", "<b>.", "</svg><b", "<i>", "<u>"}) {
    EXPECT_THAT(page, Not(HasSubstr(tag))) << tag;
  }
}

TEST(PlanPage, OfNoLayersIsStillAPage) {
  const std::string page = page_of(read_plan_xml(test::source_dir() / "schemas/valid/plan/empty.xml"));
  EXPECT_THAT(page, HasSubstr("DOES NOT FIT"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

TEST(PlanPage, ManyLayersShareColumns) {
  BuildPlan plan = sample();
  const PlanLayer layer = plan.layers[1];
  for (std::uint32_t k = 3; k < 20000; ++k) {
    plan.layers.push_back(layer);
    plan.layers.back().index = k;
    plan.layers.back().z_bottom = 0.2 * k;
    plan.layers.back().z_top = 0.2 * (k + 1);
  }
  EXPECT_LT(page_of(plan).size(), 200000U);
}

}  // namespace
}  // namespace lamella
