/// The same layers give the same bytes, whatever else is cut before them, beside them and by whom.

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <thread>

#include "tests/support/cut_scene.h"
#include "tests/support/neighbor_rows.h"
#include "tests/support/span_sets.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

constexpr double kDegree = kPi / 180.0;

bool is_same(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

bool is_same(const Span& a, const Span& b) {
  return is_same(a.begin, b.begin) && is_same(a.end, b.end) && a.solid == b.solid && a.face_in == b.face_in &&
         a.face_out == b.face_out;
}

bool is_same(std::span<const Span> a, std::span<const Span> b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Span& l, const Span& r) { return is_same(l, r); });
}

bool is_same(const SpanRows& a, const SpanRows& b) { return a.row_start == b.row_start && is_same(a.spans, b.spans); }

bool is_same(const std::vector<LayerSpans>& a, const std::vector<LayerSpans>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const LayerSpans& l, const LayerSpans& r) {
    return std::equal(l.lattices.begin(), l.lattices.end(), r.lattices.begin(), r.lattices.end(),
                      [](const SpanRows& x, const SpanRows& y) { return is_same(x, y); });
  });
}

/// Layers a two-hundredth of the height apart, with two lattices each, in a stack that covers part of the scene.
std::vector<LayerRequest> make_requests(const Box3& box, std::size_t slabs) {
  std::vector<LayerRequest> requests;
  const double distance = box.sizes().z() / 200.0;
  const std::size_t count = slabs * kSlabLayers;
  for (std::size_t k = 0; k < count; ++k) {
    // Slabs lie apart from each other, so that few of them cover much.
    const auto slab = static_cast<double>(k / kSlabLayers);
    const double start = box.min().z() + (slab + 0.1) / static_cast<double>(slabs) * box.sizes().z();
    LayerRequest request{k, start + static_cast<double>(k % kSlabLayers) * distance, {}};
    request.lattices.push_back(test::lattice_over(box, 0.0, 80, 0.37));
    request.lattices.push_back(test::lattice_over(box, 67.0 * kDegree * static_cast<double>(k), 80, 0.61));
    requests.push_back(std::move(request));
  }
  return requests;
}

constexpr std::size_t kSlabs = 6;

class Determinism : public testing::TestWithParam<std::filesystem::path> {
 protected:
  void SetUp() override {
    scene_ = test::read_scene(GetParam());
    solids_ = test::sound_solids(scene_);
    for (const SolidId solid : solids_) box_.extend(test::solid_box(scene_, solid));
    requests_ = make_requests(box_, kSlabs);
  }

  [[nodiscard]] SpanEngine engine(int threads = 1) const { return {scene_, solids_, {1e-7, threads}}; }

  [[nodiscard]] std::span<const LayerRequest> slab(std::size_t i) const {
    return std::span(requests_).subspan(i * kSlabLayers, kSlabLayers);
  }
  static std::span<LayerSpans> slab(std::vector<LayerSpans>& layers, std::size_t i) {
    return std::span(layers).subspan(i * kSlabLayers, kSlabLayers);
  }

  Scene scene_;
  std::vector<SolidId> solids_;
  Box3 box_;
  std::vector<LayerRequest> requests_;
};

TEST_P(Determinism, RepeatedRunsAndEnginesGiveTheSameBytes) {
  const SpanEngine first = engine();
  const std::vector<LayerSpans> expected = test::cut_layers(first, requests_);
  EXPECT_GT(test::total(expected).hits, 0U);
  EXPECT_TRUE(is_same(test::cut_layers(first, requests_), expected));
  EXPECT_TRUE(is_same(test::cut_layers(engine(), requests_), expected));
  EXPECT_TRUE(is_same(test::cut_layers(engine(4), requests_), expected));
}

