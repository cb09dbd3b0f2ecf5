/// Shapes chosen against the span engine: folds without a silhouette, loops that touch no edge, tangencies, poles on
/// rows, creases, slivers.

#include <algorithm>
#include <cmath>
#include <complex>
#include <gtest/gtest.h>
#include <random>

#include "model/bezier.h"
#include "model/topology.h"
#include "tests/support/closed_forms.h"
#include "tests/support/cut_scene.h"
#include "tests/support/patch_solids.h"
#include "tests/support/span_sets.h"
#include "tests/support/spline_form.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

using test::ExactSpans;
using test::Placement;

constexpr double kDegree = kPi / 180.0;
constexpr double kBound = 1e-6;  ///< mm

/// Every row against the closed form: all that the exact spans of four neighbours within the bound have in common must
/// be there, and nothing that none of them has.
void expect_exact(const SpanEngine& engine, const std::vector<LayerRequest>& requests, const ExactSpans& exact) {
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  std::size_t met = 0;
  for (std::size_t k = 0; k < requests.size(); ++k) {
    for (std::size_t i = 0; i < requests[k].lattices.size(); ++i) {
      const RowLattice& lattice = requests[k].lattices[i];
      for (std::int64_t row = lattice.first_row; row < lattice.last_row; ++row) {
        const Ray ray = test::ray_of(lattice, row, requests[k].z);
        const Vec3 across = kBound * Vec3::UnitZ().cross(ray.direction);
        const Vec3 up = kBound * Vec3::UnitZ();
        std::vector<Interval> any = exact(ray);
        std::vector<Interval> all = any;
        for (const Vec3& aside : {Vec3(across + up), Vec3(across - up), Vec3(up - across), Vec3(-across - up)}) {
          const std::vector<Interval> moved = exact({ray.origin + aside, ray.direction});
          any = test::united(any, moved);
          all = test::common(all, moved);
        }
        const auto r = static_cast<std::size_t>(row - lattice.first_row);
        const std::vector<Interval> here = test::grown(test::spans_of(layers[k].lattices[i], r, SolidId{0}), 0.0);
        met += here.empty() ? 0 : 1;
        const double invented = test::longest(test::without(here, test::grown(any, kBound)));
        const double lost = test::longest(test::without(test::grown(all, -kBound), here));
        EXPECT_LE(invented, kBound) << "z " << requests[k].z << " row " << lattice.position(row) << test::text_of(here)
                                    << " exact" << test::text_of(exact(ray));
        EXPECT_LE(lost, kBound) << "z " << requests[k].z << " row " << lattice.position(row) << test::text_of(here)
                                << " exact" << test::text_of(exact(ray));
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(met, 0U);
  EXPECT_EQ(test::total(layers).unclosed_rays, 0U);
}

std::vector<LayerRequest> even_layers(const Box3& box, std::size_t count, const std::vector<double>& angles,
                                      std::int64_t rows) {
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k < count; ++k) {
    const double part = (static_cast<double>(k) + 0.37) / static_cast<double>(count);
    LayerRequest request{k, box.min().z() + part * box.sizes().z(), {}};
    for (const double angle : angles) request.lattices.push_back(test::lattice_over(box, angle, rows, 0.41));
    requests.push_back(std::move(request));
  }
  return requests;
}

// The cubic patch.

constexpr double kThickness = 0.3;

/// y + iz = (u + iv)^3, x = v: its Jacobian is positive everywhere, and still the line y = -1, z = 0 meets it twice.
BSplineSurface cubic_patch() {
  return test::polynomial_patch(
      [](double u, double v) {
        const std::complex<double> w = std::pow(std::complex<double>(u, v), 3);
        return Vec3(v, w.real(), w.imag());
      },
      3, {0.1, 1.0}, {-1.0, 1.0});
}

/// Rows along x through the patch swept by kThickness along x: one span for each cube root in its domain.
std::vector<Interval> cubic_spans(const Ray& ray) {
  const std::complex<double> target(ray.origin.y(), ray.origin.z());
  std::vector<Interval> spans;
  for (int k = 0; k < 3; ++k) {
    const double angle = (std::arg(target) + kTwoPi * k) / 3.0;
    const double radius = std::cbrt(std::abs(target));
    const double u = radius * std::cos(angle);
    const double v = radius * std::sin(angle);
    if (u < 0.1 || u > 1.0 || v < -1.0 || v > 1.0) continue;
    const double along = (v - ray.origin.x()) * ray.direction.x();
    spans.push_back({std::min(along, along + kThickness * ray.direction.x()),
                     std::max(along, along + kThickness * ray.direction.x())});
  }
  std::sort(spans.begin(), spans.end(), [](const Interval& a, const Interval& b) { return a.lo < b.lo; });
  return spans;
}

TEST(CubicPatch, IsHitTwiceWithoutAnySilhouette) {
  Scene scene;
  test::add_swept_patch(scene, cubic_patch(), kThickness * Vec3::UnitX());
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const SpanRows rows = test::cut_layer(engine, 1e-3, test::make_lattice(0.0, -1.5, 1.0, 1));
  EXPECT_EQ(test::spans_of(rows, 0, SolidId{0}).size(), 2U);
}

TEST(CubicPatch, GivesTheCubeRootsOfEveryRow) {
  Scene scene;
  test::add_swept_patch(scene, cubic_patch(), kThickness * Vec3::UnitX());
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  expect_exact(engine, even_layers(test::solid_box(scene, SolidId{0}), 64, {0.0, kPi}, 201), cubic_spans);
}

TEST(CubicPatch, HasTheSameSectionsAtEveryHatchAngle) {
  Scene scene;
  test::add_swept_patch(scene, cubic_patch(), kThickness * Vec3::UnitX());
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const Box3 box = test::solid_box(scene, SolidId{0});
  const std::vector<LayerRequest> requests = even_layers(box, 32, {0.0, 67.0 * kDegree, 90.0 * kDegree}, 4001);
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  for (std::size_t k = 0; k < layers.size(); ++k) {
    double areas[3];
    for (std::size_t i = 0; i < 3; ++i) {
      areas[i] = test::total_length(test::spans_of_all(layers[k].lattices[i])) * requests[k].lattices[i].spacing;
    }
    EXPECT_NEAR(areas[1], areas[0], 1e-3) << requests[k].z;
    EXPECT_NEAR(areas[2], areas[0], 1e-3) << requests[k].z;
  }
  EXPECT_EQ(test::total(layers).unclosed_rays, 0U);
}

// The dome whose apex is cut out.

std::vector<Interval> pierced_dome_spans(const Ray& ray, double half) {
  const Vec2 o = ray.origin.head<2>();
  const Vec2 d = ray.direction.head<2>();
  const double z = ray.origin.z();
  if (z < -2.0 || z >= 1.0) return {};
  std::vector<Interval> spans = test::below_zero(1.0, o.dot(d), o.squaredNorm() - (1.0 - z));
  for (int k = 0; k < 2; ++k) spans = test::intersect(spans, test::slab_span(o[k], d[k], -1.0, 1.0));
  std::vector<Interval> tunnel{{-1e9, 1e9}};
  for (int k = 0; k < 2; ++k) tunnel = test::intersect(tunnel, test::slab_span(o[k], d[k], -half, half));
  return test::without(spans, tunnel);
}

class PiercedDome : public testing::TestWithParam<std::tuple<double, bool>> {};

TEST_P(PiercedDome, KeepsItsLoopsThatTouchNoEdge) {
  const auto [half, upside_down] = GetParam();
  Scene scene;
  const double volume = test::add_pierced_dome(scene, half).volume;
  EXPECT_GT(volume, 0.0);
  const double side = upside_down ? -1.0 : 1.0;
  if (upside_down) scene = test::placed(scene, Placement::turned(Vec3::UnitX(), kPi));
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const ExactSpans exact = [&, half = half](const Ray& ray) {
    const Vec3 flip(1.0, side, side);
    return pierced_dome_spans({ray.origin.cwiseProduct(flip), ray.direction.cwiseProduct(flip)}, half);
  };
  expect_exact(engine, even_layers(test::solid_box(scene, SolidId{0}), 96, {0.0, 67.0 * kDegree, 1.0}, 61), exact);
  // A layer alone in the band of the loops.
  expect_exact(engine, {{0, side * 0.31, {test::make_lattice(0.3, -1.5, 0.05, 60)}}}, exact);
}

INSTANTIATE_TEST_SUITE_P(Tunnels, PiercedDome,
                         testing::Combine(testing::Values(0.01, 0.3, 0.69), testing::Values(false, true)));

// Tangencies.

TEST(TorusLying, IsCutAtItsInnerTangentPlane) {
  constexpr double kMajor = 1.0;
  constexpr double kMinor = 0.4;
  Placement lying;
  lying.linear << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  const Scene scene = test::placed(test::scene_of(test::add_torus, kMajor, kMinor), lying);
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const ExactSpans exact = [&](const Ray& ray) {
    const Mat3 back = lying.linear.transpose();
    return test::ring_spans({back * ray.origin, back * ray.direction}, kMajor, kMinor, kMinor);
  };
  std::vector<LayerRequest> requests;
  for (const double side : {-1.0, 1.0}) {
    for (const double aside : {-1e-3, -1e-5, -1e-7, -1e-9, -1e-12, 0.0, 1e-12, 1e-9, 1e-7, 1e-5, 1e-3}) {
      LayerRequest request{0, side * (kMajor - kMinor) + aside, {}};
      for (const double angle : {0.0, 90.0 * kDegree, 67.0 * kDegree}) {
        request.lattices.push_back(test::make_lattice(angle, -1.5, 0.0375, 80));
      }
      requests.push_back(std::move(request));
    }
  }
  expect_exact(engine, requests, exact);
}

TEST(TorusUpright, IsCutBetweenItsTopCircleAndTheSeam) {
  const Scene scene = test::scene_of(test::add_torus, 1.0, 0.4);
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  std::vector<LayerRequest> requests;
  for (const double z : {-0.4 + 1e-7, -1e-9, 0.0, 1e-9, 1e-3, 0.4 - 1e-5, 0.4 - 1e-7}) {
    // Rows at the equators and beside them, by a power of two apart from each other.
    requests.push_back({0, z, {test::make_lattice(0.0, -1.40625, 0.0125, 225), test::make_lattice(0.5, 0.6, 1e-7, 9)}});
  }
  expect_exact(engine, requests, [](const Ray& ray) { return test::ring_spans(ray, 1.0, 0.4, 0.4); });
}

// Poles and apexes.

/// A layer and rows through one point of a placed solid, and by little beside it.
void expect_exact_about(const Scene& scene, const Vec3& point, const ExactSpans& exact) {
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  std::vector<LayerRequest> requests;
  for (const double up : {-1e-4, -1e-6, -1e-8, -1e-12, 0.0, 1e-12, 1e-8, 1e-6, 1e-4}) {
    LayerRequest request{0, point.z() + up, {}};
    for (const double angle : {0.0, 90.0 * kDegree, 67.0 * kDegree}) {
      for (const double spacing : {1e-12, 1e-9, 1e-6, 1e-3, 0.05}) {
        RowLattice lattice = test::make_lattice(angle, 0.0, spacing, 21);
        lattice.anchor = lattice.across.dot(Vec2(point.head<2>())) - 10.5 * spacing;
        request.lattices.push_back(lattice);
      }
    }
    requests.push_back(std::move(request));
  }
  expect_exact(engine, requests, exact);
}

ExactSpans placed_spans(const ExactSpans& exact, const Placement& placement) {
  return [=](const Ray& ray) {
    const Mat3 back = placement.linear.transpose();
    return exact({back * (ray.origin - placement.translation), back * ray.direction});
  };
}

class PolesOnRows : public testing::TestWithParam<unsigned> {};

TEST_P(PolesOnRows, LeaveTheSphereWhole) {
  const Placement tilt = test::random_rotation(GetParam());
  const Scene analytic = test::placed(test::scene_of(test::add_sphere, 1.0), tilt);
  const ExactSpans exact = [](const Ray& ray) { return test::sphere_spans(ray, 1.0); };
  expect_exact_about(analytic, tilt.apply(Vec3::UnitZ()), exact);
  expect_exact_about(test::as_splines(analytic), tilt.apply(Vec3::UnitZ()), exact);
}

TEST_P(PolesOnRows, LeaveTheEllipsoidWhole) {
  Scene upright;
  test::add_revolved_ellipsoid(upright, 1.0, 0.6);
  const Placement tilt = test::random_rotation(GetParam());
  const ExactSpans exact = placed_spans(
      [](const Ray& ray) {
        return test::ellipsoid_spans(ray, {1.0, 1.0, 0.6});
      },
      tilt);
  expect_exact_about(test::placed(upright, tilt), tilt.apply({0.0, 0.0, 0.6}), exact);
  expect_exact_about(test::placed(upright, tilt), tilt.apply({0.0, 0.0, -0.6}), exact);
}

TEST_P(PolesOnRows, LeaveTheConeItsApex) {
  const Placement tilt = test::random_rotation(GetParam());
  const Scene scene = test::placed(test::scene_of(test::add_cone, 1.0, 1.5), tilt);
  const ExactSpans exact = placed_spans([](const Ray& ray) { return test::frustum_spans(ray, 1.0, 0.0, 1.5); }, tilt);
  expect_exact_about(scene, tilt.apply({0.0, 0.0, 1.5}), exact);
  expect_exact_about(test::as_splines(scene), tilt.apply({0.0, 0.0, 1.5}), exact);
}

INSTANTIATE_TEST_SUITE_P(Tilts, PolesOnRows, testing::Range(1U, 7U));

TEST(SphereLying, IsWholeAtTheHeightOfItsPoles) {
  for (const bool rounded : {false, true}) {
    Placement lying = Placement::turned(Vec3::UnitY(), 0.5 * kPi);
    if (!rounded) lying.linear << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    const Scene scene = test::placed(test::scene_of(test::add_sphere, 1.0), lying);
    const ExactSpans exact = [](const Ray& ray) { return test::sphere_spans(ray, 1.0); };
    for (const Vec3& at : {Vec3(1.0, 0.0, 0.0), Vec3(-1.0, 0.0, 0.0), Vec3(0.0, 0.0, 0.0)}) {
      expect_exact_about(scene, at, exact);
      expect_exact_about(test::as_splines(scene), at, exact);
    }
  }
}

// Creases.

/// x = f(y, z), bilinear between the nine points of a 3 x 3 grid over [0, 2]^2.
constexpr double kTent[3][3] = {{0.0, 0.3, 0.1}, {0.2, 1.0, -0.4}, {0.1, -0.5, 0.2}};

double tent_at(double y, double z) {
  const int i = y < 1.0 ? 0 : 1;
  const int j = z < 1.0 ? 0 : 1;
  const double a = y - i;
  const double b = z - j;
  return (1 - a) * ((1 - b) * kTent[i][j] + b * kTent[i][j + 1]) +
         a * ((1 - b) * kTent[i + 1][j] + b * kTent[i + 1][j + 1]);
}

BSplineSurface tent() {
  BSplineSurface surface{1, 1, 3, 3, {0, 0, 1, 2, 2}, {0, 0, 1, 2, 2}, {}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) surface.poles.emplace_back(kTent[i][j], i, j);
  }
  return surface;
}

std::vector<Interval> tent_spans(const Ray& ray) {
  const double y = ray.origin.y();
  const double z = ray.origin.z();
  if (y < 0.0 || y >= 2.0 || z < 0.0 || z >= 2.0) return {};
  const double x = tent_at(y, z) - ray.origin.x();
  return {{x, x + 1.0}};
}

TEST(Creases, AtKnotsOfDegreeOneAreKept) {
  Scene scene;
  test::add_swept_patch(scene, tent(), Vec3::UnitX());
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  std::vector<LayerRequest> requests = even_layers(test::solid_box(scene, SolidId{0}), 40, {0.0}, 101);
  for (const double z : {1.0 - 1e-9, 1.0, 1.0 + 1e-9}) {
    requests.push_back({0, z, {test::make_lattice(0.0, -0.0625, 0.125, 16), test::make_lattice(0.0, 0.9, 0.013, 16)}});
  }
  expect_exact(engine, requests, tent_spans);
}

TEST(Creases, AtFullKnotsOfDegreeThreeAreKept) {
  // The same tent with its degree raised: inner knots of multiplicity three, poles on straight lines.
  const BSplineSurface flat = tent();
  BSplineSurface raised{3, 3, 7, 7, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}, {0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 2}, {}, {}};
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 7; ++j) raised.poles.emplace_back(tent_at(i / 3.0, j / 3.0), i / 3.0, j / 3.0);
  }
  Scene scene;
  test::add_swept_patch(scene, raised, Vec3::UnitX());
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  std::vector<LayerRequest> requests = even_layers(test::solid_box(scene, SolidId{0}), 40, {0.0}, 101);
  requests.push_back({0, 1.0, {test::make_lattice(0.0, -0.0625, 0.125, 16)}});
  expect_exact(engine, requests, tent_spans);
}

