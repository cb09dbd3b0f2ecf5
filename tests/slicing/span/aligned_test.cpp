/// Lattices laid exactly through vertices, edges, seams, critical heights and tangencies. The rule for them: a row lies
/// an infinitesimal step towards +z, then towards +across, of where it says.

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <sstream>
#include <string>

#include "model/critical_points.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "tests/support/closed_forms.h"
#include "tests/support/cut_scene.h"
#include "tests/support/span_sets.h"
#include "tests/support/spline_form.h"
#include "tests/support/step_scenes.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

constexpr double kDegree = kPi / 180.0;

/// One row at exactly `position`: half a spacing from an anchor that is nearer to zero, so that no bit is lost.
RowLattice row_at(double angle, double position) {
  const double spacing = position == 0.0 ? 1.0 : std::exp2(std::floor(std::log2(std::abs(position))));
  RowLattice lattice = test::make_lattice(angle, 0.0, spacing, 1);
  lattice.anchor = position - std::copysign(0.5 * spacing, position);
  lattice.first_row = position < 0.0 ? -1 : 0;
  lattice.last_row = lattice.first_row + 1;
  if (lattice.position(lattice.first_row) != position) ADD_FAILURE() << "row misses " << position;
  return lattice;
}

/// At most `count` of the values, in their order, the same every time.
std::vector<double> thinned(const std::set<double>& values, std::size_t count) {
  std::vector<double> result;
  std::mt19937 random(17);
  std::sample(values.begin(), values.end(), std::back_inserter(result), count, random);
  return result;
}

/// Points that lattices have to go through: vertices, and where edges and faces turn in z.
std::vector<Vec3> features(const Scene& scene) {
  std::vector<Vec3> points;
  for (const Vertex& vertex : scene.vertices) points.push_back(vertex.point);
  for (const Edge& edge : scene.edges) {
    if (edge.degenerate) continue;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double t : critical_parameters(edge.curve, edge.range, Vec3::Unit(axis))) {
        points.push_back(evaluate<3>(edge.curve, t).point);
      }
    }
  }
  for (const Face& face : scene.faces) {
    for (const CriticalPoint& point : find_critical_points(face.surface, face.uv_bounds).points) {
      points.push_back(evaluate_point(face.surface, point.uv));
    }
  }
  return points;
}

struct AlignedCut {
  std::vector<LayerRequest> requests;
  std::vector<LayerSpans> layers;
};

/// How far rows are moved from where features lie exactly.
struct Aside {
  double across = 0.0;
  double z = 0.0;
};

/// Every height of a feature with rows through features, at three hatch angles.
AlignedCut cut_aligned(const SpanEngine& engine, const std::vector<Vec3>& points, const Aside& aside = {}) {
  std::set<double> heights;
  for (const Vec3& point : points) heights.insert(point.z());
  AlignedCut cut;
  for (const double angle : {0.0, 90.0 * kDegree, 67.0 * kDegree}) {
    std::set<double> positions;
    const Vec2 across = test::make_lattice(angle, 0.0, 1.0, 1).across;
    for (const Vec3& point : points) positions.insert(across.dot(Vec2(point.head<2>())));
    std::vector<LayerRequest> requests;
    for (const double z : thinned(heights, 120)) {
      LayerRequest request{requests.size(), z + aside.z, {}};
      for (const double at : thinned(positions, 40)) request.lattices.push_back(row_at(angle, at + aside.across));
      requests.push_back(std::move(request));
    }
    for (LayerSpans& layer : test::cut_layers(engine, requests)) cut.layers.push_back(std::move(layer));
    for (LayerRequest& request : requests) cut.requests.push_back(std::move(request));
  }
  return cut;
}

void expect_sane(const SpanRows& rows, const Box3& box) {
  const double reach = box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).norm() + 1e-3;
  for (const Span& span : rows.spans) {
    EXPECT_TRUE(std::isfinite(span.begin) && std::isfinite(span.end));
    EXPECT_LE(span.begin, span.end);
    EXPECT_LE(std::max(std::abs(span.begin), std::abs(span.end)), reach);
    EXPECT_TRUE(span.face_in.valid() && span.face_out.valid());
  }
}

std::string name_of(const AlignedCut& cut, std::size_t layer, std::size_t lattice) {
  const RowLattice& row = cut.requests[layer].lattices[lattice];
  std::ostringstream text;
  text.precision(17);
  text << "z " << cut.requests[layer].z << " row " << row.position(row.first_row) << " along " << row.along.transpose();
  return text.str();
}

