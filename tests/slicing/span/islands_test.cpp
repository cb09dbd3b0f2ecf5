/// Random hilly faces, whose sections are mostly islands and lakes that touch no edge: every point of every row against
/// the height of the hills there.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "model/critical_points.h"
#include "model/evaluate.h"
#include "tests/support/cut_scene.h"
#include "tests/support/patch_solids.h"
#include "tests/support/restate_scene.h"
#include "tests/support/span_sets.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

using test::Placement;

constexpr double kBound = 1e-6;  ///< mm

/// Hills over [0, size]^2 and what to make of them.
struct Hills {
  BSplineSurface surface;  ///< z = f(x, y), u = x and v = y
  double size = 0.0;
  double thickness = 0.0;

  [[nodiscard]] double height(double x, double y) const { return evaluate_point(surface, {x, y}).z(); }
};

/// Where `creased`, a third of the knots is full, and the hills have sharp ridges and valleys there.
std::vector<double> random_knots(std::mt19937_64& random, int degree, int spans, double size, bool creased) {
  std::vector<double> knots(static_cast<std::size_t>(degree) + 1, 0.0);
  for (int i = 1; i < spans; ++i) {
    const double at = size * (i + 0.4 * (static_cast<double>(random() % 1000) / 1000.0 - 0.5)) / spans;
    const std::size_t copies = random() % 3 == 0 && creased ? static_cast<std::size_t>(degree) : 1;
    knots.insert(knots.end(), copies, at);
  }
  knots.insert(knots.end(), static_cast<std::size_t>(degree) + 1, size);
  return knots;
}

/// Poles at these parameters make a spline of the identity.
std::vector<double> greville(const std::vector<double>& knots, int degree) {
  std::vector<double> result;
  for (std::size_t i = 0; i + static_cast<std::size_t>(degree) + 1 < knots.size(); ++i) {
    double sum = 0.0;
    for (int k = 1; k <= degree; ++k) sum += knots[i + static_cast<std::size_t>(k)];
    result.push_back(sum / degree);
  }
  return result;
}

Hills random_hills(std::uint64_t seed, bool creased) {
  std::mt19937_64 random(seed);
  Hills hills;
  hills.size = 10.0;
  hills.thickness = 1.5;
  BSplineSurface& s = hills.surface;
  s.degree_u = 1 + static_cast<int>(random() % 4);
  s.degree_v = 1 + static_cast<int>(random() % 4);
  s.knots_u = random_knots(random, s.degree_u, 4 + static_cast<int>(random() % 5), hills.size, creased);
  s.knots_v = random_knots(random, s.degree_v, 4 + static_cast<int>(random() % 5), hills.size, creased);
  const std::vector<double> x = greville(s.knots_u, s.degree_u);
  const std::vector<double> y = greville(s.knots_v, s.degree_v);
  s.count_u = static_cast<int>(x.size());
  s.count_v = static_cast<int>(y.size());
  for (const double px : x) {
    for (const double py : y) s.poles.emplace_back(px, py, static_cast<double>(random() % 4096) / 1024.0);
  }
  return hills;
}

/// Whether a point lies in the hills' layer f <= z < f + thickness, or too near to its border to tell.
enum class Place { inside, outside, doubtful };

Place place_of(const Hills& hills, const Vec3& p) {
  const double to_side = std::min({p.x(), p.y(), hills.size - p.x(), hills.size - p.y()});
  if (to_side < -kBound) return Place::outside;
  const double above = p.z() - hills.height(p.x(), p.y());
  const double below = above - hills.thickness;
  // Slopes are moderate: a point within the bound of the border has a height within ten times that.
  if (to_side < kBound || std::min(std::abs(above), std::abs(below)) < 10.0 * kBound) return Place::doubtful;
  return above > 0.0 && below < 0.0 ? Place::inside : Place::outside;
}

bool contains(const std::vector<Interval>& spans, double x) {
  return std::any_of(spans.begin(), spans.end(), [&](const Interval& span) { return span.contains(x); });
}