// Slivers.

TEST(Slivers, OfAMillionthMillimetreAreThere) {
  for (int thin = 0; thin < 3; ++thin) {
    Vec3 size(3.0, 2.0, 1.0);
    size[thin] = 1e-6;
    for (const unsigned seed : {0U, 1U, 2U}) {
      const Placement tilt = seed == 0 ? Placement{} : test::random_rotation(seed);
      const Scene scene = test::placed(test::scene_of(test::add_box, Vec3(0, 0, 0), size), tilt);
      const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
      const Box3 box = test::solid_box(scene, SolidId{0});
      CastCounters counters;
      for (const double part : {0.21, 0.5, 0.83}) {
        const double z = box.min().z() + part * box.sizes().z();
        for (const double angle : {0.0, 67.0 * kDegree}) {
          const RowLattice lattice = test::lattice_over(box, angle, 57, 0.3);
          const SpanRows rows = test::cut_layer(engine, z, lattice, &counters);
          for (std::int64_t r = 0; r < lattice.last_row; ++r) {
            const Ray ray = test::ray_of(lattice, r, z);
            const Ray local{tilt.linear.transpose() * ray.origin, tilt.linear.transpose() * ray.direction};
            const double exact = test::total_length(test::box_spans(local, Vec3::Zero(), size));
            const double found = test::total_length(test::spans_of(rows, static_cast<std::size_t>(r), SolidId{0}));
            // The sides are planes to rounding; a row along a side makes of that what 1 / |n . d| says.
            EXPECT_NEAR(found, exact, 1e-9 + 1e-7 * exact) << "thin " << thin << " seed " << seed << " row " << r;
          }
        }
      }
      EXPECT_EQ(counters.unclosed_rays, 0U);
    }
  }
}