/// A row through features has all that its four neighbours have in common, and nothing that none of them has: what lies
/// between may fall to either side, as the last bits of the features have it.
void expect_between(const AlignedCut& exact, const std::array<AlignedCut, 4>& around, SolidId solid, double slack) {
  for (std::size_t k = 0; k < exact.requests.size(); ++k) {
    for (std::size_t i = 0; i < exact.requests[k].lattices.size(); ++i) {
      const auto spans = [&](const AlignedCut& cut) {
        return test::grown(test::spans_of(cut.layers[k].lattices[i], 0, solid), 0.0);
      };
      std::vector<Interval> any = spans(around[0]);
      std::vector<Interval> all = any;
      for (std::size_t j = 1; j < around.size(); ++j) {
        any = test::united(any, spans(around[j]));
        all = test::common(all, spans(around[j]));
      }
      const std::vector<Interval> here = spans(exact);
      EXPECT_LE(test::longest(test::without(here, test::grown(any, slack))), slack)
          << "invented: " << name_of(exact, k, i) << test::text_of(here) << " around it" << test::text_of(any);
      EXPECT_LE(test::longest(test::without(test::grown(all, -slack), here)), slack)
          << "lost: " << name_of(exact, k, i) << test::text_of(here) << " around it" << test::text_of(all);
    }
  }
}

void expect_aligned_rows_hold(const Scene& scene, const std::vector<SolidId>& solids) {
  const SpanEngine engine(scene, solids, {1e-7, 1});
  const std::vector<Vec3> points = features(scene);
  const Box3 box = test::scene_box(scene);
  const AlignedCut exact = cut_aligned(engine, points);
  for (std::size_t k = 0; k < exact.layers.size(); ++k) {
    EXPECT_EQ(exact.layers[k].cast.unclosed_rays, 0U) << name_of(exact, k, 0);
    for (const SpanRows& rows : exact.layers[k].lattices) expect_sane(rows, box);
  }
  double tolerance = 1e-7;
  for (const SolidId solid : solids) tolerance = std::max(tolerance, scene.solids[solid].info.max_tolerance);
  const double step = 10.0 * tolerance;
  const std::array<AlignedCut, 4> around{
      cut_aligned(engine, points, {-step, -step}), cut_aligned(engine, points, {-step, step}),
      cut_aligned(engine, points, {step, -step}), cut_aligned(engine, points, {step, step})};
  for (const SolidId solid : solids) {
    SCOPED_TRACE(testing::Message() << "solid " << solid.value() << " " << scene.solids[solid].info.path);
    expect_between(exact, around, solid, 10.0 * step);
  }
}

class AlignedDatasets : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(AlignedDatasets, LoseAndInventNothingOnRowsThroughFeatures) {
  const Scene scene = test::read_scene(GetParam());
  expect_aligned_rows_hold(scene, test::sound_solids(scene));
}

INSTANTIATE_TEST_SUITE_P(Files, AlignedDatasets, testing::ValuesIn(test::dataset_files()),
                         [](const auto& given) { return test::test_name(given.param); });

struct Made {
  std::string name;
  Scene scene;
};

