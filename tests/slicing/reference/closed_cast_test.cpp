/// Closed spans against closed forms, on random rays and on lattices that run exactly through vertices, edges, seams,
/// poles, apexes and tangencies.

#include <algorithm>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "slicing/reference/reference_engine.h"
#include "tests/support/closed_forms.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using test::box_spans;
using test::cylinder_spans;
using test::ExactSpans;
using test::frustum_spans;
using test::Placement;
using test::ring_spans;
using test::SolidOptions;
using test::sphere_spans;

Ray random_ray(std::mt19937& random, double spread) {
  std::normal_distribution<double> normal;
  const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
  const Vec3 through(spread * normal(random), spread * normal(random), spread * normal(random));
  return {through - 7.0 * direction, direction};
}

void expect_spans(const std::vector<Span>& spans, const std::vector<Interval>& exact, double tolerance,
                  const Ray& ray) {
  const auto where = [&] {
    testing::Message message;
    message << "origin " << ray.origin.transpose() << " direction " << ray.direction.transpose();
    return message;
  };
  ASSERT_EQ(spans.size(), exact.size()) << where();
  for (std::size_t k = 0; k < spans.size(); ++k) {
    EXPECT_NEAR(spans[k].begin, exact[k].lo, tolerance) << where();
    EXPECT_NEAR(spans[k].end, exact[k].hi, tolerance) << where();
  }
}

/// Random rays through a solid and its closed form. The depth of a hit is as exact as 1e-12 / |n.d|: rays within 1e-7
/// of a tangency are left out.
void expect_closed_form(const Scene& scene, const ExactSpans& exact, int rays, double tolerance = 1e-8) {
  const ReferenceEngine engine(scene, {}, {}, 1);
  std::mt19937 random(3);
  SolidCast cast;
  CastCounters counters;
  int met = 0;
  for (int k = 0; k < rays; ++k) {
    const Ray ray = random_ray(random, 1.0);
    engine.cast(ray, Vec3::UnitZ(), SolidId{0}, cast, counters);
    expect_spans(cast.spans, exact(ray), tolerance, ray);
    met += cast.spans.empty() ? 0 : 1;
  }
  EXPECT_GT(met, rays / 10);
  EXPECT_EQ(counters.repaired_rays + counters.unclosed_rays + counters.uncertain_hits, 0U);
}

TEST(ClosedCast, AgreesWithTheBox) {
  expect_closed_form(
      test::scene_of(test::add_box, Vec3(-1, -1, -1), Vec3(1, 1.5, 1)),
      [](const Ray& ray) {
        return box_spans(ray, {-1, -1, -1}, {1, 1.5, 1});
      },
      5000);
}

TEST(ClosedCast, AgreesWithTheSphere) {
  expect_closed_form(
      test::scene_of(test::add_sphere, 1.3), [](const Ray& ray) { return sphere_spans(ray, 1.3); }, 5000);
}

TEST(ClosedCast, AgreesWithTheCylinder) {
  expect_closed_form(
      test::scene_of(test::add_cylinder, 1.1, 1.7), [](const Ray& ray) { return cylinder_spans(ray, 1.1, 1.7); }, 5000);
}

TEST(ClosedCast, AgreesWithTheTorus) {
  expect_closed_form(
      test::scene_of(test::add_torus, 1.2, 0.5), [](const Ray& ray) { return ring_spans(ray, 1.2, 0.5, 0.5); }, 300);
}

TEST(ClosedCast, AgreesWithTheConeOnShallowRays) {
  const Scene scene = test::scene_of(test::add_cone, 1.0, 2.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  SolidCast cast;
  CastCounters counters;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 direction = Vec3(unit(random), unit(random), 0.2 * unit(random)).normalized();
    if (direction.head<2>().norm() < 0.9) continue;
    const Ray ray{Vec3(unit(random), unit(random), 1.0 + unit(random)) - 5.0 * direction, direction};
    engine.cast(ray, Vec3::UnitZ(), SolidId{0}, cast, counters);
    expect_spans(cast.spans, frustum_spans(ray, 1.0, 0.0, 2.0), 1e-8, ray);
  }
  EXPECT_EQ(counters.repaired_rays + counters.unclosed_rays + counters.uncertain_hits, 0U);
}

