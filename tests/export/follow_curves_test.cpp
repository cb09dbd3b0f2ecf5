/// Curves in place of chords, against closed forms: what is left of a disc behind a line and behind another disc,
/// whatever the number of chords, and the forms that STEP has for stretches.

#include "export/follow_curves.h"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "export/step_curves.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

using Polygon = std::vector<Vec2>;

/// A disc as a polygon of `count` chords, a closed curve, from angle `from` on.
void add_disc(std::size_t solid, const Vec2& centre, double radius, int count, double from, LayerContours& out) {
  Polygon polygon;
  for (int i = 0; i < count; ++i) {
    const double angle = from + kTwoPi * i / count;
    polygon.emplace_back(centre.x() + radius * std::cos(angle), centre.y() + radius * std::sin(angle));
  }
  const ContourCurve curve{0,
                           static_cast<std::uint64_t>(count),
                           CurveKind::ellipse,
                           {centre.x(), centre.y(), radius, 0, 0, radius, from, kTwoPi}};
  out.add({SolidId{solid}, -1, kPi * radius * radius}, polygon, std::array{curve});
}

BuildInfo two_solids(int first, int second) {
  Grid grid;
  grid.size = {10, 10, 1};
  BuildInfo info = make_build(grid, {"a", "b"});
  info.solids[SolidId{0}].priority = first;
  info.solids[SolidId{1}].priority = second;
  info.plan.chord_error = 0.1;
  info.plan.curves = true;
  return info;
}

/// Half the integral of x dy - y dx along the stretches, by Simpson's rule.
double area_of(const std::vector<CurveStretch>& loop) {
  constexpr int kSteps = 400;
  double sum = 0.0;
  for (const CurveStretch& stretch : loop) {
    const double step = (stretch.end - stretch.begin) / kSteps;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = stretch.begin + i * step;
      const Vec2 p = stretch.carrier.at(t);
      const Vec2 v = stretch.carrier.slope(t);
      const double weight = i == 0 || i == kSteps ? 1.0 : i % 2 == 1 ? 4.0 : 2.0;
      sum += weight * step / 3.0 * 0.5 * (p.x() * v.y() - p.y() * v.x());
    }
  }
  return sum;
}

double largest_gap(const std::vector<CurveStretch>& loop) {
  double gap = 0.0;
  for (std::size_t i = 0; i < loop.size(); ++i)
    gap = std::max(gap, (loop[(i + 1) % loop.size()].first() - loop[i].last()).norm());
  return gap;
}

std::vector<std::vector<CurveStretch>> follow(const LayerContours& contours, const BuildInfo& info, std::size_t id) {
  const MaterialContours materials = ContourCombiner(info, "test").combine(contours);
  const CurveFollower follower(contours, 0.1);
  std::vector<std::vector<CurveStretch>> loops;
  for (const MaterialLoop& loop : materials[MaterialId{id}]) loops.push_back(follower.follow(loop));
  return loops;
}

TEST(CurveFollower, ADiscBehindALineIsItsSegment) {
  // Of the disc x < 1 is left: pi r^2 less r^2 acos(h / r) - h sqrt(r^2 - h^2).
  const double r = 3.0;
  const double h = 1.0;
  const double left = kPi * r * r - (r * r * std::acos(h / r) - h * std::sqrt(r * r - h * h));
  for (const int chords : {17, 40, 400}) {
    for (const double from : {0.0, 0.3, 3.0}) {
      LayerContours contours;
      add_disc(0, Vec2::Zero(), r, chords, from, contours);
      contours.add({SolidId{1}, -1, 100.0}, Polygon{{1, -5}, {11, -5}, {11, 5}, {1, 5}});
      const auto loops = follow(contours, two_solids(0, 1), 0);
      ASSERT_EQ(loops.size(), 1U);
      EXPECT_NEAR(area_of(loops[0]), left, 1e-8) << chords << ' ' << from;
      EXPECT_LT(largest_gap(loops[0]), 1e-9);
      EXPECT_LE(loops[0].size(), 3U);  // the line, and the arc in two where its node is
    }
  }
}

TEST(CurveFollower, TwoDiscsEndWhereTheyCross) {
  const double d = 2.5;
  const double a = 2.0;
  const double b = 1.6;
  // The lens of two circles.
  const double first = std::acos((d * d + a * a - b * b) / (2 * d * a));
  const double second = std::acos((d * d + b * b - a * a) / (2 * d * b));
  const double root = std::sqrt((-d + a + b) * (d + a - b) * (d - a + b) * (d + a + b));
  const double lens = a * a * first + b * b * second - 0.5 * root;
  for (const int chords : {23, 101}) {
    LayerContours contours;
    add_disc(0, Vec2(0.2, 0.1), a, chords, 0.4, contours);
    add_disc(1, Vec2(0.2 + d * std::cos(0.7), 0.1 + d * std::sin(0.7)), b, chords + 6, 1.0, contours);
    const auto loops = follow(contours, two_solids(0, 1), 0);
    ASSERT_EQ(loops.size(), 1U);
    EXPECT_NEAR(area_of(loops[0]), kPi * a * a - lens, 1e-8);
    EXPECT_LT(largest_gap(loops[0]), 1e-9);
    const auto whole = follow(contours, two_solids(0, 1), 1);
    ASSERT_EQ(whole.size(), 1U);
    ASSERT_EQ(whole[0].size(), 1U);
    EXPECT_NEAR(area_of(whole[0]), kPi * b * b, 1e-9);
  }
}