TEST_P(Determinism, SlabsGiveTheSameBytesInAnyOrderAndFromAnyThread) {
  const SpanEngine shared = engine();
  const std::vector<LayerSpans> expected = test::cut_layers(shared, requests_);
  std::vector<LayerSpans> backwards(requests_.size());
  for (std::size_t i = kSlabs; i-- > 0;) shared.cut(slab(i), slab(backwards, i));
  EXPECT_TRUE(is_same(backwards, expected));
  std::vector<LayerSpans> together(requests_.size());
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> workers;
  for (int i = 0; i < 4; ++i) {
    workers.emplace_back([&] {
      for (std::size_t k = next++; k < kSlabs; k = next++) shared.cut(slab(k), slab(together, k));
    });
  }
  for (std::thread& worker : workers) worker.join();
  EXPECT_TRUE(is_same(together, expected));
}

TEST_P(Determinism, ALatticeDoesNotDependOnWhatElseIsAskedOfItsLayer) {
  const SpanEngine shared = engine();
  const std::vector<LayerSpans> expected = test::cut_layers(shared, requests_);
  std::vector<LayerRequest> second;
  std::vector<LayerRequest> part;
  for (const LayerRequest& request : requests_) {
    second.push_back({request.layer, request.z, {request.lattices[1]}});
    part.push_back(second.back());
    part.back().lattices[0].first_row = 17;
    part.back().lattices[0].last_row = 53;
  }
  const std::vector<LayerSpans> alone = test::cut_layers(shared, second);
  const std::vector<LayerSpans> rows = test::cut_layers(shared, part);
  for (std::size_t k = 0; k < requests_.size(); ++k) {
    EXPECT_TRUE(is_same(alone[k].lattices[0], expected[k].lattices[1])) << "layer " << k;
    for (std::size_t r = 17; r < 53; ++r) {
      EXPECT_TRUE(is_same(rows[k].lattices[0].row(r - 17), expected[k].lattices[1].row(r))) << "layer " << k;
    }
  }
}

TEST_P(Determinism, ASolidDoesNotDependOnTheOthers) {
  const std::vector<LayerSpans> expected = test::cut_layers(engine(), requests_);
  for (std::size_t i = 0; i < solids_.size(); i += 1 + solids_.size() / 4) {
    const std::vector<SolidId> one{solids_[i]};
    const std::vector<LayerSpans> alone = test::cut_layers(SpanEngine(scene_, one, {1e-7, 1}), requests_);
    for (std::size_t k = 0; k < requests_.size(); ++k) {
      std::vector<Span> spans = expected[k].lattices[0].spans;
      std::erase_if(spans, [&](const Span& span) { return span.solid != solids_[i]; });
      EXPECT_TRUE(is_same(alone[k].lattices[0].spans, spans)) << "solid " << solids_[i].value() << " layer " << k;
    }
  }
}

/// What is carried from layer to layer may change last digits, but no hit: a layer cut alone has the same spans, each
/// end within what 1e-6 mm aside does to it.
TEST_P(Determinism, ALayerHasTheSameSpansWithAndWithoutItsSlab) {
  constexpr double kBound = 1e-6;
  const SpanEngine shared = engine();
  const std::vector<LayerSpans> carried = test::cut_layers(shared, requests_);
  for (std::size_t k = 0; k < requests_.size(); k += 3) {
    const RowLattice& lattice = requests_[k].lattices[1];
    const test::NeighborRows alone(shared, {{0, requests_[k].z, {lattice}}}, kBound);
    for (std::size_t r = 0; r < carried[k].lattices[1].rows(); ++r) {
      for (const SolidId solid : solids_) {
        const std::vector<Interval> here = test::spans_of(carried[k].lattices[1], r, solid);
        EXPECT_LE(alone.excess(0, 0, r, solid, here), kBound)
            << "solid " << solid.value() << " z " << testing::PrintToString(requests_[k].z) << " layer "
            << k % kSlabLayers << " of its slab, along " << lattice.along.transpose() << " row "
            << lattice.position(static_cast<std::int64_t>(r)) << test::text_of(here) << " alone"
            << test::text_of(alone.spans(0, 0, r, solid));
      }
    }
  }
}

const auto kName = [](const auto& given) { return test::test_name(given.param); };
INSTANTIATE_TEST_SUITE_P(Datasets, Determinism, testing::ValuesIn(test::dataset_files()), kName);
INSTANTIATE_TEST_SUITE_P(Bench, Determinism, testing::ValuesIn(test::bench_files()), kName);

}  // namespace
}  // namespace lamella