TEST(ClosedCast, TakesAVoidOutOfItsBox) {
  const Scene scene = test::scene_of(test::add_box_with_void, Vec3(-1, -1, -1), Vec3(1, 1, 1), 0.5);
  expect_closed_form(
      scene,
      [](const Ray& ray) {
        std::vector<Interval> spans = box_spans(ray, {-1, -1, -1}, {1, 1, 1});
        const auto hole = sphere_spans(ray, 0.5);
        if (hole.empty()) return spans;
        return std::vector<Interval>{{spans[0].lo, hole[0].lo}, {hole[0].hi, spans[0].hi}};
      },
      4000);
}

TEST(ClosedCast, GivesTheSameInAnyPlacement) {
  const Placement placement = Placement::turned(Vec3(1, 2, 3).normalized(), 0.7, {100.0, -20.0, 3.0});
  const Placement mirror = Placement::mirrored(Vec3(2, -1, 1).normalized(), {3.0, 4.0, 5.0});
  std::mt19937 random(9);
  for (const Placement& place : {placement, mirror}) {
    Scene scene;
    SolidOptions options;
    options.placement = place;
    test::add_sphere(scene, 1.3, options);
    const ReferenceEngine engine(scene, {}, {}, 1);
    SolidCast cast;
    CastCounters counters;
    for (int k = 0; k < 500; ++k) {
      const Ray ray = random_ray(random, 0.8);
      engine.cast({place.apply(ray.origin), place.linear * ray.direction}, Vec3::UnitX(), SolidId{0}, cast, counters);
      expect_spans(cast.spans, sphere_spans(ray, 1.3), 1e-8, ray);
    }
  }
}

/// Rows along +x at exact multiples of 1/n over [-1.5, 1.5]^2, so that many run along faces, edges and through
/// vertices.
void for_each_row(int n, const std::function<void(const Ray&)>& body) {
  for (int j = -3 * n / 2; j <= 3 * n / 2; ++j) {
    for (int k = -3 * n / 2; k <= 3 * n / 2; ++k) {
      body({{-4.0, static_cast<double>(j) / n, static_cast<double>(k) / n}, Vec3::UnitX()});
    }
  }
}

TEST(ClosedCast, DecidesALatticeAlongTheFacesOfABoxByTheHalfOpenRule) {
  const Scene scene = test::scene_of(test::add_box, Vec3(-1, -1, -1), Vec3(1, 1, 1));
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  for_each_row(4, [&](const Ray& ray) {
    engine.cast(ray, Vec3::UnitZ(), SolidId{0}, cast, counters);
    // The lower faces belong to the solid, the upper ones don't: y + 0, z + 0.
    expect_spans(cast.spans, box_spans(ray, {-1, -1, -1}, {1, 1, 1}), 1e-12, ray);
  });
  EXPECT_GT(counters.tie_rays, 0U);
  EXPECT_EQ(counters.tolerance_rays + counters.repaired_rays + counters.unclosed_rays + counters.uncertain_hits, 0U);
}

TEST(ClosedCast, TakesThePlanesOfABoxOnceInEveryDirectionOfTheAxes) {
  const Scene scene = test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(1, 1, 1));
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3 direction = sign * Vec3::Unit(axis);
      const Vec3 up = Vec3::Unit((axis + 2) % 3);
      const Vec3 side = up.cross(direction);
      // Four boxes around a corner of the lattice: exactly one of the four corner rays of a unit face lies inside.
      int inside = 0;
      for (const double a : {0.0, 1.0}) {
        for (const double b : {0.0, 1.0}) {
          const Vec3 origin = a * up + b * side.cwiseAbs();
          engine.cast({origin, direction}, up, SolidId{0}, cast, counters);
          inside += static_cast<int>(cast.spans.size());
        }
      }
      EXPECT_EQ(inside, 1) << direction.transpose();
    }
  }
}