TEST(CurveFollower, AHoleRunsTheOtherWayRound) {
  LayerContours contours;
  contours.add({SolidId{0}, -1, 64.0}, Polygon{{-4, -4}, {4, -4}, {4, 4}, {-4, 4}});
  add_disc(1, Vec2(0.5, 0.0), 2.0, 30, 0.1, contours);
  const auto loops = follow(contours, two_solids(0, 1), 0);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_NEAR(area_of(loops[0]), 64.0, 1e-9);
  EXPECT_NEAR(area_of(loops[1]), -kPi * 4.0, 1e-9);
  EXPECT_EQ(loops[1].size(), 1U);
}

TEST(StepCurves, ConicsRunAlongTheirStretchesFromItsBeginToItsEnd) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-3.0, 3.0);
  for (int n = 0; n < 500; ++n) {
    CurveStretch stretch;
    const bool is_round = n % 5 == 0;
    const Vec2 r0(number(random), number(random));
    const Vec2 r1 = is_round ? Vec2(-r0.y(), r0.x()) : Vec2(number(random), number(random));
    stretch.carrier = {
        CurveKind::ellipse,
        {number(random), number(random), r0.x(), r0.y(), r1.x(), r1.y(), number(random), number(random)}};
    stretch.begin = 0.5 + 0.1 * number(random);
    stretch.end = 0.5 + 0.1 * number(random);
    const ConicArc arc = conic_of(stretch);
    EXPECT_NEAR(arc.major.dot(arc.minor), 0.0, 1e-12);
    EXPECT_GE(arc.major.norm(), arc.minor.norm() - 1e-12);
    EXPECT_GE(arc.begin, 0.0);
    EXPECT_LT(arc.begin, kTwoPi);
    for (const double share : {0.0, 0.3, 1.0}) {
      const double angle = arc.begin + share * arc.sweep;
      const Vec2 at = arc.center + std::cos(angle) * arc.major + std::sin(angle) * arc.minor;
      const Vec2 wanted = stretch.carrier.at(stretch.begin + share * (stretch.end - stretch.begin));
      ASSERT_LT((at - wanted).norm(), 1e-11) << n;
    }
  }
}

CurveCarrier random_conic(std::mt19937& random) {
  std::uniform_real_distribution<double> number(-3.0, 3.0);
  CurveCarrier conic;
  conic.kind = CurveKind::conic;
  for (std::size_t i = 0; i < 6; ++i) conic.numbers[i] = number(random);
  conic.numbers[6] = std::exp(0.5 * number(random));
  return conic;
}

TEST(StepCurves, PolesOfAConicsStretchGiveItsPoints) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (int n = 0; n < 200; ++n) {
    const CurveStretch stretch{random_conic(random), share(random), share(random)};
    const RationalBezier bezier = rational_of(stretch);
    EXPECT_LT((bezier.poles[0] - stretch.first()).norm(), 1e-12);
    EXPECT_LT((bezier.poles[2] - stretch.last()).norm(), 1e-12);
    // Of the same conic: each point is one of the whole's, next to where it is sought.
    for (double t = 0.0; t <= 1.0; t += 0.125) {
      const double w0 = (1.0 - t) * (1.0 - t) * bezier.weights[0];
      const double w1 = 2.0 * t * (1.0 - t) * bezier.weights[1];
      const double w2 = t * t * bezier.weights[2];
      const Vec2 at = (w0 * bezier.poles[0] + w1 * bezier.poles[1] + w2 * bezier.poles[2]) / (w0 + w1 + w2);
      const double begin = std::min(stretch.begin, stretch.end);
      const double end = std::max(stretch.begin, stretch.end);
      double nearest = 1e9;
      for (int i = 0; i <= 64; ++i) {
        const double near = stretch.carrier.nearest(at, begin + (end - begin) * i / 64.0);
        if (near > begin - 1e-9 && near < end + 1e-9)
          nearest = std::min(nearest, (stretch.carrier.at(near) - at).norm());
      }
      ASSERT_LT(nearest, 1e-10) << n;
    }
  }
}

TEST(StepCurves, SlopesOfConicsAreTheirDerivatives) {
  std::mt19937 random(8);
  for (int n = 0; n < 200; ++n) {
    const CurveCarrier conic = random_conic(random);
    for (const double t : {0.0, 0.2, 0.9, 1.0}) {
      const Vec2 difference = (conic.at(t + 1e-6) - conic.at(t - 1e-6)) / 2e-6;
      ASSERT_LT((conic.slope(t) - difference).norm(), 1e-5 * (1.0 + difference.norm())) << n;
    }
  }
}

TEST(StepCurves, PolesOfAQuinticsStretchGiveItsPoints) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> number(-3.0, 3.0);
  for (int n = 0; n < 200; ++n) {
    CurveStretch stretch;
    stretch.carrier.kind = CurveKind::quintic;
    for (double& value : stretch.carrier.numbers) value = number(random);
    stretch.begin = 0.3 * number(random);
    stretch.end = 0.3 * number(random);
    const std::array<Vec2, 6> poles = bezier_of(stretch);
    for (const double t : {0.0, 0.37, 1.0}) {
      std::array<Vec2, 6> rest = poles;
      for (std::size_t level = 5; level > 0; --level)
        for (std::size_t i = 0; i < level; ++i) rest[i] = (1.0 - t) * rest[i] + t * rest[i + 1];
      const Vec2 wanted = stretch.carrier.at(stretch.begin + t * (stretch.end - stretch.begin));
      ASSERT_LT((rest[0] - wanted).norm(), 1e-11) << n;
    }
  }
}

}  // namespace
}  // namespace lamella::test
