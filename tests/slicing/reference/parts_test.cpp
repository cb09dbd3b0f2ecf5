/// Ray planes, refinement, box tree, the paper's solvers and the zones about edges.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "slicing/reference/classic_solvers.h"
#include "slicing/reference/edge_zones.h"
#include "slicing/reference/patch_tree.h"
#include "slicing/reference/ray_planes.h"
#include "slicing/reference/sub_patch.h"
#include "tests/support/solids.h"

namespace lamella::reference {
namespace {

/// A quarter of the unit cylinder over z in [0, 1], rational quadratic by linear, normal outward.
BezierPatch quarter_cylinder() {
  const double w = std::sqrt(0.5);
  return {2,
          1,
          {0.0, 1.0},
          {0.0, 1.0},
          {{1, 0, 0, 1}, {1, 0, 1, 1}, {w, w, 0, w}, {w, w, w, w}, {0, 1, 0, 1}, {0, 1, 1, 1}}};
}

std::vector<SubPatch> refined(const BezierPatch& patch, double flatness) {
  RefineLimits limits;
  limits.flatness = flatness;
  return refine({patch}, limits, 0, 0).patches;
}

TEST(RayPlanes, HoldTheRayForAnyDirection) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<Vec3> directions{Vec3::UnitX(),    -Vec3::UnitX(),     Vec3::UnitY(),        Vec3::UnitZ(),
                               Vec3(1, 1, 0),    Vec3(1, 0, 1),      Vec3(1, 1, 1),        Vec3(-1, 1, -1),
                               Vec3(1e-9, 0, 1), Vec3(0, 1, 1e-300), Vec3(1, 1 - 1e-15, 0)};
  for (int k = 0; k < 200; ++k) directions.emplace_back(normal(random), normal(random), normal(random));
  for (const Vec3& direction : directions) {
    const RayPlanes planes = make_ray_planes({Vec3(1, 2, 3), direction.normalized()});
    EXPECT_NEAR(planes.n1.norm(), 1.0, 1e-15);
    EXPECT_NEAR(planes.n2.norm(), 1.0, 1e-15);
    EXPECT_NEAR(planes.n1.dot(planes.n2), 0.0, 1e-15);
    EXPECT_NEAR(planes.n1.dot(planes.direction), 0.0, 1e-15);
    EXPECT_NEAR((planes.n1.cross(planes.n2) + planes.direction).norm(), 0.0, 1e-14);
  }
}

TEST(RayPlanes, OfARowAreTheLatticePlanesExactly) {
  const RayPlanes planes = make_ray_planes({Vec3(0, 0.1, 0.7), Vec3::UnitX()});
  EXPECT_EQ(planes.n1, Vec3(0, -1, 0));
  EXPECT_EQ(planes.n2, Vec3(0, 0, 1));
}

TEST(Refine, StopsWhenFlatAndKeepsTheSurface) {
  const std::vector<SubPatch> patches = refined(quarter_cylinder(), 1e-3);
  EXPECT_GT(patches.size(), 4U);
  double covered = 0.0;
  for (std::size_t k = 0; k < patches.size(); ++k) {
    EXPECT_EQ(patches[k].id, k);
    EXPECT_LE(flatness(patches[k].patch), 1e-3);
    // Flat along z from the start: only u is split.
    EXPECT_EQ(patches[k].patch.v.length(), 1.0);
    covered += patches[k].patch.u.length();
    const Vec3 point = evaluate_point(patches[k].patch, patches[k].patch.u.middle(), 0.5);
    EXPECT_NEAR(point.head<2>().norm(), 1.0, 1e-14);
  }
  EXPECT_NEAR(covered, 1.0, 1e-15);
}

TEST(Refine, HalvesWhereTheSurfaceBends) {
  const std::size_t coarse = refined(quarter_cylinder(), 1e-2).size();
  const std::size_t fine = refined(quarter_cylinder(), 1e-4).size();
  // The deviation of an arc from its chord falls with the square of its length: 100 times flatter, 10 times as many.
  EXPECT_GE(fine, 6 * coarse);
  EXPECT_LE(fine, 16 * coarse);
}

TEST(Refine, SaysWhenALimitStoppedIt) {
  RefineLimits limits;
  limits.flatness = 1e-12;
  limits.max_patches = 10;
  const RefineResult result = refine({quarter_cylinder()}, limits, 0, 0);
  EXPECT_TRUE(result.capped);
  EXPECT_LE(result.patches.size(), 10U);
}

TEST(PatchTree, FindsTheSameBoxesAsTryingAll) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  const auto point = [&] { return Vec3(unit(random), unit(random), unit(random)); };
  std::vector<Box3> boxes;
  for (int k = 0; k < 500; ++k) {
    const Vec3 corner = point();
    boxes.emplace_back(corner, corner + 0.1 * point());
  }
  const PatchTree tree(boxes, 0.0);
  for (int k = 0; k < 500; ++k) {
    Ray ray{point(), (point() - Vec3::Constant(0.5)).normalized()};
    if (k % 3 == 0) ray.direction = Vec3::Unit(k / 3 % 3);
    std::vector<std::uint32_t> found;
    tree.find(ray, found);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t b = 0; b < boxes.size(); ++b) {
      if (line_meets_box(ray, boxes[b].min(), boxes[b].max())) expected.push_back(b);
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(PatchTree, CountsALineAlongTheSideOfABoxAsMeetingIt) {
  EXPECT_TRUE(line_meets_box({Vec3(-1, 0, 1), Vec3::UnitX()}, Vec3::Zero(), Vec3::Ones()));
  EXPECT_TRUE(line_meets_box({Vec3(-1, 0, 0), -Vec3::UnitX()}, Vec3::Zero(), Vec3::Ones()));
  EXPECT_FALSE(line_meets_box({Vec3(-1, -1e-12, 0), Vec3::UnitX()}, Vec3::Zero(), Vec3::Ones()));
}

using Classic = void (*)(const PlaneNets&, double, std::vector<PatchRoot>&, std::uint64_t&);

/// Hits on all sub-patches of the quarter cylinder of a ray along -x at (y, z).
std::vector<double> hit_heights(Classic solver, double tolerance, double flatness, double y, double z) {
  const RayPlanes planes = make_ray_planes({Vec3(3.0, y, z), -Vec3::UnitX()});
  std::vector<double> heights;
  for (const SubPatch& patch : refined(quarter_cylinder(), flatness)) {
    PlaneNets nets;
    project(patch, planes, nets);
    std::vector<PatchRoot> roots;
    std::uint64_t iterations = 0;
    solver(nets, tolerance, roots, iterations);
    for (const PatchRoot& root : roots) {
      const Interval& u = patch.patch.u;
      const Interval& v = patch.patch.v;
      heights.push_back(evaluate_point(patch.patch, u.lo + root.u * u.length(), v.lo + root.v * v.length()).y());
    }
  }
  return heights;
}

TEST(ClassicSolvers, FindASimpleHitWithinTheTolerance) {
  for (const Classic solver : {&solve_by_bisection, &solve_by_newton}) {
    for (const double tolerance : {1e-1, 1e-2, 1e-3}) {
      EXPECT_THAT(hit_heights(solver, tolerance, 1.0, 0.37, 0.41),
                  testing::ElementsAre(testing::DoubleNear(0.37, tolerance)))
          << tolerance;
    }
  }
}

TEST(ClassicSolvers, BisectionDoublesAHitNearABorderOfSubPatches) {
  const auto patches = refined(quarter_cylinder(), 1e-2);
  ASSERT_GT(patches.size(), 1U);
  const double border = evaluate_point(patches[0].patch, patches[0].patch.u.hi, 0.0).y();
  EXPECT_EQ(hit_heights(&solve_by_bisection, 1e-2, 1e-2, border, 0.5).size(), 2U);
}

TEST(ClassicSolvers, BisectionReportsAHitThatTheRayMissesByLessThanTheTolerance) {
  EXPECT_EQ(hit_heights(&solve_by_bisection, 1e-2, 1e-1, 0.5, 1.005).size(), 1U);
  EXPECT_TRUE(hit_heights(&solve_by_bisection, 1e-3, 1e-1, 0.5, 1.005).empty());
}

TEST(EdgeZones, AreAsSmallAsRoundingOnExactSolids) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const EdgeZones zones(scene, SolidId{0}, 1e-11);
  ASSERT_EQ(zones.zones().size(), 3U);  // two rims and the seam
  for (const EdgeZone& zone : zones.zones()) EXPECT_EQ(zone.radius, 1e-11);
}

TEST(EdgeZones, GrowWithTheGapThatIsThere) {
  Scene scene = test::scene_of(test::add_box, Vec3(0, 0, 0), Vec3(1, 1, 1));
  // Lift the plane of one face by 1e-3: its four edges' images leave the edges by as much.
  Face& face = scene.faces[FaceId{0}];
  Plane& plane = std::get<Plane>(face.surface);
  plane.frame.origin += 1e-3 * plane.frame.z;
  const EdgeZones zones(scene, SolidId{0}, 1e-11);
  int widened = 0;
  for (const EdgeZone& zone : zones.zones()) widened += zone.radius > 1e-3 && zone.radius < 2e-3 ? 1 : 0;
  EXPECT_EQ(widened, 4);
}

TEST(EdgeZones, FindTheEdgesThatARayPasses) {
  const Scene scene = test::scene_of(test::add_cylinder, 1.0, 2.0);
  const EdgeZones zones(scene, SolidId{0}, 1e-6);
  std::vector<std::uint32_t> items;
  const auto passes = [&](const Ray& ray) {
    std::vector<EdgePass> found;
    zones.find(ray, items, found);
    return !found.empty();
  };
  const Vec3 rim(std::cos(0.3), std::sin(0.3), 2.0);
  const Vec3 direction = Vec3(-1.0, 0.4, -0.7).normalized();
  const Vec3 across = direction.cross(Vec3(-std::sin(0.3), std::cos(0.3), 0.0)).normalized();
  EXPECT_TRUE(passes({rim - 5.0 * direction, direction}));
  EXPECT_TRUE(passes({rim - 5.0 * direction + 0.9e-6 * across, direction}));
  EXPECT_FALSE(passes({rim - 5.0 * direction + 1.1e-6 * across, direction}));
}

}  // namespace
}  // namespace lamella::reference
