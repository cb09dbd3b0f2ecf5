#include "model/measure.h"

#include <chrono>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "model/bezier.h"
#include "model/bounds.h"
#include "model/evaluate.h"
#include "model/face_integration.h"
#include "model/rational_form.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using test::KnownSolid;
using test::Placement;
using test::SolidOptions;

/// Relative accuracy the closed forms are met with; far from the origin the coordinates' own rounding shows.
constexpr double kExact = 1e-13;

std::vector<KnownSolid> add_all(Scene& scene, const Placement& placement) {
  SolidOptions options;
  options.placement = placement;
  return {test::add_box(scene, Vec3::Zero(), {1, 2, 3}, options),
          test::add_cylinder(scene, 1.0, 2.0, options),
          test::add_frustum(scene, 2.0, 1.0, 2.0, options),
          test::add_cone(scene, 1.0, 2.0, options),
          test::add_sphere(scene, 1.0, options),
          test::add_torus(scene, 3.0, 1.0, options),
          test::add_dome(scene, 1.0, 2.0, 3.0, 0.5, options),
          test::add_box_with_hole(scene, Vec3::Zero(), {1, 2, 3}, 0.2, options),
          test::add_box_with_void(scene, Vec3::Zero(), {1, 2, 3}, 0.2, options)};
}

void expect_box(const Box3& box, const Vec3& lo, const Vec3& hi, double accuracy) {
  EXPECT_NEAR((box.min() - lo).cwiseAbs().maxCoeff(), 0.0, accuracy) << box.min().transpose();
  EXPECT_NEAR((box.max() - hi).cwiseAbs().maxCoeff(), 0.0, accuracy) << box.max().transpose();
}

class PlacedMeasure : public testing::TestWithParam<Placement> {};

