#include "model/nearest_point.h"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "model/evaluate.h"
#include "model/trim.h"
#include "tests/support/solids.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

using test::Placement;
using test::SolidOptions;

Vec3 random_point(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> coordinate(-reach, reach);
  return {coordinate(random), coordinate(random), coordinate(random)};
}

double box_distance(const Vec3& p, const Vec3& lo, const Vec3& hi) {
  const Vec3 outside = (lo - p).cwiseMax(p - hi).cwiseMax(0.0);
  if (outside.squaredNorm() > 0.0) return outside.norm();
  return std::min((p - lo).minCoeff(), (hi - p).minCoeff());
}

double cylinder_distance(const Vec3& p, double radius, double height) {
  const double across = p.head<2>().norm() - radius;
  const double along = std::max(-p.z(), p.z() - height);
  if (across > 0.0 && along > 0.0) return std::hypot(across, along);
  return std::max(across, along) > 0.0 ? std::max(across, along) : -std::max(across, along);
}

/// Distance from the segment between two points of the plane.
double segment_distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm();
}

/// In the half plane through the axis the cone is a triangle: its base and its slope.
double cone_distance(const Vec3& p, double radius, double height) {
  const Vec2 q(p.head<2>().norm(), p.z());
  return std::min(segment_distance(q, {0.0, 0.0}, {radius, 0.0}), segment_distance(q, {radius, 0.0}, {0.0, height}));
}

struct ClosedForm {
  const char* name;
  std::function<void(Scene&, const SolidOptions&)> add;
  std::function<double(const Vec3&)> distance;
};

class ClosedForms : public ::testing::TestWithParam<ClosedForm> {};