TEST(ClosedCast, CastsThroughTheDiagonalOfACube) {
  const Scene scene = test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(1, 1, 1));
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  engine.cast({{-1, -1, -1}, Vec3(1, 1, 1).normalized()}, Vec3::UnitZ(), SolidId{0}, cast, counters);
  ASSERT_EQ(cast.spans.size(), 1U);
  EXPECT_NEAR(cast.spans[0].begin, std::sqrt(3.0), 1e-7);
  EXPECT_NEAR(cast.spans[0].end, 2.0 * std::sqrt(3.0), 1e-7);
  engine.cast({{-1, -1, 0.5}, Vec3(1, 1, 0).normalized()}, Vec3::UnitZ(), SolidId{0}, cast, counters);
  ASSERT_EQ(cast.spans.size(), 1U);
  EXPECT_NEAR(cast.spans[0].begin, std::sqrt(2.0), 1e-7);
  EXPECT_NEAR(cast.spans[0].end, 2.0 * std::sqrt(2.0), 1e-7);
}

/// Round solids on a lattice through their seams, poles and tangencies: spans within what the tie step of 1e-8 of the
/// size can make of a tangency (a chord of sqrt(8 r step)), and nothing open.
void expect_lattice(const Scene& scene, const ExactSpans& exact, int n) {
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  for_each_row(n, [&](const Ray& ray) {
    engine.cast(ray, Vec3::UnitZ(), SolidId{0}, cast, counters);
    double length = 0.0;
    for (const Span& span : cast.spans) length += span.end - span.begin;
    double expected = 0.0;
    for (const Interval& span : exact(ray)) expected += span.length();
    EXPECT_NEAR(length, expected, 2e-7) << ray.origin.transpose();
  });
  EXPECT_EQ(counters.tolerance_rays + counters.repaired_rays + counters.unclosed_rays + counters.uncertain_hits, 0U);
}

TEST(ClosedCast, DecidesALatticeThroughThePolesAndTangenciesOfASphere) {
  expect_lattice(
      test::scene_of(test::add_sphere, 1.0), [](const Ray& ray) { return sphere_spans(ray, 1.0); }, 8);
}

TEST(ClosedCast, DecidesALatticeAlongTheRimsOfACylinder) {
  expect_lattice(
      test::scene_of(test::add_cylinder, 1.0, 1.25), [](const Ray& ray) { return cylinder_spans(ray, 1.0, 1.25); }, 8);
}

TEST(ClosedCast, DecidesALatticeThroughTheApexOfACone) {
  expect_lattice(
      test::scene_of(test::add_cone, 1.0, 1.25), [](const Ray& ray) { return frustum_spans(ray, 1.0, 0.0, 1.25); }, 8);
}

TEST(ClosedCast, DecidesALatticeThroughTheSeamsOfATorus) {
  // z = +-1/2 is tangent to the whole top and bottom circle; y = 1/2 and 3/2 touch the inner and outer equator.
  expect_lattice(
      test::scene_of(test::add_torus, 1.0, 0.5),
      [](const Ray& ray) {
        if (std::abs(ray.origin.z()) >= 0.5 || std::abs(ray.origin.y()) >= 1.5) return std::vector<Interval>{};
        const double z2 = ray.origin.z() * ray.origin.z();
        const double outer = 1.0 + std::sqrt(0.25 - z2);
        const double inner = 1.0 - std::sqrt(0.25 - z2);
        const double y2 = ray.origin.y() * ray.origin.y();
        const double a = std::sqrt(std::max(0.0, outer * outer - y2));
        const double b = std::sqrt(std::max(0.0, inner * inner - y2));
        return std::vector<Interval>{{-a, -b}, {b, a}};
      },
      8);
}

TEST(ClosedCast, RunsAlongRulingsAndSeamsOfACylinder) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  const auto casts = [&](double x, double y) {
    engine.cast({{x, y, -5.0}, Vec3::UnitZ()}, Vec3::UnitY(), SolidId{0}, cast, counters);
    return cast.spans.size();
  };
  EXPECT_EQ(casts(0.0, 0.0), 1U);
  EXPECT_EQ(casts(1.0 - 1e-6, 0.0), 1U);
  EXPECT_EQ(casts(0.0, -1.0), 1U);  // the side of `up`: inside
  EXPECT_EQ(casts(0.0, 1.0), 0U);
  EXPECT_EQ(counters.repaired_rays + counters.unclosed_rays, 0U);
}