TEST_P(PlacedMeasure, VolumesAndAreasMeetTheirClosedForms) {
  Scene scene;
  const std::vector<KnownSolid> known = add_all(scene, GetParam());
  const double rounding = 1e-15 * GetParam().translation.norm();
  for (const KnownSolid& solid : known) {
    const SolidMeasure measure = measure_solid(scene, solid.id);
    EXPECT_TRUE(measure.converged);
    EXPECT_NEAR(measure.volume / solid.volume, 1.0, kExact + 10 * rounding) << solid.id.value();
    EXPECT_LE(std::abs(measure.volume - solid.volume), measure.volume_error + (kExact + 10 * rounding) * solid.volume);
    if (solid.area) {
      EXPECT_NEAR(measure.area / *solid.area, 1.0, kExact + 10 * rounding) << solid.id.value();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Placements, PlacedMeasure,
                         testing::Values(Placement{}, Placement::at({1e3, -2e3, 5e2}),
                                         Placement::turned({1, 2, 3}, 0.7, {2e4, -1e4, 5}),
                                         Placement::mirrored({1, 2, 3}, {5, 6, 7})));

TEST(Measure, AreasOfAbsoluteNormalsAreWithinOnePercent) {
  Scene scene;
  const auto sphere = test::add_sphere(scene, 2.0);
  const auto cylinder = test::add_cylinder(scene, 1.0, 3.0);
  const auto box = test::add_box(scene, Vec3::Zero(), {1, 2, 3});
  const Vec3 of_sphere = measure_solid(scene, sphere.id).abs_normal_area;
  const Vec3 of_cylinder = measure_solid(scene, cylinder.id).abs_normal_area;
  const Vec3 of_box = measure_solid(scene, box.id).abs_normal_area;
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(of_sphere[axis] / (2 * kPi * 4), 1.0, 0.01);
  EXPECT_NEAR(of_cylinder.x() / 12.0, 1.0, 0.01);  // two silhouettes of 2 r h
  EXPECT_NEAR(of_cylinder.y() / 12.0, 1.0, 0.01);
  EXPECT_NEAR(of_cylinder.z() / kTwoPi, 1.0, 0.01);
  EXPECT_NEAR((of_box - Vec3(12, 6, 4)).norm(), 0.0, 1e-12);
}

TEST(Measure, BoundsOfTurnedQuadricsMeetTheirClosedForms) {
  const Placement turn = Placement::turned({1, 2, 3}, 0.7, {10, 20, 30});
  const Vec3 axis = turn.linear.col(2);
  const Vec3 flat = (Vec3::Ones() - axis.cwiseAbs2()).cwiseSqrt();  // reach of a unit disc across the axis
  SolidOptions options;
  options.placement = turn;
  Scene scene;
  const auto bounds = [&](const KnownSolid& solid) { return measure_solid(scene, solid.id).bounds; };
  const Vec3& o = turn.translation;
  expect_box(bounds(test::add_sphere(scene, 2.0, options)), o - Vec3::Constant(2), o + Vec3::Constant(2), 1e-13);
  const Vec3 ring = 3.0 * flat + Vec3::Ones();
  expect_box(bounds(test::add_torus(scene, 3.0, 1.0, options)), o - ring, o + ring, 1e-12);
  const Vec3 top = o + 2.0 * axis;
  expect_box(bounds(test::add_cylinder(scene, 1.5, 2.0, options)), (o - 1.5 * flat).cwiseMin(top - 1.5 * flat),
             (o + 1.5 * flat).cwiseMax(top + 1.5 * flat), 1e-12);
  expect_box(bounds(test::add_cone(scene, 1.5, 2.0, options)), (o - 1.5 * flat).cwiseMin(top),
             (o + 1.5 * flat).cwiseMax(top), 1e-12);
}

TEST(Measure, BoundsHoldNoTolerance) {
  Scene scene;
  const auto box = test::add_box(scene, {-1, -2, -3}, {1, 2, 3});
  for (Edge& edge : scene.edges) edge.tolerance = 0.1;
  expect_box(measure_solid(scene, box.id).bounds, {-1, -2, -3}, {1, 2, 3}, 0.0);
}

TEST(Measure, BoundsReachTheTopOfADomeInsideItsFace) {
  Scene scene;
  const auto dome = test::add_dome(scene, 4.0, 2.0, 3.0, 0.5);
  // The net's middle weights 3/8 + 3/8 in each parameter, the border 1/8 + 1/8: z = h + bump 3/4.
  expect_box(measure_solid(scene, dome.id).bounds, Vec3::Zero(), {4, 2, 3.375}, 1e-9);
}

/// The dome's top replaced by another surface over [0,1]^2 with the same border.
Scene with_top(const BSplineSurface& top, double bump = 0.0) {
  Scene scene;
  test::add_dome(scene, 1.0, 1.0, 1.0, bump);
  scene.faces[FaceId{5}].surface = top;
  return scene;
}

TEST(Measure, ACreaseInsideAFaceCountsForBoundsAndVolume) {
  BSplineSurface pyramid{1, 1, 3, 3, {0, 0, 0.5, 1, 1}, {0, 0, 0.5, 1, 1}, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) pyramid.poles.emplace_back(0.5 * i, 0.5 * j, i == 1 && j == 1 ? 2.0 : 1.0);
  }
  const Scene scene = with_top(pyramid);
  const SolidMeasure measure = measure_solid(scene, SolidId{0});
  EXPECT_NEAR(measure.volume, 1.25, 1e-13);  // each bilinear quarter has the mean 1/4 of its one raised corner
  expect_box(measure.bounds, Vec3::Zero(), {1, 1, 2}, 1e-12);
}

TEST(Measure, InsertedKnotsChangeNothing) {
  Scene scene;
  const auto dome = test::add_dome(scene, 1.0, 1.0, 1.0, 0.3);
  const SolidMeasure plain = measure_solid(scene, dome.id);
  const std::vector<double> knots_u{0.1, 0.15, 0.5, 0.5, 0.5, 0.9};
  const std::vector<double> knots_v{0.3, 0.7, 0.7};
  auto& top = std::get<BSplineSurface>(scene.faces[FaceId{5}].surface);
  top = refine_v(refine_u(top, knots_u), knots_v);
  const SolidMeasure refined = measure_solid(scene, dome.id);
  EXPECT_NEAR(refined.volume, dome.volume, 1e-14);
  EXPECT_NEAR(refined.area, plain.area, 1e-10);
  expect_box(refined.bounds, plain.bounds.min(), plain.bounds.max(), 1e-9);
}

/// The same shape as another type of surface with the same parameters.
Scene with_surface(Scene scene, FaceId face, const Surface& surface) {
  scene.faces[face].surface = surface;
  return scene;
}

TEST(Measure, ExtrusionsAndRevolutionsEqualTheQuadricsTheyAre) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), o = Vec3::Zero();
  const Scene cylinder = test::scene_of(test::add_cylinder, 1.5, 2.0);
  const Scene cone = test::scene_of(test::add_cone, 1.5, 2.0);
  const Scene sphere = test::scene_of(test::add_sphere, 1.5);
  const Scene torus = test::scene_of(test::add_torus, 3.0, 1.0);
  const Vec3 slant = Vec3(-1.5, 0, 2).normalized();
  const std::pair<Scene, Surface> cases[] = {
      {cylinder, Extrusion{Ellipse<3>{o, 1.5 * x, 1.5 * y}, z}},
      {cylinder, Revolution{Line<3>{1.5 * x, z}, o, z}},
      {cone, Revolution{Line<3>{1.5 * x, slant}, o, z}},
      {sphere, Revolution{Ellipse<3>{o, 1.5 * x, 1.5 * z}, o, z}},
      {torus, Revolution{Ellipse<3>{3 * x, x, z}, o, z}},
  };
  for (const auto& [scene, surface] : cases) {
    const SolidMeasure exact = measure_solid(scene, SolidId{0});
    const SolidMeasure other = measure_solid(with_surface(scene, FaceId{0}, surface), SolidId{0});
    EXPECT_NEAR(other.volume / exact.volume, 1.0, kExact);
    EXPECT_NEAR(other.area / exact.area, 1.0, kExact);
    expect_box(other.bounds, exact.bounds.min(), exact.bounds.max(), 1e-12);
    EXPECT_TRUE(other.converged);
  }
}

