#include "slicing/adaptive/thin_places.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "slicing/adaptive/adaptive_plan.h"
#include "tests/slicing/adaptive/plan_of_scene.h"
#include "tests/support/patch_solids.h"
#include "tests/support/solid_builder.h"
#include "tests/support/solids.h"

namespace lamella::test {
namespace {

using Polygon = std::vector<Vec2>;  ///< (x, z) in mm, counterclockwise seen with z up and x to the right

constexpr double kDepth = 5.0;  // mm along y

/// A prism along y.
void add_prism(Scene& scene, const Polygon& profile) {
  SolidPlan plan;
  const std::size_t count = profile.size();
  for (const double y : {0.0, kDepth}) {
    for (const Vec2& p : profile) plan.vertices.emplace_back(p.x(), y, p.y());
  }
  std::vector<FacePlan> faces;
  std::vector<std::pair<std::size_t, bool>> front;
  std::vector<std::pair<std::size_t, bool>> back;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    front.push_back(plan.line(i, next));
    back.push_back(plan.line(count + (count - i) % count, count + count - 1 - i));
    const Vec3 along = (plan.vertices[next] - plan.vertices[i]).normalized();
    // Outward is to the right of the way round.
    const Vec3 out(along.z(), 0.0, -along.x());
    const Frame frame{plan.vertices[i], along, out.cross(along), out};
    faces.push_back(planar_face(plan, frame,
                                {{plan.line(next, i), plan.line(i, count + i), plan.line(count + i, count + next),
                                  plan.line(count + next, next)}}));
  }
  faces.push_back(planar_face(plan, {plan.vertices[0], Vec3::UnitX(), Vec3::UnitZ(), -Vec3::UnitY()}, {front}));
  faces.push_back(planar_face(plan, {plan.vertices[count], -Vec3::UnitX(), Vec3::UnitZ(), Vec3::UnitY()}, {back}));
  plan.shells.push_back(faces);
  enter(scene, plan, {});
}

/// What lies inside of the polygon along x at a height: ascending, in pairs.
std::vector<double> section(const Polygon& profile, double z) {
  std::vector<double> xs;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const Vec2& a = profile[i];
    const Vec2& b = profile[(i + 1) % profile.size()];
    if ((a.y() <= z) == (b.y() <= z)) continue;
    xs.push_back(a.x() + (z - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
  }
  std::sort(xs.begin(), xs.end());
  return xs;
}

bool holds(const std::vector<double>& xs, double x) {
  return (std::upper_bound(xs.begin(), xs.end(), x) - xs.begin()) % 2 == 1;
}

/// A part of the surface of the extruded sections, in the plane: a wall or a step.
struct Piece {
  Vec2 lo;
  Vec2 hi;
};

std::vector<Piece> built_pieces(const Polygon& profile, const std::vector<LayerSpan>& layers) {
  std::vector<Piece> out;
  std::vector<double> below;
  for (std::size_t k = 0; k <= layers.size(); ++k) {
    const bool is_layer = k < layers.size();
    const std::vector<double> own = is_layer ? section(profile, layers[k].z_sample) : std::vector<double>{};
    for (const double x : own) out.push_back({{x, layers[k].z_bottom}, {x, layers[k].z_top}});
    std::vector<double> all = below;
    all.insert(all.end(), own.begin(), own.end());
    std::sort(all.begin(), all.end());
    const double border = is_layer ? layers[k].z_bottom : layers.back().z_top;
    for (std::size_t i = 0; i + 1 < all.size(); ++i) {
      const double middle = 0.5 * (all[i] + all[i + 1]);
      if (holds(below, middle) != holds(own, middle)) out.push_back({{all[i], border}, {all[i + 1], border}});
    }
    below = own;
  }
  return out;
}

/// The largest distance from the prism's surface to that of the built one, at many places of its profile.
double surface_deviation(const Polygon& profile, const std::vector<LayerSpan>& layers) {
  const std::vector<Piece> pieces = built_pieces(profile, layers);
  double most = 0.0;
  for (std::size_t i = 0; i < profile.size(); ++i) {
    constexpr int kPlaces = 1000;
    for (int k = 0; k <= kPlaces; ++k) {
      const double share = static_cast<double>(k) / kPlaces;
      const Vec2 p = (1.0 - share) * profile[i] + share * profile[(i + 1) % profile.size()];
      double nearest = std::numeric_limits<double>::infinity();
      for (const Piece& piece : pieces)
        nearest = std::min(nearest, (p - p.cwiseMax(piece.lo).cwiseMin(piece.hi)).norm());
      most = std::max(most, nearest);
    }
  }
  return most;
}

AdaptivePlan plan_of(const Polygon& profile, double deviation, double least, double most, double step) {
  Scene scene;
  add_prism(scene, profile);
  return plan_of_scene(scene, deviation, least, most, step);
}

Polygon moved(Polygon polygon, double angle, const Vec2& by) {
  for (Vec2& p : polygon) {
    p = Vec2(std::cos(angle) * p.x() - std::sin(angle) * p.y(), std::sin(angle) * p.x() + std::cos(angle) * p.y()) + by;
  }
  return polygon;
}

Polygon rectangle(double x0, double z0, double x1, double z1) { return {{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}}; }

constexpr double kDegree = kPi / 180.0;

double thickest(const AdaptivePlan& plan) {
  double most = 0.0;
  for (const LayerSpan& layer : plan.layers) most = std::max(most, layer.z_top - layer.z_bottom);
  return most;
}

// 0.1 mm thick at 30 degrees from level: 0.115 mm upright. Layers of 0.1 / cos(30) = 0.23 mm have the sine within 0.1
// mm, but what they build doesn't hang together, and ends of it recede by the tangent, 1.73.
TEST(ThinPlaces, ASlantedSheetIsKept) {
  const Polygon sheet = moved(rectangle(0.0, 0.0, 12.0, 0.1), 30.0 * kDegree, {0.0, 0.0});
  const AdaptivePlan plan = plan_of(sheet, 0.1, 0.05, 0.4, 0.01);
  EXPECT_LE(plan.largest_deviation, 0.1 + 1e-9);
  EXPECT_LE(surface_deviation(sheet, plan.layers), 0.1 + 1e-9);
  EXPECT_THAT(plan.thin, ::testing::IsEmpty());
  // What the sine alone lets through deviates by far more: that's what this is about.
  std::vector<LayerSpan> by_sine;
  for (double z = 0.0; z < 6.2; z += 0.23) by_sine.push_back({z, z + 0.115, z + 0.23});
  EXPECT_GT(surface_deviation(sheet, by_sine), 0.13);
}

TEST(ThinPlaces, ASlantedSlotIsKept) {
  // A block with a slot of 0.08 mm, open to the right, that climbs at 25 degrees.
  const double slope = std::tan(25.0 * kDegree);
  const double high = 0.08 / std::cos(25.0 * kDegree);
  const Polygon block{
      {0.0, 0.0},         {10.0, 0.0}, {10.0, 4.0}, {3.0, 4.0 - 7.0 * slope}, {3.0, 4.0 - 7.0 * slope + high},
      {10.0, 4.0 + high}, {10.0, 6.0}, {0.0, 6.0}};
  const AdaptivePlan plan = plan_of(block, 0.08, 0.05, 0.4, 0.01);
  EXPECT_LE(plan.largest_deviation, 0.08 + 1e-9);
  EXPECT_LE(surface_deviation(block, plan.layers), 0.08 + 1e-9);
  EXPECT_THAT(plan.thin, ::testing::IsEmpty());
}

TEST(ThinPlaces, AThickSlantedPlateCountsByTheSine) {
  const Polygon plate = moved(rectangle(0.0, 0.0, 12.0, 2.0), 30.0 * kDegree, {0.0, 0.0});
  const AdaptivePlan plan = plan_of(plate, 0.1, 0.05, 0.4, 0.01);
  EXPECT_LE(surface_deviation(plate, plan.layers), 0.1 + 1e-9);
  EXPECT_NEAR(thickest(plan), 0.23, 1e-9);
}

TEST(ThinPlaces, ASheetTooFlatForTheThinnestLayerIsReported) {
  // 0.03 mm thick at 10 degrees: it recedes by 5.7 mm per mm, and layers of 0.1 mm lose up to 0.28 mm of it.
  const Polygon sheet = moved(rectangle(0.0, 0.0, 8.0, 0.03), 10.0 * kDegree, {0.0, 0.0});
  const AdaptivePlan plan = plan_of(sheet, 0.1, 0.1, 0.4, 0.01);
  const double deviation = surface_deviation(sheet, plan.layers);
  EXPECT_GT(deviation, 0.1);
  ASSERT_GE(plan.thin.size(), 2U);
  double stated = 0.0;
  for (const ThinLoss& loss : plan.thin) stated = std::max(stated, loss.deviation);
  EXPECT_GE(stated, deviation - 1e-9);
  EXPECT_LE(stated, 0.5 * 0.1 / std::tan(10.0 * kDegree) + 1e-6);
}

TEST(ThinPlaces, ALevelFlangeBetweenTwoMiddlesIsReported) {
  // A post with a flange of 0.02 mm in the middle of its height: both of its faces belong to one border.
  const auto post = [](double thickness) {
    const double top = 1.0 + thickness;
    return Polygon{{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {5.0, 1.0}, {5.0, top}, {2.0, top}, {2.0, 3.0}, {0.0, 3.0}};
  };
  const AdaptivePlan lost = plan_of(post(0.02), 0.1, 0.1, 0.4, 0.05);
  EXPECT_GT(surface_deviation(post(0.02), lost.layers), 2.0);
  ASSERT_EQ(lost.thin.size(), 2U);
  EXPECT_EQ(lost.thin[0].deviation, std::numeric_limits<double>::infinity());
  EXPECT_GT(lost.thin[0].place.at.x(), 2.0);
  const AdaptivePlan kept = plan_of(post(0.1), 0.1, 0.1, 0.4, 0.05);
  EXPECT_LE(surface_deviation(post(0.1), kept.layers), 0.1 + 1e-9);
  EXPECT_THAT(kept.thin, ::testing::IsEmpty());
}

// Random prisms with thin sheets, slots and wedges: what is kept or reported.
class ThinPrisms : public ::testing::TestWithParam<int> {};

TEST_P(ThinPrisms, DeviateByNoMoreThanIsAllowedOrSaid) {
  std::mt19937 generator(static_cast<unsigned>(GetParam()));
  const auto random = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(generator); };
  // A star about the origin with arms of all widths and directions.
  Polygon star;
  const int arms = 5;
  for (int k = 0; k < arms; ++k) {
    const double angle = kTwoPi * (k + random(0.1, 0.6)) / arms;
    const double width = random(0.01, 0.3);
    const double length = random(2.0, 5.0);
    const Vec2 along(std::cos(angle), std::sin(angle));
    const Vec2 left(-along.y(), along.x());
    const double taper = random(0.2, 1.0);
    for (const Vec2& p : {Vec2(1.0, -0.5 * width), Vec2(length, -0.5 * width * taper),
                          Vec2(length, 0.5 * width * taper), Vec2(1.0, 0.5 * width)}) {
      star.push_back(p.x() * along + p.y() * left);
    }
  }
  const AdaptivePlan plan = plan_of(star, 0.08, 0.05, 0.4, 0.01);
  const double deviation = surface_deviation(star, plan.layers);
  double allowed = 0.08;
  for (const ThinLoss& loss : plan.thin) allowed = std::max(allowed, loss.deviation);
  // Ends of layers meet flat places to half a quantum, which adds to it.
  EXPECT_LE(deviation, allowed + 0.5 * plan.quantum + 1e-9);
  RecordProperty("deviation", std::to_string(deviation));
  RecordProperty("faces", std::to_string(plan.thin.size()));
}

INSTANTIATE_TEST_SUITE_P(Seeds, ThinPrisms, ::testing::Range(0, 40));

}  // namespace
}  // namespace lamella::test