struct Count {
  std::size_t inside = 0;
  std::size_t outside = 0;
};

void expect_points(const Hills& hills, const Placement& placement, const RowLattice& lattice, double z,
                   const SpanRows& rows, const Box3& box, Count& count) {
  constexpr int kPoints = 150;
  const double reach = 0.5 * box.diagonal().norm();
  const double middle = lattice.along.dot(Vec2(box.center().head<2>()));
  for (std::int64_t row = lattice.first_row; row < lattice.last_row; ++row) {
    const Ray ray = test::ray_of(lattice, row, z);
    const auto spans = test::spans_of(rows, static_cast<std::size_t>(row - lattice.first_row), SolidId{0});
    for (int i = 0; i < kPoints; ++i) {
      const double t = middle + reach * (2.0 * (i + 0.5) / kPoints - 1.0);
      const Vec3 local = placement.linear.transpose() * (ray.at(t) - placement.translation);
      const Place place = place_of(hills, local);
      if (place == Place::doubtful) continue;
      ++(place == Place::inside ? count.inside : count.outside);
      ASSERT_EQ(contains(spans, t), place == Place::inside)
          << "z " << testing::PrintToString(z) << " row " << testing::PrintToString(lattice.position(row)) << " x " << t
          << test::text_of(spans) << " hills at " << local.transpose();
    }
  }
}

void expect_hills(const Hills& hills, const Scene& scene, const Placement& placement) {
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  const Box3 box = test::solid_box(scene, SolidId{0});
  Count count;
  // One slab over the whole height, one of close layers, and layers alone.
  std::vector<double> heights;
  for (std::size_t k = 0; k < kSlabLayers; ++k) {
    heights.push_back((static_cast<double>(k) + 0.41) / static_cast<double>(kSlabLayers));
  }
  for (std::size_t k = 0; k < kSlabLayers; ++k) heights.push_back(0.48 + static_cast<double>(k) / 400.0);
  std::vector<LayerRequest> requests;
  for (const double part : heights) {
    requests.push_back({requests.size(), box.min().z() + part * box.sizes().z(), {}});
    for (const double angle : {0.0, 1.17}) requests.back().lattices.push_back(test::lattice_over(box, angle, 60, 0.3));
  }
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  EXPECT_EQ(test::total(layers).unclosed_rays, 0U);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    for (std::size_t i = 0; i < requests[k].lattices.size(); ++i) {
      SCOPED_TRACE(testing::Message() << "layer " << k << ", doubts " << layers[k].cast.uncertain_hits);
      expect_points(hills, placement, requests[k].lattices[i], requests[k].z, layers[k].lattices[i], box, count);
      if (testing::Test::HasFatalFailure()) return;
    }
    const RowLattice& lattice = requests[k].lattices[0];
    SCOPED_TRACE(testing::Message() << "layer " << k << " alone");
    expect_points(hills, placement, lattice, requests[k].z, test::cut_layer(engine, requests[k].z, lattice), box,
                  count);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(count.inside, 1000U);
  EXPECT_GT(count.outside, 1000U);
}

class Islands : public testing::TestWithParam<std::tuple<std::uint64_t, bool>> {};

TEST_P(Islands, AndLakesAreAllThere) {
  const auto [seed, creased] = GetParam();
  const Hills hills = random_hills(seed, creased);
  Scene scene;
  test::add_swept_patch(scene, hills.surface, hills.thickness * Vec3::UnitZ());
  Placement placement;
  if (seed % 3 == 1) placement = Placement::turned({1.0, 0.4, 0.0}, 0.15, {0.3, -0.2, 0.1});
  if (seed % 3 == 2) placement = test::random_rotation(static_cast<unsigned>(seed));
  scene = test::placed(scene, placement);
  {
    SCOPED_TRACE("as it is");
    expect_hills(hills, scene, placement);
  }
  {
    SCOPED_TRACE("u and v exchanged");
    expect_hills(hills, test::with_swapped_parameters(scene), placement);
  }
  SCOPED_TRACE("u reversed");
  expect_hills(hills, test::with_reversed_parameters(scene), placement);
}

