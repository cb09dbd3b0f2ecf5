/// Rows of the span engine against closed forms: every kind of surface, turned and mirrored, at several hatch angles.

#include "tests/support/closed_forms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "tests/support/cut_scene.h"
#include "tests/support/span_sets.h"
#include "tests/support/spline_form.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

using test::ExactSpans;
using test::Placement;

/// mm: largest error in the row's own position, that is, x error times |n . d|.
constexpr double kBound = 1e-6;
constexpr double kDegree = kPi / 180.0;

struct Shape {
  std::string name;
  Scene scene;
  ExactSpans exact;
};

/// Every shape once with analytic surfaces and once as splines, `a` mm being their unit of length.
std::vector<Shape> make_shapes(double a) {
  std::vector<Shape> shapes;
  const auto add = [&](const std::string& name, const auto& build, const ExactSpans& exact) {
    Shape& shape = shapes.emplace_back();
    shape.name = name;
    build(shape.scene);
    shape.exact = exact;
  };
  add(
      "Sphere", [=](Scene& s) { test::add_sphere(s, 1.3 * a); },
      [=](const Ray& ray) { return test::sphere_spans(ray, 1.3 * a); });
  add(
      "Cylinder", [=](Scene& s) { test::add_cylinder(s, 0.9 * a, 1.7 * a); },
      [=](const Ray& ray) { return test::cylinder_spans(ray, 0.9 * a, 1.7 * a); });
  add(
      "Cone", [=](Scene& s) { test::add_cone(s, 1.1 * a, 1.9 * a); },
      [=](const Ray& ray) { return test::frustum_spans(ray, 1.1 * a, 0.0, 1.9 * a); });
  add(
      "Frustum", [=](Scene& s) { test::add_frustum(s, 0.4 * a, 1.2 * a, 1.5 * a); },
      [=](const Ray& ray) { return test::frustum_spans(ray, 0.4 * a, 1.2 * a, 1.5 * a); });
  add(
      "Torus", [=](Scene& s) { test::add_torus(s, 1.2 * a, 0.5 * a); },
      [=](const Ray& ray) { return test::ring_spans(ray, 1.2 * a, 0.5 * a, 0.5 * a); });
  const Vec3 lo = a * Vec3(-1.0, -0.5, 0.0);
  const Vec3 hi = a * Vec3(1.0, 1.5, 0.7);
  add(
      "Box", [=](Scene& s) { test::add_box(s, lo, hi); }, [=](const Ray& ray) { return test::box_spans(ray, lo, hi); });
  add(
      "ExtrudedEllipse", [=](Scene& s) { test::add_extruded_ellipse(s, 1.4 * a, 0.6 * a, 1.1 * a); },
      [=](const Ray& ray) { return test::cylinder_spans(ray, 1.4 * a, 0.6 * a, 1.1 * a); });
  add(
      "RevolvedRing", [=](Scene& s) { test::add_revolved_ring(s, 1.3 * a, 0.3 * a, 0.7 * a); },
      [=](const Ray& ray) { return test::ring_spans(ray, 1.3 * a, 0.3 * a, 0.7 * a); });
  add(
      "RevolvedEllipsoid", [=](Scene& s) { test::add_revolved_ellipsoid(s, 1.2 * a, 0.5 * a); },
      [=](const Ray& ray) { return test::ellipsoid_spans(ray, a * Vec3(1.2, 1.2, 0.5)); });
  add(
      "RevolvedCone", [=](Scene& s) { test::add_revolved_line(s, a * Vec3(1.2, 0.0, 0.0), a * Vec3(0.3, 0.0, 1.4)); },
      [=](const Ray& ray) { return test::frustum_spans(ray, 1.2 * a, 0.3 * a, 1.4 * a); });
  add(
      "Hyperboloid", [=](Scene& s) { test::add_revolved_line(s, a * Vec3(0.5, -0.8, -1.0), a * Vec3(0.5, 0.8, 1.0)); },
      [=](const Ray& ray) { return test::hyperboloid_spans(ray, 0.5 * a, 0.8, a); });
  const std::size_t count = shapes.size();
  for (std::size_t i = 0; i < count; ++i) {
    Shape spline = shapes[i];
    spline.name += "AsSpline";
    spline.scene = test::as_splines(std::move(spline.scene));
    shapes.push_back(std::move(spline));
  }
  return shapes;
}

const std::vector<Shape>& shapes() {
  static const std::vector<Shape> made = make_shapes(1.0);
  return made;
}

struct Pose {
  std::string name;
  Placement placement;
};

std::vector<Pose> poses() {
  const Vec3 aside(0.37, -0.21, 0.53);
  Placement tilted_mirror = test::random_rotation(5);
  tilted_mirror.linear *= Placement::mirrored(Vec3::UnitX()).linear;
  Placement tilted = test::random_rotation(2);
  tilted.translation = aside;
  return {{"Upright", Placement::at(aside)},
          {"UpsideDown", Placement::turned(Vec3::UnitX(), kPi, aside)},
          {"Lying", Placement::turned(Vec3::UnitY(), 0.5 * kPi, aside)},
          {"LyingAskew", Placement::turned({1.0, 2.0, 0.0}, 0.5 * kPi, aside)},
          {"Tilted", tilted},
          {"SlightlyTilted", Placement::turned({1.0, 0.3, 0.0}, 1e-3, aside)},
          {"TiltedMirror", tilted_mirror}};
}

/// Exact spans of a placed solid on a line through space.
std::vector<Interval> exact_spans(const Shape& shape, const Placement& placement, const Ray& ray) {
  const Mat3 back = placement.linear.transpose();
  return shape.exact({back * (ray.origin - placement.translation), back * ray.direction});
}

