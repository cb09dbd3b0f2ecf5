/// The same solids said in other words, or moved as a whole: the same spans, each end within the bound, and at ties and
/// tangencies what neighbours within the bound have.

#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <random>
#include <string>

#include "tests/support/cut_scene.h"
#include "tests/support/neighbor_rows.h"
#include "tests/support/restate_scene.h"
#include "tests/support/span_sets.h"
#include "tests/support/spline_form.h"
#include "tests/support/step_scenes.h"
#include "tests/support/swept_solids.h"
#include "tests/support/transform_scene.h"

namespace lamella {
namespace {

using test::Placement;

constexpr double kBound = 1e-6;  ///< mm, x times |n . d|

/// A way to say or to place a scene, and how its layers and rows correspond to those of the scene as it was.
struct Variation {
  std::string name;
  std::function<Scene(const Scene&)> apply;
  double turn = 0.0;          ///< radians added to every hatch angle
  bool mirrors = false;       ///< x runs backwards: hatch angles and spans too
  bool flips = false;         ///< turned over about x: y, z and hatch angles run backwards
  Vec3 shift = Vec3::Zero();  ///< mm, with the layers and rows
};

Placement quarter_turns(int count) {
  Placement placement;
  for (int i = 0; i < count; ++i) {
    Mat3 quarter;
    quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    placement.linear = quarter * placement.linear;
  }
  return placement;
}

std::vector<Variation> variations() {
  const auto moved = [](const Placement& placement) {
    return [placement](const Scene& scene) { return test::placed(scene, placement); };
  };
  Placement turned_over;
  turned_over.linear = Vec3(1.0, -1.0, -1.0).asDiagonal();
  const Vec3 far_away(8192.25, -4096.5, 16384.125);
  return {
      {"ShuffledFaces", [](const Scene& scene) { return test::with_shuffled_faces(scene, 3); }},
      {"SwappedParameters", test::with_swapped_parameters},
      {"ReversedParameters", test::with_reversed_parameters},
      {"InsertedKnots", [](const Scene& scene) { return test::with_inserted_knots(scene, 3, 7); }},
      {"FullKnots", test::with_full_knots},
      {"AsSplines", test::as_splines},
      {"AsSplinesSwapped", [](const Scene& scene) { return test::with_swapped_parameters(test::as_splines(scene)); }},
      {"QuarterTurn", moved(quarter_turns(1)), 0.5 * kPi},
      {"HalfTurn", moved(quarter_turns(2)), kPi},
      {"Mirrored", moved(Placement::mirrored(Vec3::UnitX())), 0.0, true},
      {"TurnedOver", moved(turned_over), 0.0, false, true},
      {"FarAway", moved(Placement::at(far_away)), 0.0, false, false, far_away}};
}

const std::vector<double>& angles() {
  static const std::vector<double> list{0.0, 0.5 * kPi, 67.0 * kPi / 180.0, 2.1};
  return list;
}

/// Two slabs, one of close layers and one over the whole height; a lattice for each angle.
std::vector<LayerRequest> make_requests(const Box3& box) {
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k < 2 * kSlabLayers; ++k) {
    const auto step = static_cast<double>(k % kSlabLayers);
    const double part = k < kSlabLayers ? 0.37 + step / 300.0 : (step + 0.29) / static_cast<double>(kSlabLayers);
    LayerRequest request{k, box.min().z() + part * box.sizes().z(), {}};
    for (const double angle : angles()) request.lattices.push_back(test::lattice_over(box, angle, 40, 0.31));
    requests.push_back(std::move(request));
  }
  return requests;
}

/// The same lines on the varied scene; rows keep their positions.
std::vector<LayerRequest> varied(std::vector<LayerRequest> requests, const Variation& variation) {
  for (LayerRequest& request : requests) {
    if (variation.flips) request.z = -request.z;
    request.z += variation.shift.z();
    for (std::size_t i = 0; i < request.lattices.size(); ++i) {
      RowLattice& lattice = request.lattices[i];
      double angle = angles()[i] + variation.turn;
      if (variation.mirrors || variation.flips) angle = -angle;
      const RowLattice axes = test::make_lattice(angle, 0.0, 1.0, 1);
      lattice.along = axes.along;
      lattice.across = axes.across;
      lattice.anchor += lattice.across.dot(Vec2(variation.shift.head<2>()));
      // Turned over, across runs backwards: the same rows in the other order.
      if (variation.flips) {
        lattice.anchor = -lattice.anchor;
        lattice.first_row = -lattice.last_row;
        lattice.last_row = 0;
      }
    }
  }
  // Slabs ascend in z.
  if (variation.flips) {
    for (std::size_t first = 0; first < requests.size(); first += kSlabLayers) {
      std::reverse(requests.begin() + static_cast<std::ptrdiff_t>(first),
                   requests.begin() + static_cast<std::ptrdiff_t>(first + kSlabLayers));
    }
  }
  return requests;
}

/// Spans of the varied scene on the row that corresponds to a row of the scene as it was.
std::vector<Interval> spans_back(const std::vector<LayerSpans>& layers, const Variation& variation, std::size_t layer,
                                 std::size_t lattice, std::size_t row, SolidId solid, const Vec2& along) {
  if (variation.flips) layer = layer / kSlabLayers * kSlabLayers + (kSlabLayers - 1 - layer % kSlabLayers);
  const SpanRows& rows = layers[layer].lattices[lattice];
  std::vector<Interval> spans = test::spans_of(rows, variation.flips ? rows.rows() - 1 - row : row, solid);
  const double shift = along.dot(Vec2(variation.shift.head<2>()));
  for (Interval& span : spans) span = {span.lo - shift, span.hi - shift};
  if (variation.mirrors) {
    for (Interval& span : spans) span = {-span.hi, -span.lo};
    std::reverse(spans.begin(), spans.end());
  }
  return spans;
}

void expect_same_spans(const Scene& scene, const std::vector<SolidId>& solids, const Variation& variation) {
  Box3 box;
  for (const SolidId solid : solids) box.extend(test::solid_box(scene, solid));
  const std::vector<LayerRequest> requests = make_requests(box);
  const test::NeighborRows bounds(SpanEngine(scene, solids, {1e-7, 1}), requests, kBound);
  const Scene other = variation.apply(scene);
  const std::vector<LayerSpans> found =
      test::cut_layers(SpanEngine(other, solids, {1e-7, 1}), varied(requests, variation));
  EXPECT_EQ(test::total(found).unclosed_rays, 0U);
  EXPECT_GT(test::total(found).hits, 0U);
  for (std::size_t k = 0; k < requests.size(); ++k) {
    for (std::size_t i = 0; i < requests[k].lattices.size(); ++i) {
      const RowLattice& lattice = requests[k].lattices[i];
      for (std::int64_t row = lattice.first_row; row < lattice.last_row; ++row) {
        const auto r = static_cast<std::size_t>(row - lattice.first_row);
        for (const SolidId solid : solids) {
          const std::vector<Interval> here = spans_back(found, variation, k, i, r, solid, lattice.along);
          EXPECT_LE(bounds.excess(k, i, r, solid, here), kBound)
              << "solid " << solid.value() << " layer " << k << " z " << testing::PrintToString(requests[k].z)
              << " along " << lattice.along.transpose() << " row " << testing::PrintToString(lattice.position(row))
              << test::text_of(here) << " before" << test::text_of(bounds.spans(k, i, r, solid));
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
}

class FilesRestated : public testing::TestWithParam<std::tuple<std::filesystem::path, std::size_t>> {};

TEST_P(FilesRestated, HaveTheSameSpans) {
  const Scene scene = test::read_scene(std::get<0>(GetParam()));
  std::vector<SolidId> solids = test::sound_solids(scene);
  if (solids.size() > 12) solids.resize(12);
  expect_same_spans(scene, solids, variations()[std::get<1>(GetParam())]);
}

const auto kFileName = [](const auto& given) {
  return test::test_name(std::get<0>(given.param)) + variations()[std::get<1>(given.param)].name;
};
const auto kVariations = testing::Range<std::size_t>(0, variations().size());

INSTANTIATE_TEST_SUITE_P(Datasets, FilesRestated,
                         testing::Combine(testing::ValuesIn(test::dataset_files()), kVariations), kFileName);
INSTANTIATE_TEST_SUITE_P(Bench, FilesRestated, testing::Combine(testing::ValuesIn(test::bench_files()), kVariations),
                         kFileName);

struct Made {
  std::string name;
  Scene scene;
};

std::vector<Made> make_solids() {
  std::vector<Made> made;
  const auto add = [&](const std::string& name, const auto& build) {
    Scene scene;
    build(scene);
    made.push_back({name + "Tilted", test::placed(scene, test::random_rotation(6))});
    made.push_back({name, std::move(scene)});
  };
  add("Sphere", [](Scene& s) { test::add_sphere(s, 1.0); });
  add("Cone", [](Scene& s) { test::add_cone(s, 1.0, 1.25); });
  add("Torus", [](Scene& s) { test::add_torus(s, 1.0, 0.5); });
  add("Dome", [](Scene& s) { test::add_dome(s, 2.0, 1.5, 1.0, 0.5); });
  add("BoxWithHole", [](Scene& s) { test::add_box_with_hole(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("BoxWithVoid", [](Scene& s) { test::add_box_with_void(s, {-1, -1, 0}, {1, 1, 2}, 0.5); });
  add("Ring", [](Scene& s) { test::add_revolved_ring(s, 1.25, 0.25, 0.5); });
  add("Ellipsoid", [](Scene& s) { test::add_revolved_ellipsoid(s, 1.25, 0.5); });
  add("ExtrudedEllipse", [](Scene& s) { test::add_extruded_ellipse(s, 1.5, 0.75, 1.25); });
  add("Hyperboloid", [](Scene& s) { test::add_revolved_line(s, {0.5, -0.75, -1.0}, {0.5, 0.75, 1.0}); });
  return made;
}

const std::vector<Made>& solids_made() {
  static const std::vector<Made> made = make_solids();
  return made;
}

class SolidsRestated : public testing::TestWithParam<std::tuple<std::size_t, std::size_t>> {};

TEST_P(SolidsRestated, HaveTheSameSpans) {
  const Scene& scene = solids_made()[std::get<0>(GetParam())].scene;
  expect_same_spans(scene, test::all_solids(scene), variations()[std::get<1>(GetParam())]);
}

INSTANTIATE_TEST_SUITE_P(Solids, SolidsRestated,
                         testing::Combine(testing::Range<std::size_t>(0, solids_made().size()), kVariations),
                         [](const auto& given) {
                           return solids_made()[std::get<0>(given.param)].name +
                                  variations()[std::get<1>(given.param)].name;
                         });

TEST(SolidsInAnotherOrder, HaveTheSameBytes) {
  const Scene scene = test::overlapping_boxes();
  const RowLattice lattice = test::make_lattice(0.3, -3.0, 0.1, 60);
  const std::vector<SolidId> backwards{SolidId{1}, SolidId{0}};
  const SpanRows a = test::cut_layer(SpanEngine(scene, test::all_solids(scene), {1e-7, 1}), 1.5, lattice);
  const SpanRows b = test::cut_layer(SpanEngine(scene, backwards, {1e-7, 1}), 1.5, lattice);
  ASSERT_EQ(a.row_start, b.row_start);
  EXPECT_GT(a.spans.size(), 0U);
  for (std::size_t i = 0; i < a.spans.size(); ++i) {
    EXPECT_EQ(a.spans[i].begin, b.spans[i].begin);
    EXPECT_EQ(a.spans[i].end, b.spans[i].end);
    EXPECT_EQ(a.spans[i].solid, b.spans[i].solid);
  }
}

}  // namespace
}  // namespace lamella