/// Heights at which the sections of the hills and of their underside change, and very close by.
std::vector<double> sharp_heights(const Scene& scene) {
  std::vector<double> heights;
  for (std::size_t f = 0; f < scene.faces.size(); ++f) {
    const auto* spline = std::get_if<BSplineSurface>(&scene.faces[FaceId{f}].surface);
    if (spline == nullptr) continue;
    const Box2 domain(Vec2(spline->knots_u.front(), spline->knots_v.front()),
                      Vec2(spline->knots_u.back(), spline->knots_v.back()));
    for (const CriticalPoint& point : find_critical_points(*spline, domain).points) heights.push_back(point.z);
  }
  for (const Vertex& vertex : scene.vertices) heights.push_back(vertex.point.z());
  const std::size_t count = heights.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (const double off : {-1e-6, -1e-8, 1e-8, 1e-6}) heights.push_back(heights[i] + off);
  }
  std::sort(heights.begin(), heights.end());
  return heights;
}

class SharpHeights : public testing::TestWithParam<std::uint64_t> {};

TEST_P(SharpHeights, GiveTheIslandsOrADoubt) {
  const Hills hills = random_hills(GetParam(), true);
  Scene scene;
  test::add_swept_patch(scene, hills.surface, hills.thickness * Vec3::UnitZ());
  const Box3 box = test::solid_box(scene, SolidId{0});
  const SpanEngine engine(scene, test::all_solids(scene), {1e-7, 1});
  std::vector<LayerRequest> requests;
  for (const double z : sharp_heights(scene)) {
    if (!(z > box.min().z() + kBound && z < box.max().z() - kBound)) continue;
    requests.push_back({requests.size(), z, {test::lattice_over(box, 1.17, 30, 0.3)}});
  }
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  EXPECT_EQ(test::total(layers).unclosed_rays, 0U);
  Count count;
  std::size_t doubtful = 0;
  for (std::size_t k = 0; k < requests.size(); ++k) {
    if (layers[k].cast.uncertain_hits + layers[k].cast.repaired_rays > 0) {
      ++doubtful;
      continue;
    }
    expect_points(hills, Placement{}, requests[k].lattices[0], requests[k].z, layers[k].lattices[0], box, count);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_LE(50 * doubtful, requests.size());
}

const auto kSeeds = testing::Range<std::uint64_t>(0, 24);
INSTANTIATE_TEST_SUITE_P(Smooth, Islands, testing::Combine(kSeeds, testing::Values(false)));
INSTANTIATE_TEST_SUITE_P(Creased, Islands, testing::Combine(kSeeds, testing::Values(true)));
// A section that went on beyond a crease as if there were none, between two points within their cell.
INSTANTIATE_TEST_SUITE_P(BulgingOverACrease, Islands, testing::Values(std::tuple(std::uint64_t{187}, true)));
// A minimum on a crease that passed for a saddle, beside a knot.
INSTANTIATE_TEST_SUITE_P(KnotByAMinimum, Islands, testing::Values(std::tuple(std::uint64_t{539}, true)));
// Newton's iteration for a node or a cut's crossing that went to and fro over a corner of the curve.
INSTANTIATE_TEST_SUITE_P(NewtonOverACorner, Islands,
                         testing::Values(std::tuple(std::uint64_t{606}, true), std::tuple(std::uint64_t{718}, true)));

// A section by the corner of four cells.
INSTANTIATE_TEST_SUITE_P(ByACorner, SharpHeights, testing::Values<std::uint64_t>(45, 78));
// An arc that has nearly closed to a loop.
INSTANTIATE_TEST_SUITE_P(NearlyClosed, SharpHeights, testing::Values<std::uint64_t>(36));
// Arcs that part at a saddle between two layers, or at a saddle on a crease.
INSTANTIATE_TEST_SUITE_P(Parting, SharpHeights, testing::Values<std::uint64_t>(24, 34, 56));

}  // namespace
}  // namespace lamella