TEST(Slivers, OfAMillionthMillimetreBetweenCurvedFacesAreThere) {
  // A tube between two cylinders that are 1e-6 apart: two slivers a row.
  Scene scene;
  test::add_box_with_hole(scene, {-1, -1, 0}, {1, 1, 1}, 1.0 - 1e-6);
  const SpanEngine engine(scene, test::all_solids(scene), {1e-9, 1});
  const SpanRows rows = test::cut_layer(engine, 0.5, test::make_lattice(0.0, -0.5, 1.0, 1));
  const std::vector<Interval> spans = test::spans_of(rows, 0, SolidId{0});
  ASSERT_EQ(spans.size(), 2U);
  EXPECT_NEAR(spans[0].length(), 1e-6, 1e-8);
  EXPECT_NEAR(spans[1].length(), 1e-6, 1e-8);
}

// Shells.

TEST(InvertedShells, AreTurnedAndThenCutAsTheyWere) {
  Scene scene;
  test::add_box_with_void(scene, {-1, -1, -1}, {1, 1, 1}, 0.6);
  Scene inverted = scene;
  for (const FaceId face : inverted.faces.ids()) test::turn_face(inverted, face);
  complete_topology(inverted);
  EXPECT_FALSE(inverted.solids[SolidId{0}].info.healed.empty());
  const std::vector<LayerRequest> requests =
      even_layers(test::solid_box(scene, SolidId{0}), 21, {0.0, 67.0 * kDegree}, 41);
  const auto expected = test::cut_layers(SpanEngine(scene, test::all_solids(scene), {1e-7, 1}), requests);
  const auto found = test::cut_layers(SpanEngine(inverted, test::all_solids(inverted), {1e-7, 1}), requests);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      ASSERT_EQ(found[k].lattices[i].row_start, expected[k].lattices[i].row_start) << k;
      for (std::size_t s = 0; s < found[k].lattices[i].spans.size(); ++s) {
        EXPECT_NEAR(found[k].lattices[i].spans[s].begin, expected[k].lattices[i].spans[s].begin, 1e-6);
        EXPECT_NEAR(found[k].lattices[i].spans[s].end, expected[k].lattices[i].spans[s].end, 1e-6);
      }
    }
  }
}

TEST(TouchingBoxes, MeetWithoutGapOrOverlap) {
  const Scene scene = test::touching_boxes();
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const RowLattice lattice = test::make_lattice(0.0, -0.0625, 0.125, 10);
  for (const double z : {0.0, 0.25, 0.5, 1.0 - 1e-12}) {
    const SpanRows rows = test::cut_layer(engine, z, lattice);
    for (std::size_t r = 0; r < rows.rows(); ++r) {
      const double y = lattice.position(static_cast<std::int64_t>(r));
      const std::size_t expected = y >= 0.0 && y < 1.0 ? 2U : 0U;
      ASSERT_EQ(rows.row(r).size(), expected) << "y " << y << " z " << z;
      if (expected == 2U) {
        EXPECT_EQ(rows.row(r)[0].end, rows.row(r)[1].begin);
      }
    }
  }
  EXPECT_TRUE(test::cut_layer(engine, 1.0, lattice).spans.empty());
}

}  // namespace
}  // namespace lamella
