/// Scenes whose vertices, edges and pcurves have all been moved apart at random: every row still closes, and no span is
/// wrong by more than a few times the gap.

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "tests/support/cut_scene.h"
#include "tests/support/disturb_scene.h"
#include "tests/support/neighbor_rows.h"
#include "tests/support/span_sets.h"
#include "tests/support/spline_form.h"
#include "tests/support/step_scenes.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

constexpr double kDegree = kPi / 180.0;
/// A node may be off by the gaps of its vertex, its curve and its pcurve together, and a border between faces by as
/// much on either side.
constexpr double kGaps = 6.0;

std::vector<LayerRequest> make_requests(const Box3& box, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const std::array<double, 4> angles{0.0, 90.0 * kDegree, 67.0 * kDegree, kTwoPi * unit()};
  std::vector<LayerRequest> requests;
  const double first = unit();
  for (std::size_t k = 0; k < 2 * kSlabLayers; ++k) {
    const double part = (static_cast<double>(k) + first) / (2.0 * kSlabLayers);
    LayerRequest request{k, box.min().z() + part * box.sizes().z(), {}};
    for (const double angle : angles) request.lattices.push_back(test::lattice_over(box, angle, 48, unit()));
    requests.push_back(std::move(request));
  }
  return requests;
}

/// Layers on which the engine itself counts doubt may be wrong (a section that passes a pole within the gap), but they
/// must be few: one of the 32.
constexpr std::size_t kDoubtfulLayers = 1;