/// A full-turn quadric as one rational B-spline: nets of 90 degrees joined at double knots, parameters in arcs.
BSplineSurface joined(const RationalForm& form, int arcs_u, int arcs_v) {
  BSplineSurface surface{2, 2, 2 * arcs_u + 1, 2 * arcs_v + 1, {}, {}, {}, {}};
  const auto knots = [](int arcs) {
    std::vector<double> flat{0.0};
    for (int k = 0; k <= arcs; ++k) flat.insert(flat.end(), 2, k);
    flat.push_back(arcs);
    return flat;
  };
  surface.knots_u = knots(arcs_u);
  surface.knots_v = knots(arcs_v);
  for (int i = 0; i < surface.count_u; ++i) {
    for (int j = 0; j < surface.count_v; ++j) {
      const int a = std::min(i / 2, arcs_u - 1), b = std::min(j / 2, arcs_v - 1);
      const Vec4 p = form.patches[a * arcs_v + b].net[(i - 2 * a) * 3 + (j - 2 * b)];
      surface.poles.push_back(p.head<3>() / p[3]);
      surface.weights.push_back(p[3]);
    }
  }
  return surface;
}

/// A sphere or torus as B-spline, its pcurves scaled to the new parameters.
Scene as_bspline(Scene scene, int arcs_u, int arcs_v) {
  Face& face = scene.faces[FaceId{0}];
  const Box2 old = face.uv_bounds;
  face.surface = joined(rational_form(face.surface, old), arcs_u, arcs_v);
  const Vec2 scale = Vec2(arcs_u, arcs_v).cwiseQuotient(old.sizes());
  for (HalfEdge& use : scene.half_edges) {
    auto& line = std::get<Line<2>>(use.pcurve);
    line.origin = (line.origin - old.min()).cwiseProduct(scale);
    line.direction = line.direction.cwiseProduct(scale);
  }
  face.uv_bounds = Box2(Vec2::Zero(), Vec2(arcs_u, arcs_v));
  return scene;
}