TEST_P(ClosedForms, AgreeWhereverTheSolidLies) {
  std::mt19937 random(7);
  for (const double angle : {0.0, 0.7, 2.0}) {
    const Placement placement = Placement::turned(Vec3(1.0, 2.0, -0.5).normalized(), angle, {3.0 * angle, -1.0, 2.0});
    Scene scene;
    SolidOptions options;
    options.placement = placement;
    GetParam().add(scene, options);
    const NearestPoint query(scene, faces_of(scene, SolidId{0}));
    for (int i = 0; i < 2000; ++i) {
      const Vec3 local = random_point(random, 6.0);
      const auto near = query.find(placement.apply(local));
      ASSERT_TRUE(near);
      EXPECT_NEAR(near->distance, GetParam().distance(local), 1e-12) << local.transpose();
      EXPECT_NEAR((near->point - placement.apply(local)).norm(), near->distance, 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Solids, ClosedForms,
    ::testing::Values(
        ClosedForm{"Box",
                   [](Scene& s, const SolidOptions& o) {
                     test::add_box(s, {-1, -2, -3}, {1, 2, 3}, o);
                   },
                   [](const Vec3& p) {
                     return box_distance(p, {-1, -2, -3}, {1, 2, 3});
                   }},
        ClosedForm{"Sphere", [](Scene& s, const SolidOptions& o) { test::add_sphere(s, 2.0, o); },
                   [](const Vec3& p) { return std::abs(p.norm() - 2.0); }},
        ClosedForm{"Cylinder", [](Scene& s, const SolidOptions& o) { test::add_cylinder(s, 2.0, 3.0, o); },
                   [](const Vec3& p) { return cylinder_distance(p, 2.0, 3.0); }},
        ClosedForm{"Cone", [](Scene& s, const SolidOptions& o) { test::add_cone(s, 2.0, 3.0, o); },
                   [](const Vec3& p) { return cone_distance(p, 2.0, 3.0); }},
        ClosedForm{"Torus", [](Scene& s, const SolidOptions& o) { test::add_torus(s, 3.0, 1.0, o); },
                   [](const Vec3& p) { return std::abs(std::hypot(p.head<2>().norm() - 3.0, p.z()) - 1.0); }}),
    [](const auto& param_info) { return param_info.param.name; });

TEST(NearestPoint, NothingIsFoundBeyondTheLimit) {
  const Scene scene = test::scene_of(test::add_sphere, 2.0);
  const NearestPoint query(scene, faces_of(scene, SolidId{0}));
  EXPECT_FALSE(query.find({0.0, 0.0, 2.5}, 0.4999999));
  EXPECT_TRUE(query.find({0.0, 0.0, 2.5}, 0.5000001));
  EXPECT_FALSE(query.find({1e12, 0.0, 0.0}, 1.0));
  EXPECT_FALSE(query.find({std::nan(""), 0.0, 0.0}, 1.0));
}

TEST(NearestPoint, ATrimmedFaceEndsAtItsBorder) {
  const Scene scene = test::scene_of(test::add_box_with_hole, Vec3(-3, -3, 0), Vec3(3, 3, 1), 1.0);
  const NearestPoint query(scene, faces_of(scene, SolidId{0}));
  // Over the middle of the hole the nearest points are on its rim.
  const auto near = query.find({0.0, 0.0, 3.0});
  ASSERT_TRUE(near);
  EXPECT_NEAR(near->distance, std::sqrt(1.0 + 4.0), 1e-12);
  EXPECT_NEAR(near->point.z(), 1.0, 1e-12);
}

TEST(NearestPoint, NoFacesNoPoint) {
  const Scene scene = test::scene_of(test::add_sphere, 2.0);
  EXPECT_FALSE(NearestPoint(scene, {}).find({0.0, 0.0, 0.0}));
}

/// Points of a face on a grid of its parameters.
void sample_face(const Scene& scene, FaceId id, int cells, std::vector<Vec3>& out) {
  const TrimRegion region(scene, id);
  const Face& face = scene.faces[id];
  for (int i = 0; i <= cells; ++i) {
    for (int j = 0; j <= cells; ++j) {
      const Vec2 part(static_cast<double>(i) / cells, static_cast<double>(j) / cells);
      const Vec2 uv = region.bounds().min() + part.cwiseProduct(region.bounds().sizes());
      if (region.classify(uv) == TrimRegion::Side::inside) out.push_back(evaluate_point(face.surface, uv));
    }
  }
}

class OnFreeForms : public ::testing::TestWithParam<const char*> {};

/// What is found is a point of the faces, and no point of a dense sample is nearer: two bounds that meet.
TEST_P(OnFreeForms, NoSampledPointIsNearer) {
  const std::string name = GetParam();
  const Scene scene = test::read_scene(test::datasets_dir() / name / (name + ".step"));
  std::mt19937 random(11);
  for (const SolidId solid : scene.solids.ids()) {
    const std::vector<FaceId> faces = faces_of(scene, solid);
    const NearestPoint query(scene, faces);
    std::vector<Vec3> samples;
    for (const FaceId face : faces) sample_face(scene, face, 60, samples);
    const Box3 box = query.bounds();
    for (int i = 0; i < 60; ++i) {
      const Vec3 point = box.center() + 0.8 * random_point(random, 1.0).cwiseProduct(box.sizes());
      const auto near = query.find(point);
      ASSERT_TRUE(near);
      double least = std::numeric_limits<double>::infinity();
      for (const Vec3& sample : samples) least = std::min(least, (sample - point).norm());
      EXPECT_LE(near->distance, least + 1e-12);
      EXPECT_NEAR((near->point - point).norm(), near->distance, 1e-12);
      if (!near->on_edge) {
        EXPECT_LE((evaluate_point(scene.faces[near->face].surface, near->uv) - near->point).norm(), 1e-12);
        EXPECT_NE(TrimRegion(scene, near->face).classify(near->uv), TrimRegion::Side::outside);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(DataSets, OnFreeForms,
                         ::testing::Values("turbine_blade_16", "impeller_135", "gradient_lens", "overmoulded_grip"),
                         [](const auto& param_info) { return std::string(param_info.param); });

/// A point moved off a face along its normal is as far as it was moved, if that is less than any curvature radius.
TEST(NearestPoint, FindsTheWayBackAlongTheNormal) {
  const Scene scene = test::read_scene(test::datasets_dir() / "turbine_blade_16/turbine_blade_16.step");
  for (const SolidId solid : scene.solids.ids()) {
    const NearestPoint query(scene, faces_of(scene, solid));
    for (const FaceId id : faces_of(scene, solid)) {
      const Face& face = scene.faces[id];
      const TrimRegion region(scene, id);
      for (const double part : {0.3, 0.5, 0.61}) {
        const Vec2 uv = region.bounds().min() + part * region.bounds().sizes();
        if (region.classify(uv) != TrimRegion::Side::inside) continue;
        const SurfacePoint s = evaluate(face.surface, uv);
        const auto near = query.find(s.point + 1e-3 * s.normal().normalized(), 1.0);
        ASSERT_TRUE(near);
        EXPECT_NEAR(near->distance, 1e-3, 1e-11);
      }
    }
  }
}

}  // namespace
}  // namespace lamella