void expect_between(const test::NeighborRows& bounds, const std::vector<LayerSpans>& found,
                    const std::vector<LayerRequest>& requests, const std::vector<SolidId>& solids, double reach) {
  std::size_t doubtful = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (found[k].cast.uncertain_hits > 0) {
      ++doubtful;
      continue;
    }
    for (std::size_t i = 0; i < found[k].lattices.size(); ++i) {
      for (std::size_t r = 0; r < found[k].lattices[i].rows(); ++r) {
        for (const SolidId solid : solids) {
          const std::vector<Interval> here = test::spans_of(found[k].lattices[i], r, solid);
          EXPECT_LE(bounds.excess(k, i, r, solid, here), reach)
              << "solid " << solid.value() << " z " << requests[k].z << " along "
              << requests[k].lattices[i].along.transpose() << " row "
              << requests[k].lattices[i].position(static_cast<std::int64_t>(r)) << test::text_of(here) << " undisturbed"
              << test::text_of(bounds.spans(k, i, r, solid));
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_LE(doubtful, kDoubtfulLayers);
}

/// `bounded`: spans are compared too, which makes sense where gaps are smaller than features.
void expect_closed(const Scene& scene, const std::vector<SolidId>& solids, double gap, bool stated, bool bounded) {
  Box3 box;
  for (const SolidId solid : solids) box.extend(test::solid_box(scene, solid));
  const std::vector<LayerRequest> requests = make_requests(box, 5);
  const Scene apart = test::disturbed(scene, gap, 23, stated);
  const std::vector<LayerSpans> found = test::cut_layers(SpanEngine(apart, solids, {1e-7, 1}), requests);
  const CastCounters counters = test::total(found);
  EXPECT_EQ(counters.unclosed_rays, 0U);
  EXPECT_GT(counters.hits, 0U);
  for (const LayerSpans& layer : found) {
    for (const SpanRows& rows : layer.lattices) {
      for (const Span& span : rows.spans) ASSERT_TRUE(std::isfinite(span.begin) && std::isfinite(span.end));
    }
  }
  if (!bounded) return;
  const SpanEngine whole(scene, solids, {1e-7, 1});
  expect_between({whole, requests, kGaps * gap}, found, requests, solids, kGaps * gap);
}

class GapsInDatasets : public testing::TestWithParam<std::tuple<std::filesystem::path, double>> {};

TEST_P(GapsInDatasets, LeaveEveryRowClosed) {
  const auto& [file, gap] = GetParam();
  const Scene scene = test::read_scene(file);
  const std::vector<SolidId> solids = test::sound_solids(scene);
  const bool bounded = gap <= 1e-3;
  {
    SCOPED_TRACE("stated");
    expect_closed(scene, solids, gap, true, bounded);
  }
  {
    SCOPED_TRACE("not stated");
    expect_closed(scene, solids, gap, false, false);
  }
  SCOPED_TRACE("tilted");
  expect_closed(test::placed(scene, test::random_rotation(3)), solids, gap, true, bounded);
}

std::string gap_name(double gap) { return "Gap1em" + std::to_string(static_cast<int>(std::lround(-std::log10(gap)))); }

const auto kName = [](const auto& given) {
  return test::test_name(std::get<0>(given.param)) + gap_name(std::get<1>(given.param));
};
const auto kGapSizes = testing::Values(1e-4, 1e-3, 1e-2);

INSTANTIATE_TEST_SUITE_P(Datasets, GapsInDatasets,
                         testing::Combine(testing::ValuesIn(test::dataset_files()), kGapSizes), kName);
INSTANTIATE_TEST_SUITE_P(Bench, GapsInDatasets, testing::Combine(testing::ValuesIn(test::bench_files()), kGapSizes),
                         kName);

struct Made {
  std::string name;
  Scene scene;
};

std::vector<Made> make_solids() {
  std::vector<Made> made;
  const auto add = [&](const std::string& name, const auto& build) {
    Scene scene;
    build(scene);
    made.push_back({name + "AsSpline", test::as_splines(scene)});
    made.push_back({name, std::move(scene)});
  };
  add("Box", [](Scene& s) { test::add_box(s, {-10, -10, -10}, {10, 15, 10}); });
  add("Sphere", [](Scene& s) { test::add_sphere(s, 10.0); });
  add("Cylinder", [](Scene& s) { test::add_cylinder(s, 10.0, 12.5); });
  add("Cone", [](Scene& s) { test::add_cone(s, 10.0, 12.5); });
  add("Torus", [](Scene& s) { test::add_torus(s, 10.0, 5.0); });
  add("Dome", [](Scene& s) { test::add_dome(s, 20.0, 15.0, 10.0, 5.0); });
  add("BoxWithHole", [](Scene& s) { test::add_box_with_hole(s, {-10, -10, 0}, {10, 10, 20}, 5.0); });
  add("BoxWithVoid", [](Scene& s) { test::add_box_with_void(s, {-10, -10, 0}, {10, 10, 20}, 5.0); });
  add("Ring", [](Scene& s) { test::add_revolved_ring(s, 12.5, 2.5, 5.0); });
  add("Ellipsoid", [](Scene& s) { test::add_revolved_ellipsoid(s, 12.5, 5.0); });
  add("ExtrudedEllipse", [](Scene& s) { test::add_extruded_ellipse(s, 15.0, 7.5, 12.5); });
  add("Hyperboloid", [](Scene& s) { test::add_revolved_line(s, {5.0, -7.5, -10.0}, {5.0, 7.5, 10.0}); });
  return made;
}

const std::vector<Made>& solids_made() {
  static const std::vector<Made> made = make_solids();
  return made;
}

class GapsInSolids : public testing::TestWithParam<std::tuple<std::size_t, double>> {};

TEST_P(GapsInSolids, LeaveEveryRowClosedAndNoSpanFarOffUnlessItSaysSo) {
  const auto [number, gap] = GetParam();
  const Scene& scene = solids_made()[number].scene;
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(testing::Message() << "rotation " << seed);
    const Scene turned = seed == 0 ? scene : test::placed(scene, test::random_rotation(seed));
    expect_closed(turned, test::all_solids(turned), gap, true, true);
    expect_closed(turned, test::all_solids(turned), gap, false, false);
  }
}

INSTANTIATE_TEST_SUITE_P(Solids, GapsInSolids,
                         testing::Combine(testing::Range<std::size_t>(0, solids_made().size()), kGapSizes),
                         [](const auto& given) {
                           return solids_made()[std::get<0>(given.param)].name + gap_name(std::get<1>(given.param));
                         });

}  // namespace
}  // namespace lamella