TEST(Measure, RationalBSplineQuadricsMeetTheClosedForms) {
  for (const Placement& placement : {Placement{}, Placement::turned({3, -1, 2}, 1.1, {1, 2, 3})}) {
    SolidOptions options;
    options.placement = placement;
    const Scene sphere = test::scene_of(test::add_sphere, 2.0, options);
    const Scene torus = test::scene_of(test::add_torus, 3.0, 1.0, options);
    for (const auto& [analytic, spline] :
         {std::pair{sphere, as_bspline(sphere, 4, 2)}, std::pair{torus, as_bspline(torus, 4, 4)}}) {
      const SolidMeasure exact = measure_solid(analytic, SolidId{0});
      const SolidMeasure other = measure_solid(spline, SolidId{0});
      EXPECT_TRUE(other.converged);
      EXPECT_NEAR(other.volume / exact.volume, 1.0, 1e-11);
      EXPECT_NEAR(other.area / exact.area, 1.0, 1e-11);
      const double accuracy = 1e-9 * exact.bounds.sizes().norm();
      expect_box(other.bounds, exact.bounds.min(), exact.bounds.max(), accuracy);
    }
  }
}

/// The curve v -> S or u -> S along one border of a polynomial bicubic patch.
BSplineCurve<3> border_of(const BezierPatch& patch, std::size_t first, std::size_t step) {
  BSplineCurve<3> curve{3, {0, 0, 0, 0, 1, 1, 1, 1}, {}, {}};
  for (std::size_t i = 0; i < 4; ++i) curve.poles.push_back(patch.net[first + i * step].head<3>());
  return curve;
}

TEST(Measure, BoundsOfATrimmedFaceLeaveOutWhatIsTrimmedAway) {
  // The dome's top trimmed to its corner [0, 1/4]^2: the apex in the middle is gone.
  Scene scene;
  test::add_dome(scene, 1.0, 1.0, 1.0, 0.4);
  const Face& top = scene.faces[FaceId{5}];
  const RationalForm form = rational_form(top.surface, top.uv_bounds);
  const BezierPatch corner = restrict_to(form.patches.at(0), {0.0, 0.25}, {0.0, 0.25});
  const std::pair<std::size_t, std::size_t> borders[] = {{0, 4}, {12, 1}, {3, 4}, {0, 1}};  // south, east, north, west
  std::size_t side = 0;
  for (const HalfEdgeId id : scene.loops[top.loops.first].half_edges) {
    HalfEdge& use = scene.half_edges[id];
    auto& line = std::get<Line<2>>(use.pcurve);
    line.origin *= 0.25;
    line.direction *= 0.25;
    scene.edges[use.edge].curve = border_of(corner, borders[side].first, borders[side].second);
    ++side;
  }
  const Box3 box = exact_bounds(scene, FaceId{5});
  const Vec3 highest = evaluate_point(top.surface, Vec2(0.25, 0.25));
  EXPECT_LT(highest.z(), 1.25);
  expect_box(box, {0, 0, 1}, {0.25, 0.25, highest.z()}, 1e-9);
}

TEST(Measure, WindingNumbersTellInsideFromOutside) {
  Scene scene;
  const auto known = test::add_box_with_hole(scene, Vec3::Zero(), {2, 2, 2}, 0.5);
  std::vector<FaceId> faces;
  for (const FaceId face : scene.faces.ids()) faces.push_back(face);
  EXPECT_EQ(known.id, SolidId{0});
  EXPECT_NEAR(winding_number(scene, faces, {0.2, 0.3, 0.4}), 1.0, 0.03);
  EXPECT_NEAR(winding_number(scene, faces, {1.0, 1.0, 1.0}), 0.0, 0.03);  // in the hole
  EXPECT_NEAR(winding_number(scene, faces, {1.0, 1.45, 1.0}), 0.0, 0.03);
  EXPECT_NEAR(winding_number(scene, faces, {1.0, 1.55, 1.0}), 1.0, 0.03);
  EXPECT_NEAR(winding_number(scene, faces, {-5.0, 0.3, 0.4}), 0.0, 0.03);
}

TEST(Measure, NumbersThatAreNotFiniteEndWithoutConvergence) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e300}) {
    Scene scene = test::scene_of(test::add_dome, 1.0, 1.0, 1.0, 0.1);
    std::get<BSplineSurface>(scene.faces[FaceId{5}].surface).poles[5].z() = bad;
    const SolidMeasure measure = measure_solid(scene, SolidId{0});
    EXPECT_FALSE(measure.converged) << bad;
    EXPECT_TRUE(std::isfinite(measure.volume));
    EXPECT_TRUE(std::isfinite(measure.area));
  }
}

