// The generator's own mathematics, and that it still makes the files that are shipped.
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <sstream>

#include "datasets/generator/bernstein.h"
#include "datasets/generator/spline.h"
#include "datasets/generator/step_text.h"
#include "datasets/generator/terrace.h"
#include "tests/support/paths.h"

namespace lamella::datasets {
namespace {

constexpr double kPi = 3.14159265358979323846;

std::string content(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

TEST(Generator, MakesTheShippedFilesByteForByte) {
  const test::TemporaryFolder folder;
  const std::string command = std::string("\"" LAMELLA_DATASETS_PROGRAM "\" \"").append(folder.path()).append("\"");
  ASSERT_EQ(std::system(command.c_str()), 0);
  std::size_t compared = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
    if (!entry.is_regular_file()) continue;
    const auto shipped = test::datasets_dir() / std::filesystem::relative(entry.path(), folder.path());
    EXPECT_TRUE(content(entry.path()) == content(shipped)) << shipped;
    ++compared;
  }
  EXPECT_EQ(compared, 14u * 2 + 1);
}

TEST(Spline, QuadratureIsExactForPolynomialsOfDegree23) {
  EXPECT_NEAR(integrate(0, 1, [](double x) { return std::pow(x, 23); }), 1.0 / 24, 1e-16);
  EXPECT_GT(std::abs(integrate(0, 1, [](double x) { return std::pow(x, 40); }) - 1.0 / 41), 1e-16);
}

TEST(Spline, GraphSplineHasItsAbscissaAsParameter) {
  const SplineCurve f = graph_spline({0, 1, 4, 5}, {1, 2, -1, 3, 0, 2});
  for (const double x : {0.0, 0.3, 1.0, 2.7, 4.0, 4.9, 5.0}) EXPECT_NEAR(f.point(x)[0], x, 1e-14);
}

TEST(Spline, RevolvedStraightLineIsACone) {
  const SplineCurve line = graph_spline({0, 3}, {2, 5}, 1);
  EXPECT_NEAR(revolved_volume(line, 0, 3), kPi * 3 / 3 * (4 + 10 + 25), 1e-11);
}

TEST(Spline, FrameDerivativesAreThoseOfDifferences) {
  const SplineSurface s = height_patch({0, 4, 0, 2}, 3, [](double x, double y) { return std::sin(x) * y; });
  const double h = 1e-6;
  const auto f = s.frame(1.3, 0.7), next_u = s.frame(1.3 + h, 0.7), next_v = s.frame(1.3, 0.7 + h);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(f.du[c], (next_u.point[c] - f.point[c]) / h, 1e-5);
    EXPECT_NEAR(f.dv[c], (next_v.point[c] - f.point[c]) / h, 1e-5);
  }
}

TEST(Lift, CurveLiesOnTheFieldAndOnTheWall) {
  const SplineSurface field =
      height_patch({-5, 7, -3, 6}, 3, [](double x, double y) { return std::cos(x) + 0.3 * x * y; });
  for (const double weight : {1.0, 0.6}) {
    const SplineCurve plan = conic({-2, 1, 0}, {1, 5, 0}, {4, 0, 0}, weight);
    const SplineCurve curve = lift(plan, field), trace = over_parameter(curve);
    EXPECT_EQ(curve.degree, 12);
    for (const double t : {0.0, 0.17, 0.5, 0.81, 1.0}) {
      const Point foot = plan.point(t), p = curve.point(t), on_wall = trace.point(t);
      EXPECT_NEAR(p[0], foot[0], 1e-13);
      EXPECT_NEAR(p[1], foot[1], 1e-13);
      EXPECT_NEAR(p[2], field.frame(foot[0], foot[1]).point[2], 1e-13);
      EXPECT_NEAR(on_wall[0], t, 1e-14);
      EXPECT_NEAR(on_wall[1], p[2], 1e-13);
    }
  }
}

TEST(VolumeUnder, ParaboloidOverACircle) {
  // The pole at the middle of a quadratic patch makes z = x^2 + y^2 from -r^2 there and r^2 at the sides.
  const double r = 2.0, x0 = -3, x1 = 3;
  const SplineSurface bowl = height_patch({x0, x1, x0, x1}, 2, [&](double x, double y) {
    const auto square = [&](double c) { return c == 0.0 ? -9.0 : 9.0; };
    return square(x) + square(y);
  });
  EXPECT_NEAR(bowl.frame(1, 2).point[2], 5.0, 1e-14);
  EXPECT_NEAR(volume_under(bowl, circle_plan(0, 0, r)), kPi * std::pow(r, 4) / 2, 1e-12);
}

TEST(VolumeUnder, PlansAreCounterClockwise) {
  const SplineSurface one = height_patch({-20, 20, -20, 20}, 1, [](double, double) { return 1.0; });
  EXPECT_NEAR(volume_under(one, circle_plan(3, -2, 1.5)), kPi * 2.25, 1e-13);
  EXPECT_NEAR(volume_under(one, eye(1, 1, 4, 1.5, 0.3)), 16.0, 1e-12);  // two parabolic segments of 2/3 * 8 * 1.5
  EXPECT_GT(volume_under(one, squircle({0, 0, 8, 6, 2, 0.5, 0.7})), 16 * 12 - 16.0);
  EXPECT_GT(volume_under(one, kidney(5, 9, 0.2, 1.0)), 0.5 * (81 - 25) * 0.8);
}

TEST(StepText, NamesUnitsAndContextsAreNormalised) {
  const std::string text =
      "#1 = PRODUCT('\xC3\x9C"
      "berzug');\n#2 = DERIVED_UNIT_ELEMENT(#5,3.);\n#3 = DERIVED_UNIT_ELEMENT(#6,2.);\n";
  EXPECT_EQ(normalised(text),
            "#1 = PRODUCT('\\X2\\00DC\\X0\\berzug');\n#2 = DERIVED_UNIT_ELEMENT(#5,1.);\n"
            "#3 = DERIVED_UNIT_ELEMENT(#6,-3.);\n");
}

TEST(StepText, MirroringAnUnknownInstanceIsRefused) {
  EXPECT_THROW((void)with_mirrored_instance("#1 = PRODUCT('a');\n", "nobody", {0, 0, 0}), std::runtime_error);
}

}  // namespace
}  // namespace lamella::datasets
