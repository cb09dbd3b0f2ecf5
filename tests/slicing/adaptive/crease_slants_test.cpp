#include "slicing/adaptive/crease_slants.h"

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "model/measure.h"
#include "slicing/adaptive/adaptive_plan.h"
#include "tests/slicing/adaptive/plan_of_scene.h"
#include "tests/support/patch_solids.h"

namespace lamella::test {
namespace {

using ::testing::Contains;
using ::testing::DoubleNear;
using ::testing::Not;

/// A bilinear spline through heights over whole x and y: heights[x][y].
BSplineSurface folded(const std::vector<std::vector<double>>& heights) {
  BSplineSurface out;
  out.count_u = static_cast<int>(heights.size());
  out.count_v = static_cast<int>(heights[0].size());
  const auto knots = [](int count) {
    std::vector<double> flat{0.0};
    for (int i = 0; i < count; ++i) flat.push_back(i);
    flat.push_back(count - 1);
    return flat;
  };
  out.knots_u = knots(out.count_u);
  out.knots_v = knots(out.count_v);
  for (int i = 0; i < out.count_u; ++i) {
    for (int j = 0; j < out.count_v; ++j) out.poles.emplace_back(i, j, heights[i][j]);
  }
  return out;
}

/// What is below the surface down to 20 mm lower.
Scene below(const BSplineSurface& top) {
  Scene scene;
  add_swept_patch(scene, top, Vec3(0.0, 0.0, -20.0));
  return scene;
}

/// Of the face on top, with nothing known of its slants; tips of wedges may recede by 1 mm.
CreaseSlants creases_of(const Scene& scene) {
  SlantProfile nothing(-100.0, 1.0, 200);
  nothing.finish();
  return crease_slants(FaceSlants(scene, FaceId{0}), nothing, {1.0, 100.0});
}

double largest(const CreaseSlants& creases, double z) {
  double most = -1.0;
  for (const Slant& part : creases.parts) {
    if (part.z.lo <= z && z <= part.z.hi) most = std::max(most, part.slant);
  }
  return most;
}

TEST(CreaseSlants, OfALevelValleyIsThatOfALevelFace) {
  const CreaseSlants creases = creases_of(below(folded({{4, 4, 4}, {1, 1, 1}, {4, 4, 4}})));
  EXPECT_NEAR(largest(creases, 1.0), 1.0, 1e-9);
  EXPECT_THAT(creases.extrema, Contains(DoubleNear(1.0, 1e-9)));
}

TEST(CreaseSlants, OfASlopingRidgeIsThatOfItsLine) {
  // A ridge along y that climbs by 1 in 1: its line is at 45 degrees, and so is the flattest normal around it.
  const CreaseSlants creases = creases_of(below(folded({{0, 1}, {5, 6}, {0, 1}})));
  EXPECT_NEAR(largest(creases, 5.5), std::sqrt(0.5), 1e-6);
  EXPECT_THAT(creases.extrema, ::testing::IsEmpty());
}

TEST(CreaseSlants, CrossingsCountAsVertices) {
  // A pyramid of four twisted patches: no crease is level, the peak is.
  const CreaseSlants creases = creases_of(below(folded({{0, 1, 0}, {1, 6, 1}, {0, 1, 0}})));
  EXPECT_NEAR(largest(creases, 6.0), 1.0, 1e-9);
  EXPECT_THAT(creases.extrema, Contains(DoubleNear(6.0, 1e-9)));
  EXPECT_LT(largest(creases, 4.0), 0.99);
}

TEST(CreaseSlants, AreNoneWhereKnotsAreSmooth) {
  EXPECT_TRUE(creases_of(below(folded({{0, 0}, {2, 2}, {4, 4}}))).parts.empty());
  const auto wave = [](double x, double y) { return Vec3(x, y, x * x - y); };
  EXPECT_TRUE(creases_of(below(polynomial_patch(wave, 2, {-1.0, 1.0}, {0.0, 1.0}))).parts.empty());
}

// A face that ends at a crease of its surface has one normal there, not also that of what lies beyond; nor is there
// none where an edge's parameters are rounded to a place just off the surface.
TEST(FaceSlants, HaveTheFacesOwnNormalsAtItsBorder) {
  Scene scene = below(folded({{0, 0}, {3, 3}, {0, 0}}));
  scene.faces[FaceId{0}].uv_bounds = Box2(Vec2(0.0, 0.0), Vec2(1.0, 1.0));
  const FaceSlants face(scene, FaceId{0});
  const Vec3 normal = Vec3(-3.0, 0.0, 1.0).normalized();
  const NormalCone at_crease = face.normals(Box2(Vec2(1.0, 0.0), Vec2(1.0, 1.0)));
  EXPECT_LT(at_crease.half_angle, 1e-3);
  EXPECT_NEAR(at_crease.axis.dot(normal), 1.0, 1e-6);
  const NormalCone beyond = face.normals(Box2(Vec2(0.2, -1e-16), Vec2(0.8, -1e-17)));
  EXPECT_LT(beyond.half_angle, 1e-3);
  EXPECT_NEAR(beyond.axis.dot(normal), 1.0, 1e-6);
}

TEST(CreaseSlants, LayersEndAtAValleyInsideAFace) {
  // Flat are the upper rims at 4, the valley at 1.3 and the lower face's keel at -18.7.
  const AdaptivePlan plan = plan_of_scene(below(folded({{4, 4, 4}, {1.3, 1.3, 1.3}, {4, 4, 4}})), 0.4, 0.2, 0.7, 0.1);
  EXPECT_LE(plan.largest_deviation, 0.4 + 1e-9);
  std::vector<double> heights;
  for (const MetFeature& met : plan.features) heights.push_back(met.feature.z);
  EXPECT_THAT(heights, Contains(DoubleNear(1.3, 1e-6)));
  EXPECT_EQ(plan.missed, 0U);
  // No layer has the valley's line in its inside but for half a step.
  for (const LayerSpan& layer : plan.layers) {
    EXPECT_FALSE(layer.z_bottom < 1.3 - 0.051 && layer.z_top > 1.3 + 0.051) << layer.z_bottom;
  }
}

// A ridge that climbs to the face's border: all around its end at (1, 0, 6), that isn't the solid's highest point, the
// surface falls. Neither the ridge nor the border is level there, and each patch with the side has no vertical between.
TEST(CreaseSlants, LayersEndWhereACreaseEndsInAPeakAtTheBorder) {
  const auto peaks = folded({{0, 0, 0}, {6, 3, 1}, {0, 0, 0}, {1, 9, 1}, {0, 0, 0}});
  const AdaptivePlan plan = plan_of_scene(below(peaks), 0.4, 0.2, 0.7, 0.1);
  std::vector<double> heights;
  for (const MetFeature& met : plan.features) heights.push_back(met.feature.z);
  EXPECT_THAT(heights, Contains(DoubleNear(6.0, 1e-6)));
  // Below, the same ridge is a notch that runs out at the border: nothing begins or ends there.
  EXPECT_THAT(heights, Not(Contains(DoubleNear(-14.0, 1e-6))));
}

// The same where the border rises on: the crease's end is no extremum.
TEST(CreaseSlants, ACreaseThatEndsInASlopeIsNoFeature) {
  const auto slope = folded({{0, 0, 0}, {6, 3, 1}, {8, 4, 2}, {1, 9, 1}, {0, 0, 0}});
  const AdaptivePlan plan = plan_of_scene(below(slope), 0.4, 0.2, 0.7, 0.1);
  std::vector<double> heights;
  for (const MetFeature& met : plan.features) heights.push_back(met.feature.z);
  EXPECT_THAT(heights, Not(Contains(DoubleNear(6.0, 1e-6))));
}

}  // namespace
}  // namespace lamella::test