TEST(Measure, WildWeightsEndInBoundedTime) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> exponent(-4.0, 4.0);
  BSplineSurface wild{3, 3, 4, 4, {0, 0, 0, 0, 1, 1, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}, {}, {}};
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      wild.poles.emplace_back(i / 3.0, j / 3.0, 1.0 + exponent(random));
      wild.weights.push_back(std::pow(10.0, exponent(random)));
    }
  }
  const Scene scene = with_top(wild);
  const auto start = std::chrono::steady_clock::now();
  const SolidMeasure measure = measure_solid(scene, SolidId{0});
  EXPECT_TRUE(std::isfinite(measure.volume));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST(Measure, AllSolidsAreMeasuredAlikeWithAnyNumberOfThreads) {
  Scene scene;
  add_all(scene, {});
  const auto one = measure_solids(scene, {}, 1);
  const auto four = measure_solids(scene, {}, 4);
  for (const SolidId id : scene.solids.ids()) {
    EXPECT_EQ(one[id].volume, four[id].volume);
    EXPECT_EQ(one[id].area, four[id].area);
    EXPECT_EQ(one[id].bounds.min(), four[id].bounds.min());
  }
}

/// Four balls in cubes; instances of two bodies, as a reader would say.
Scene instances() {
  Scene scene;
  const auto add = [&](std::size_t body, const Vec3& shift) {
    const auto place = test::Placement::turned(Vec3(1, 2, 3).normalized(), 0.4, shift);
    const std::size_t first = scene.faces.size();
    const SolidId id = body == 0 ? test::add_box_with_void(scene, Vec3(-3, -2, -2), Vec3(3, 2, 2), 1.0, {place}).id
                                 : test::add_torus(scene, 3.0, 1.0, {place}).id;
    scene.solids[id].info.instance = Instance{body, place.linear, place.translation};
    for (std::size_t f = first; f < scene.faces.size(); ++f)
      scene.faces[FaceId{f}].step_entity = static_cast<int>(100 * body + f - first + 1);
  };
  for (const Vec3& shift : {Vec3(1.7, 0.3, 5.1), Vec3(0, 0, 0), Vec3(100.3, 20.9, 0), Vec3(-7.7, 0, 33.3)}) {
    add(0, shift);
    add(1, shift + Vec3(10, 0, 0));
  }
  return scene;
}

void expect_own_measures(const Scene& scene) {
  const auto measures = measure_solids(scene);
  for (const SolidId id : scene.solids.ids()) {
    const SolidMeasure own = measure_solid(scene, id);
    EXPECT_NEAR(measures[id].volume, own.volume, 1e-9 * own.volume);
    EXPECT_NEAR(measures[id].area, own.area, 1e-7 * own.area);
    EXPECT_LE((measures[id].bounds.min() - own.bounds.min()).norm(), 1e-9);
    EXPECT_LE((measures[id].bounds.max() - own.bounds.max()).norm(), 1e-9);
  }
}

TEST(Measure, OfShiftedInstancesIsWhatEachIsMeasuredToBe) {
  const Scene scene = instances();
  expect_own_measures(scene);
  const auto measures = measure_solids(scene);
  for (std::size_t i = 2; i < 8; ++i) EXPECT_EQ(measures[SolidId{i}].volume, measures[SolidId{i % 2}].volume);
}

TEST(Measure, DoesNotTrustInstancesOfASceneThatHasChanged) {
  Scene moved = instances();
  for (Vertex& vertex : moved.vertices) vertex.point = 1.01 * vertex.point;
  expect_own_measures(moved);
  Scene renamed = instances();
  for (Solid& solid : renamed.solids) solid.info.instance->body = 0;
  expect_own_measures(renamed);
  Scene shifted = instances();
  for (Solid& solid : shifted.solids) solid.info.instance->shift *= 2.0;
  expect_own_measures(shifted);
}

TEST(Measure, CancelStopsTheMeasuring) {
  Scene scene;
  add_all(scene, {});
  const std::atomic<bool> cancel{true};
  EXPECT_THROW(measure_solids(scene, Progress({}, &cancel)), Cancelled);
}

}  // namespace
}  // namespace lamella
