#include "slicing/accuracy/mesh_caster.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

namespace lamella::accuracy {
namespace {

using ::testing::ElementsAre;

StlTriangle triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
  StlTriangle t{};
  int at = 0;
  for (const Vec3& p : {a, b, c}) {
    for (int axis = 0; axis < 3; ++axis) t[static_cast<std::size_t>(at++)] = static_cast<float>(p[axis]);
  }
  return t;
}

/// The box [lo, hi], two triangles a side, looking outward.
std::vector<StlTriangle> box(const Vec3& lo, const Vec3& hi) {
  const auto at = [&](int i) {
    return Vec3((i & 1) ? hi.x() : lo.x(), (i & 2) ? hi.y() : lo.y(), (i & 4) ? hi.z() : lo.z());
  };
  constexpr int kSides[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  std::vector<StlTriangle> mesh;
  for (const auto& side : kSides) {
    mesh.push_back(triangle(at(side[0]), at(side[1]), at(side[2])));
    mesh.push_back(triangle(at(side[0]), at(side[2]), at(side[3])));
  }
  return mesh;
}

/// A sphere about the origin: an octahedron whose sides were halved `times` times.
std::vector<StlTriangle> sphere(double radius, int times) {
  struct Piece {
    Vec3 a, b, c;
  };
  std::vector<Piece> pieces;
  for (int octant = 0; octant < 8; ++octant) {
    const Vec3 x = (octant & 1) ? Vec3::UnitX() : Vec3(-Vec3::UnitX());
    const Vec3 y = (octant & 2) ? Vec3::UnitY() : Vec3(-Vec3::UnitY());
    const Vec3 z = (octant & 4) ? Vec3::UnitZ() : Vec3(-Vec3::UnitZ());
    const bool is_right = x.cross(y).dot(z) > 0.0;
    pieces.push_back(is_right ? Piece{x, y, z} : Piece{y, x, z});
  }
  for (int k = 0; k < times; ++k) {
    std::vector<Piece> finer;
    for (const Piece& p : pieces) {
      const Vec3 ab = (p.a + p.b).normalized();
      const Vec3 bc = (p.b + p.c).normalized();
      const Vec3 ca = (p.c + p.a).normalized();
      for (const Piece& piece : {Piece{p.a, ab, ca}, Piece{ab, p.b, bc}, Piece{ca, bc, p.c}, Piece{ab, bc, ca}}) {
        finer.push_back(piece);
      }
    }
    pieces = finer;
  }
  std::vector<StlTriangle> mesh;
  for (const Piece& p : pieces) mesh.push_back(triangle(radius * p.a, radius * p.b, radius * p.c));
  return mesh;
}

RayLattice lattice(std::vector<double> y, std::vector<double> z) { return {std::move(y), std::move(z)}; }

std::vector<double> xs(const MeshCast& cast) {
  std::vector<double> values;
  for (const Crossing& crossing : cast.crossings) values.push_back(crossing.x);
  return values;
}

TEST(MeshCaster, ABoxIsEnteredAndLeftOnce) {
  const MeshCast cast = cast_at_mesh(box({1, 0, 0}, {4, 2, 2}), lattice({0.3}, {1.7}), {}, 1);
  EXPECT_THAT(xs(cast), ElementsAre(1.0, 4.0));
  EXPECT_EQ(cast.unclosed_rays, 0U);
}

TEST(MeshCaster, RaysInEdgesAndVerticesCloseByTheHalfOpenRule) {
  // On the lower sides, on vertices, along edges and diagonals: lower sides belong to the box, upper ones don't.
  const MeshCast cast = cast_at_mesh(box({1, 0, 0}, {4, 2, 2}), lattice({0, 1, 2}, {0, 1, 2}), {}, 1);
  EXPECT_EQ(cast.unclosed_rays, 0U);
  EXPECT_EQ(cast.crossings.size(), 8U);  // (0,0) (0,1) (1,0) (1,1)
  for (const Crossing& crossing : cast.crossings) {
    EXPECT_NE(crossing.ray % 3, 2U);
    EXPECT_NE(crossing.ray / 3, 2U);
  }
}

TEST(MeshCaster, BoxesThatTouchAreOneSpan) {
  std::vector<StlTriangle> mesh = box({0, 0, 0}, {1, 1, 1});
  for (const StlTriangle& t : box({1, 0, 0}, {3, 1, 1})) mesh.push_back(t);
  EXPECT_THAT(xs(cast_at_mesh(mesh, lattice({0.4}, {0.6}), {}, 1)), ElementsAre(0.0, 3.0));
}

TEST(MeshCaster, InsideOutIsTheSameBody) {
  std::vector<StlTriangle> mesh = box({1, 0, 0}, {4, 2, 2});
  for (StlTriangle& t : mesh) std::swap_ranges(t.begin(), t.begin() + 3, t.begin() + 3);
  EXPECT_THAT(xs(cast_at_mesh(mesh, lattice({0.3}, {1.7}), {}, 1)), ElementsAre(1.0, 4.0));
}

TEST(MeshCaster, AHoleIsCounted) {
  std::vector<StlTriangle> mesh = box({1, 0, 0}, {4, 2, 2});
  mesh.erase(mesh.begin() + 8, mesh.begin() + 10);  // the side x = 1
  const MeshCast cast = cast_at_mesh(mesh, lattice({0.3, 3.0}, {1.7}), {}, 1);
  EXPECT_EQ(cast.unclosed_rays, 1U);
  EXPECT_TRUE(cast.crossings.empty());
}

TEST(MeshCaster, ASphereClosesOnEveryRayAlsoThroughItsVertices) {
  const std::vector<StlTriangle> mesh = sphere(10.0, 4);
  std::vector<double> steps;
  for (int i = -40; i <= 40; ++i) steps.push_back(0.25 * i);  // through vertices of the octahedron and its edges
  for (const StlTriangle& t : mesh) steps.push_back(t[1]);    // and of the mesh, bit for bit
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  const RayLattice rays = lattice(steps, steps);
  const MeshCast cast = cast_at_mesh(mesh, rays, {}, 1);
  EXPECT_EQ(cast.unclosed_rays, 0U);
  ASSERT_GT(cast.crossings.size(), 70000U);
  for (const Crossing& crossing : cast.crossings) {
    const double r = Vec3(crossing.x, rays.ray_y(crossing.ray), rays.ray_z(crossing.ray)).norm();
    ASSERT_LE(r, 10.0 + 1e-5);
    ASSERT_GE(r, 10.0 * std::cos(0.12));  // no edge is longer than 0.2 rad: 90 degrees halved four times, stretched
  }
}

TEST(MeshCaster, ThreadsChangeNothing) {
  const std::vector<StlTriangle> mesh = sphere(10.0, 7);
  std::vector<double> steps;
  for (int i = 0; i < 50; ++i) steps.push_back(-9.7 + 0.4 * i);
  const RayLattice rays = lattice(steps, steps);
  EXPECT_EQ(cast_at_mesh(mesh, rays, {}, 1).crossings, cast_at_mesh(mesh, rays, {}, 2).crossings);
  EXPECT_EQ(mesh_section_areas(mesh, steps, {}, 1), mesh_section_areas(mesh, steps, {}, 2));
}

TEST(MeshSections, OfABoxAreItsArea) {
  const auto areas = mesh_section_areas(box({1, 0, 0}, {4, 2, 2}), {-1.0, 0.5, 1.9, 2.0}, {}, 1);
  ASSERT_EQ(areas.size(), 4U);
  EXPECT_EQ(areas[0], 0.0);
  EXPECT_NEAR(areas[1], 6.0, 1e-12);
  EXPECT_NEAR(areas[2], 6.0, 1e-12);
  EXPECT_EQ(areas[3], 0.0);  // half open
}

TEST(MeshSections, IntegrateToTheEnclosedVolume) {
  const std::vector<StlTriangle> mesh = sphere(10.0, 5);
  std::vector<double> heights;
  constexpr int kCount = 2000;
  for (int i = 0; i < kCount; ++i) heights.push_back(-10.0 + 20.0 * (i + 0.5) / kCount);
  double volume = 0.0;
  for (const double area : mesh_section_areas(mesh, heights, {}, 1)) volume += area * 20.0 / kCount;
  EXPECT_NEAR(volume / enclosed_volume(mesh), 1.0, 1e-5);
}

}  // namespace
}  // namespace lamella::accuracy
