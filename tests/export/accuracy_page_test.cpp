#include "export/accuracy_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

#include "export/log_chart.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++found;
  return found;
}

accuracy::StudyResult sample() {
  accuracy::StudyResult result;
  result.solids = {SolidId{0}};
  result.volume = 1000.0;
  result.area = 600.0;
  result.step_bytes = 20'000;
  result.direct.rays = 400;
  result.direct.hits = 700;
  result.direct.oracle_rays = 100;
  result.direct.errors.matched = 180;
  result.direct.errors.largest = 2e-9;
  result.direct.slice_seconds = 0.01;
  for (const double deflection : {1.0, 0.1}) {
    accuracy::StlResult stl;
    stl.deflection = deflection;
    stl.triangles = 100;
    stl.bytes = 5084;
    stl.errors.matched = 700;
    stl.errors.largest = deflection;
    stl.errors.sum = 70.0 * deflection;
    stl.errors.squares = 7.0 * deflection * deflection;
    stl.distance = {deflection, 0.5 * deflection};
    stl.section_area = 100.0;
    stl.area = {3.0 * deflection, 2.0 * deflection};
    stl.volume_error = 10.0 * deflection;
    stl.tessellate_seconds = 1.0;
    result.stl.push_back(stl);
  }
  accuracy::StlResult skipped;
  skipped.deflection = 1e-3;
  skipped.skipped = "over <b>4 million</b> triangles";
  result.stl.push_back(skipped);
  result.lattices = {{1.0, 100, 3.0, 40.0, 0.87, 0.1}, {0.1, 10000, 0.02, 4.0, 0.087, 0.3}};
  return result;
}

std::string page_of(const accuracy::StudyResult& result, const std::string& title = "a.step") {
  std::ostringstream stream;
  write_accuracy_page(result, title, stream);
  return stream.str();
}

TEST(AccuracyPage, HasSevenChartsWithUnitsAndATableOfEach) {
  const std::string page = page_of(sample());
  EXPECT_EQ(count(page, "<figure>"), 7U);
  EXPECT_EQ(count(page, "deflection in mm<"), 5U);  // nothing was missed, so that chart is a note
  EXPECT_EQ(count(page, "Nothing but zeros"), 1U);
  EXPECT_THAT(page, HasSubstr("pitch in mm, along y and z"));
  EXPECT_THAT(page, HasSubstr("<td>5.08 kB</td>"));
  EXPECT_EQ(count(page, "<table>"), 2U);
}

TEST(AccuracyPage, TextCannotBecomeMarkup) {
  const std::string page = page_of(sample(), "</title><script>alert(1)</script>.step");
  EXPECT_THAT(page, Not(HasSubstr("<script")));
  EXPECT_THAT(page, Not(HasSubstr("<b>4 million")));
  EXPECT_THAT(page, HasSubstr("4 million"));
}

TEST(AccuracyPage, OfNothingMeasuredIsStillAPage) {
  accuracy::StudyResult result = sample();
  result.stl.clear();
  result.lattices.clear();
  result.direct.oracle_rays = 0;
  const std::string page = page_of(result);
  EXPECT_THAT(page, HasSubstr("</html>"));
  EXPECT_THAT(page, Not(HasSubstr("nan")));
}

LogChart chart_of(std::vector<Vec2> points) {
  return {"title", "x in mm", "y in s", {{"name", std::move(points), false}}};
}

/// The centres of the marks.
std::vector<Vec2> marks_in(const std::string& svg) {
  std::vector<Vec2> marks;
  for (std::size_t at = svg.find("cx=\""); at != std::string::npos; at = svg.find("cx=\"", at + 1)) {
    const std::size_t y = svg.find("cy=\"", at);
    marks.emplace_back(std::stod(svg.substr(at + 4)), std::stod(svg.substr(y + 4)));
  }
  return marks;
}

TEST(LogChart, PlacesEqualRatiosAtEqualDistances) {
  const std::vector<Vec2> marks = marks_in(log_chart(chart_of({{1e-3, 1e-6}, {1e-2, 1e-4}, {1e-1, 1e-2}, {1.0, 1.0}})));
  ASSERT_EQ(marks.size(), 4U);
  for (std::size_t i = 2; i < 4; ++i) {
    EXPECT_NEAR((marks[i] - marks[i - 1] - (marks[1] - marks[0])).norm(), 0.0, 0.3);  // one decimal each
  }
  EXPECT_GT(marks[1].x(), marks[0].x());
  EXPECT_LT(marks[1].y(), marks[0].y());
}

TEST(LogChart, LeavesOutWhatHasNoLogarithm) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string svg =
      log_chart(chart_of({{0.0, 1.0}, {1.0, 0.0}, {1.0, -2.0}, {nan, 1.0}, {1.0, infinity}, {10.0, 5.0}}));
  EXPECT_EQ(marks_in(svg).size(), 1U);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(log_chart(chart_of({})), HasSubstr("Nothing but zeros"));
}

TEST(LogChart, TwentyDecadesKeepTheirTicksFew) {
  const std::string svg = log_chart(chart_of({{1e-3, 1e-12}, {1.0, 1e8}}));
  EXPECT_LE(count(svg, "class=\"grid\""), 16U);
}

}  // namespace
}  // namespace lamella