std::vector<Made> make_solids() {
  std::vector<Made> made;
  const auto add = [&](const std::string& name, const auto& build) {
    Scene scene;
    build(scene);
    made.push_back({name, std::move(scene)});
  };
  add("Box", [](Scene& s) { test::add_box(s, {-1, -1, -1}, {1, 1.5, 1}); });
  add("Sphere", [](Scene& s) { test::add_sphere(s, 1.0); });
  add("Cylinder", [](Scene& s) { test::add_cylinder(s, 1.0, 1.25); });
  add("Cone", [](Scene& s) { test::add_cone(s, 1.0, 1.25); });
  add("Torus", [](Scene& s) { test::add_torus(s, 1.0, 0.5); });
  add("Dome", [](Scene& s) { test::add_dome(s, 2.0, 1.5, 1.0, 0.5); });
  add("BoxWithHole", [](Scene& s) { test::add_box_with_hole(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("BoxWithVoid", [](Scene& s) { test::add_box_with_void(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("Ring", [](Scene& s) { test::add_revolved_ring(s, 1.25, 0.25, 0.5); });
  add("Ellipsoid", [](Scene& s) { test::add_revolved_ellipsoid(s, 1.25, 0.5); });
  add("ExtrudedEllipse", [](Scene& s) { test::add_extruded_ellipse(s, 1.5, 0.75, 1.25); });
  add("Hyperboloid", [](Scene& s) { test::add_revolved_line(s, {0.5, -0.75, -1.0}, {0.5, 0.75, 1.0}); });
  const std::size_t upright = made.size();
  for (std::size_t i = 0; i < upright; ++i) {
    // Once in exact numbers, once with the last bits that a placement from a file has.
    test::Placement lying;
    lying.linear << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    made.push_back({made[i].name + "Lying", test::placed(made[i].scene, lying)});
    const test::Placement rounded = test::Placement::turned(Vec3::UnitY(), 0.5 * kPi);
    made.push_back({made[i].name + "LyingRounded", test::placed(made[i].scene, rounded)});
    made.push_back({made[i].name + "Tilted", test::placed(made[i].scene, test::random_rotation(9))});
  }
  const std::size_t analytic = made.size();
  for (std::size_t i = 0; i < analytic; ++i)
    made.push_back({made[i].name + "AsSpline", test::as_splines(made[i].scene)});
  return made;
}

const std::vector<Made>& solids_made() {
  static const std::vector<Made> made = make_solids();
  return made;
}

class AlignedSolids : public testing::TestWithParam<std::size_t> {};

TEST_P(AlignedSolids, LoseAndInventNothingOnRowsThroughFeatures) {
  const Scene& scene = solids_made()[GetParam()].scene;
  expect_aligned_rows_hold(scene, test::all_solids(scene));
}

INSTANTIATE_TEST_SUITE_P(Solids, AlignedSolids, testing::Range<std::size_t>(0, solids_made().size()),
                         [](const auto& given) { return solids_made()[given.param].name; });

/// Rows and layers at exact multiples of 1 / n over [-1.5, 1.5]^2, many of them in faces and along edges.
void expect_lattice(const Scene& scene, const test::ExactSpans& exact, int n, double slack) {
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  CastCounters counters;
  for (int k = -3 * n / 2; k <= 3 * n / 2; ++k) {
    const double z = static_cast<double>(k) / n;
    for (int j = -3 * n / 2; j <= 3 * n / 2; ++j) {
      const double y = static_cast<double>(j) / n;
      const SpanRows rows = test::cut_layer(engine, z, row_at(0.0, y), &counters);
      const std::vector<Interval> expected = exact({Vec3(0.0, y, z), Vec3::UnitX()});
      EXPECT_NEAR(test::total_length(test::spans_of(rows, 0, SolidId{0})), test::total_length(expected), slack)
          << "y " << y << " z " << z;
    }
  }
  EXPECT_EQ(counters.unclosed_rays, 0U);
}

TEST(AlignedLattice, TakesTheLowerFacesOfABoxAndLeavesTheUpper) {
  expect_lattice(
      test::scene_of(test::add_box, Vec3(-1, -1, -1), Vec3(1, 1, 1)),
      [](const Ray& ray) {
        return test::box_spans(ray, {-1, -1, -1}, {1, 1, 1});
      },
      4, 1e-12);
}

TEST(AlignedLattice, TakesTheLowerDiscOfACylinderAndLeavesTheUpper) {
  expect_lattice(
      test::scene_of(test::add_cylinder, 1.0, 1.25),
      [](const Ray& ray) { return test::cylinder_spans(ray, 1.0, 1.25); }, 8, 2e-6);
}

TEST(AlignedLattice, RunsThroughThePolesOfASphere) {
  expect_lattice(
      test::scene_of(test::add_sphere, 1.0), [](const Ray& ray) { return test::sphere_spans(ray, 1.0); }, 8, 2e-6);
}

TEST(AlignedLattice, RunsThroughTheApexOfACone) {
  expect_lattice(
      test::scene_of(test::add_cone, 1.0, 1.25),
      [](const Ray& ray) { return test::frustum_spans(ray, 1.0, 0.0, 1.25); }, 8, 2e-6);
}

TEST(AlignedLattice, TouchesTheTopCircleAndTheEquatorsOfATorus) {
  expect_lattice(
      test::scene_of(test::add_torus, 1.0, 0.5),
      [](const Ray& ray) {
        if (std::abs(ray.origin.z()) >= 0.5) return std::vector<Interval>{};
        const double part = std::sqrt(0.25 - ray.origin.z() * ray.origin.z());
        const auto outer = test::below_zero(1.0, 0.0, std::pow(ray.origin.y(), 2) - std::pow(1.0 + part, 2));
        const auto inner = test::below_zero(1.0, 0.0, std::pow(ray.origin.y(), 2) - std::pow(1.0 - part, 2));
        return test::without(outer, inner);
      },
      8, 2e-6);
}

TEST(AlignedLattice, GivesACommonFaceOfTouchingBoxesToEachOfThemOnce) {
  const Scene scene = test::touching_boxes();
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  // Rows along y in the common plane x = 1; across is -x there.
  const SpanRows rows = test::cut_layer(engine, 0.5, row_at(0.5 * kPi, -1.0));
  EXPECT_EQ(test::spans_of(rows, 0, SolidId{0}).size() + test::spans_of(rows, 0, SolidId{1}).size(), 1U);
}

}  // namespace
}  // namespace lamella