/// What the rows of one solid came to.
struct Score {
  std::size_t rows = 0;
  std::size_t met = 0;
  std::size_t ties = 0;
  double worst = 0.0;  ///< mm, x error times |n . d|
};

/// Compares one row with the closed form. A row whose neighbours within the bound have another number of spans is a
/// tie; elsewhere the spread of those neighbours at each end is the bound over |n . d|.
void compare_row(const Shape& shape, const Placement& placement, const Ray& ray, const std::vector<Interval>& spans,
                 Score& score) {
  const std::vector<Interval> exact = exact_spans(shape, placement, ray);
  const Vec3 across = Vec3::UnitZ().cross(ray.direction);
  std::vector<std::vector<Interval>> moved;
  for (const Vec3& aside : {across, Vec3(-across), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitZ())}) {
    moved.push_back(exact_spans(shape, placement, {ray.origin + kBound * aside, ray.direction}));
  }
  ++score.rows;
  if (!std::all_of(moved.begin(), moved.end(), [&](const auto& m) { return m.size() == exact.size(); })) {
    ++score.ties;
    return;
  }
  ASSERT_EQ(spans.size(), exact.size()) << "row from " << ray.origin.transpose() << " along "
                                        << ray.direction.transpose() << test::text_of(spans) << " exact"
                                        << test::text_of(exact);
  score.met += exact.empty() ? 0 : 1;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    for (double Interval::*end : {&Interval::lo, &Interval::hi}) {
      double spread = kBound;
      for (const auto& m : moved) spread = std::max(spread, std::abs(m[i].*end - exact[i].*end));
      score.worst = std::max(score.worst, std::abs(spans[i].*end - exact[i].*end) * (kBound / spread));
    }
  }
}

/// Two slabs of even layers and some far apart, each with rows at every angle.
std::vector<LayerRequest> make_requests(const Box3& box, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit;
  const std::array<double, 4> angles{0.0, 90.0 * kDegree, 67.0 * kDegree, kTwoPi * unit(random)};
  std::vector<double> heights;
  const double first = unit(random);
  for (int k = 0; k < 32; ++k) heights.push_back(box.min().z() + box.sizes().z() * (k + first) / 32.0);
  for (int k = 0; k < 16; ++k) heights.push_back(box.min().z() + box.sizes().z() * unit(random));
  std::sort(heights.begin() + 32, heights.end());
  std::vector<LayerRequest> requests;
  for (const double z : heights) {
    LayerRequest request{requests.size(), z, {}};
    for (const double angle : angles) request.lattices.push_back(test::lattice_over(box, angle, 41, unit(random)));
    requests.push_back(std::move(request));
  }
  return requests;
}

/// `tie_share`: how many rows may lie within the bound of a tie.
void expect_closed_form(const Shape& shape, const Placement& placement, double tie_share) {
  const Scene scene = test::placed(shape.scene, placement);
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const std::vector<LayerRequest> requests = make_requests(test::solid_box(scene, SolidId{0}), 11);
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  Score score;
  for (std::size_t k = 0; k < requests.size(); ++k) {
    for (std::size_t i = 0; i < requests[k].lattices.size(); ++i) {
      const RowLattice& lattice = requests[k].lattices[i];
      const SpanRows& rows = layers[k].lattices[i];
      ASSERT_EQ(rows.rows(), static_cast<std::size_t>(lattice.last_row - lattice.first_row));
      for (std::size_t r = 0; r < rows.rows(); ++r) {
        SCOPED_TRACE(testing::Message() << "layer " << k << " lattice " << i << " row " << r);
        const Ray ray = test::ray_of(lattice, lattice.first_row + static_cast<std::int64_t>(r), requests[k].z);
        compare_row(shape, placement, ray, test::spans_of(rows, r, SolidId{0}), score);
        if (testing::Test::HasFatalFailure()) return;
      }
    }
  }
  EXPECT_LE(score.worst, kBound);
  EXPECT_GT(score.met, score.rows / 5);
  EXPECT_LE(static_cast<double>(score.ties), tie_share * static_cast<double>(score.rows));
  EXPECT_EQ(test::total(layers).unclosed_rays, 0U);
  EXPECT_EQ(test::total(layers).uncertain_hits, 0U);
  testing::Test::RecordProperty("worst_nm", std::to_string(1e6 * score.worst));
}

class ClosedForms : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(ClosedForms, GiveTheSpansOfEveryRow) {
  expect_closed_form(shapes()[std::get<0>(GetParam())], poses()[std::get<1>(GetParam())].placement, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Solids, ClosedForms,
                         testing::Combine(testing::Range<std::size_t>(0, shapes().size()),
                                          testing::Range<std::size_t>(0, poses().size())),
                         [](const auto& given) {
                           return shapes()[std::get<0>(given.param)].name + poses()[std::get<1>(given.param)].name;
                         });

class ClosedFormsOfSize : public testing::TestWithParam<double> {};

TEST_P(ClosedFormsOfSize, GiveTheSpansOfEveryRow) {
  const double unit = GetParam();
  for (const Shape& shape : make_shapes(unit)) {
    for (Placement placement : {Placement{}, test::random_rotation(2)}) {
      SCOPED_TRACE(shape.name);
      placement.translation = unit * Vec3(0.37, -0.21, 0.53);
      expect_closed_form(shape, placement, std::max(0.01, 2e-4 / unit));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Units, ClosedFormsOfSize, testing::Values(2e-3, 0.05, 100.0, 1e4));

}  // namespace
}  // namespace lamella