TEST(ClosedCast, SharedFacesOfTouchingBoxesBelongToOneOfThem) {
  const Scene scene = test::touching_boxes();
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  // Rows along y in the common plane x = 1: `up` x direction = z x y = -x, so the left box has it.
  std::array<std::size_t, 2> spans{};
  for (const std::size_t solid : {0U, 1U}) {
    engine.cast({{1.0, -3.0, 0.5}, Vec3::UnitY()}, Vec3::UnitZ(), SolidId{solid}, cast, counters);
    spans[solid] = cast.spans.size();
  }
  EXPECT_EQ(spans[0], 1U);
  EXPECT_EQ(spans[1], 0U);
}

TEST(ClosedCast, CountsFoldPairsOfARoundSide) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  for (const double distance : {1e-9, 1e-7, 1e-5, 1e-3}) {
    engine.cast({{-3.0, 1.0 - distance, 1.0}, Vec3::UnitX()}, Vec3::UnitZ(), SolidId{0}, cast, counters);
    ASSERT_EQ(cast.spans.size(), 1U) << distance;
    EXPECT_NEAR(cast.spans[0].end - cast.spans[0].begin, 2.0 * std::sqrt(distance * (2.0 - distance)),
                1e-11 / std::sqrt(distance));
    engine.cast({{-3.0, 1.0 + distance, 1.0}, Vec3::UnitX()}, Vec3::UnitZ(), SolidId{0}, cast, counters);
    EXPECT_TRUE(cast.spans.empty()) << distance;
  }
}

TEST(ClosedCast, HitsCarrySenseFaceAndParameters) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  std::vector<Hit> hits;
  CastCounters counters;
  engine.find_hits({{-3.0, 0.6, 0.5}, Vec3::UnitX()}, SolidId{0}, hits, counters);
  ASSERT_EQ(hits.size(), 2U);
  EXPECT_EQ(hits[0].sense, Sense::entry);
  EXPECT_EQ(hits[1].sense, Sense::exit);
  EXPECT_NEAR(hits[0].t, 3.0 - 0.8, 1e-13);
  EXPECT_NEAR(hits[1].uv.x(), std::atan2(0.6, 0.8), 1e-13);
  EXPECT_NEAR(hits[1].uv.y(), 0.5, 1e-13);
  EXPECT_EQ(hits[0].flags | hits[1].flags, 0);
}

TEST(ClosedCast, FlagsRawHitsOnEdgesAndTangencies) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  std::vector<Hit> hits;
  CastCounters counters;
  engine.find_hits({{-3.0, 1.0, 0.5}, Vec3::UnitX()}, SolidId{0}, hits, counters);
  ASSERT_EQ(hits.size(), 1U);
  EXPECT_EQ(hits[0].sense, Sense::edge);
  EXPECT_NE(hits[0].flags & kTangent, 0);
}

TEST(ClosedCast, RefusesARayWithoutADirection) {
  const Scene scene = test::scene_of(test::add_sphere, 1.0);
  const ReferenceEngine engine(scene, {}, {}, 1);
  SolidCast cast;
  CastCounters counters;
  EXPECT_THROW(engine.cast({Vec3::Zero(), Vec3::Zero()}, Vec3::UnitZ(), SolidId{0}, cast, counters), GeometryError);
  EXPECT_THROW(engine.cast({Vec3::Constant(NAN), Vec3::UnitX()}, Vec3::UnitZ(), SolidId{0}, cast, counters),
               GeometryError);
}

TEST(ClosedCast, RefusesAToleranceThatIsNotPositive) {
  const Scene scene = test::scene_of(test::add_sphere, 1.0);
  ReferenceOptions options;
  options.tolerance = 0.0;
  EXPECT_THROW(ReferenceEngine(scene, options, {}, 1), UsageError);
  options = {};
  options.subdivision = NAN;
  EXPECT_THROW(ReferenceEngine(scene, options, {}, 1), UsageError);
}

}  // namespace
}  // namespace lamella
