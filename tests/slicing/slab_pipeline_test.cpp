/// How the slicer drives an engine: slab by slab, in parallel, written in order, within bounded memory.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mutex>
#include <thread>

#include "core/error.h"
#include "core/parallel.h"
#include "tests/slicing/known_scene.h"

namespace lamella {
namespace {

using test::Ball;
using test::KnownScene;
using test::Recorder;
using testing::HasSubstr;

/// A tall box and a ball in it.
KnownScene mast() {
  KnownScene known;
  known.add(Box3(Vec3(0, 0, 0), Vec3(8, 8, 400)), 0, 0, "mast");
  known.add(Ball{Vec3(4, 4, 200), 3.5}, 1, 1, "ball");
  return known;
}

constexpr std::size_t kLayers = 400;

LayerPlan plan_of(const KnownScene& known) { return known.plan(1.0, 1.0, HatchLattice{0.7, 0.2, 1.17}); }

/// An engine that carries from layer to layer: each layer's spans are shifted by how many layers of its slab came
/// before, so that slabs cut elsewhere would show.
SlabEngine carrying_engine(const KnownScene& known) {
  SlabEngine engine = known.engine();
  engine.slab_layers = kSlabLayers;
  engine.cut = [inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    inner(slab, out);
    for (std::size_t i = 0; i < slab.size(); ++i) {
      for (SpanRows& rows : out[i].lattices) {
        for (Span& span : rows.spans) {
          span.begin += 1e-3 * static_cast<double>(i);
          span.end += 1e-3 * static_cast<double>(i);
        }
      }
    }
  };
  return engine;
}

SliceReport run(const SlabEngine& engine, const KnownScene& known, LayerSink& sink, int threads = 0,
                const Progress& progress = {}) {
  SliceOptions options;
  options.threads = threads;
  return slice_with(engine, known.scene, known.table, known.measures, plan_of(known), options, sink, progress);
}

TEST(SlabPipeline, AsksForConsecutiveLayersFromMultiplesOfTheSlab) {
  const KnownScene known = mast();
  std::mutex mutex;
  std::vector<std::size_t> seen(kLayers);
  SlabEngine engine = carrying_engine(known);
  engine.cut = [&, inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    inner(slab, out);
    const std::lock_guard lock(mutex);
    EXPECT_EQ(slab.front().layer % kSlabLayers, 0u);
    EXPECT_EQ(slab.size(), std::min(kSlabLayers, kLayers - slab.front().layer));
    for (std::size_t i = 0; i < slab.size(); ++i) {
      EXPECT_EQ(slab[i].layer, slab.front().layer + i);
      EXPECT_DOUBLE_EQ(slab[i].z, static_cast<double>(slab[i].layer) + 0.5);
      ++seen[slab[i].layer];
    }
  };
  Recorder recorder;
  (void)run(engine, known, recorder);
  EXPECT_EQ(seen, std::vector<std::size_t>(kLayers, 1));
}

TEST(SlabPipeline, GivesTheSameForAnyNumberOfThreads) {
  const KnownScene known = mast();
  const SlabEngine engine = carrying_engine(known);
  Recorder one;
  const SliceReport expected = run(engine, known, one, 1);
  ASSERT_EQ(one.layers.size(), kLayers);
  for (const int threads : {2, 3, 0}) {
    Recorder many;
    const SliceReport report = run(engine, known, many, threads);
    EXPECT_EQ(many.layers, one.layers);
    for (const SolidId solid : known.scene.solids.ids()) {
      EXPECT_EQ(report.solids[solid].volume_sliced, expected.solids[solid].volume_sliced);
    }
    ASSERT_EQ(report.overlaps.size(), 1u);
    EXPECT_EQ(report.overlaps[0].volume, expected.overlaps[0].volume);
    EXPECT_EQ(report.overlaps[0].layers, expected.overlaps[0].layers);
    EXPECT_EQ(report.cast.hits, expected.cast.hits);
  }
}

/// Counts slabs that have been begun and whose last layer has not been written.
class SlabCounter : public Recorder {
 public:
  void begin_slab() {
    const long now = ++begun_ - written_;
    long before = most_;
    while (before < now && !most_.compare_exchange_weak(before, now)) {
    }
  }
  void write(const Layer& layer) override {
    std::this_thread::sleep_for(std::chrono::microseconds(200));
    if (layer.index % kSlabLayers == kSlabLayers - 1 || layer.index + 1 == kLayers) ++written_;
  }
  [[nodiscard]] long most() const { return most_; }
  [[nodiscard]] long written() const { return written_; }

 private:
  std::atomic<long> begun_{0};
  std::atomic<long> written_{0};
  std::atomic<long> most_{0};
};

TEST(SlabPipeline, HoldsTwoSlabsAThreadWhenTheSinkIsSlow) {
  const KnownScene known = mast();
  for (const int threads : {1, 2, 0}) {
    SlabCounter sink;
    SlabEngine engine = carrying_engine(known);
    engine.cut = [&, inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
      sink.begin_slab();
      inner(slab, out);
    };
    (void)run(engine, known, sink, threads);
    EXPECT_EQ(static_cast<std::size_t>(sink.written()), (kLayers + kSlabLayers - 1) / kSlabLayers);
    EXPECT_LE(sink.most(), 2 * count_threads(threads));
  }
}

/// Counts what is prepared, and keeps what the rest of it writes.
class Preparer : public Recorder {
 public:
  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    ++prepared_[layer.index];
    return [this, &layer] { write(layer); };
  }
  [[nodiscard]] const auto& prepared() const { return prepared_; }

 private:
  std::array<std::atomic<int>, kLayers> prepared_{};
};

TEST(SlabPipeline, PreparesEveryLayerOnceAndWritesTheRestInOrder) {
  const KnownScene known = mast();
  Recorder expected;
  (void)run(carrying_engine(known), known, expected, 1);
  for (const int threads : {1, 2, 0}) {
    Preparer sink;
    (void)run(carrying_engine(known), known, sink, threads);
    for (const std::atomic<int>& count : sink.prepared()) EXPECT_EQ(count, 1);
    EXPECT_EQ(sink.layers, expected.layers);
    EXPECT_TRUE(sink.is_finished);
  }
}

TEST(SlabPipeline, AbandonsTheSinkWhenALayerCantBePrepared) {
  class Failing : public Recorder {
    [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
      if (layer.index == 200) throw ExportError("no room");
      return Recorder::prepare(layer);
    }
  };
  const KnownScene known = mast();
  Failing sink;
  EXPECT_THROW((void)run(carrying_engine(known), known, sink), ExportError);
  EXPECT_TRUE(sink.is_abandoned);
  EXPECT_FALSE(sink.is_finished);
}

TEST(SlabPipeline, AbandonsTheSinkWhenTheEngineFailsInSlabSeven) {
  const KnownScene known = mast();
  for (const int threads : {1, 0}) {
    SlabEngine engine = carrying_engine(known);
    engine.cut = [inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
      if (slab.front().layer == 7 * kSlabLayers) throw GeometryError("a surface beyond the limits", "#42");
      inner(slab, out);
    };
    Recorder recorder;
    try {
      (void)run(engine, known, recorder, threads);
      FAIL();
    } catch (const GeometryError& error) {
      EXPECT_EQ(error.where(), "#42");
    }
    EXPECT_TRUE(recorder.is_abandoned);
    EXPECT_FALSE(recorder.is_finished);
    EXPECT_LE(recorder.layers.size(), 7 * kSlabLayers);
  }
}

TEST(SlabPipeline, NamesTheLayerOfAnEngineThatDoesNotGiveAllRows) {
  const KnownScene known = mast();
  SlabEngine engine = carrying_engine(known);
  engine.cut = [inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    inner(slab, out);
    if (slab.front().layer == 32) out[5].lattices[1].row_start.pop_back();
  };
  Recorder recorder;
  try {
    (void)run(engine, known, recorder);
    FAIL();
  } catch (const GeometryError& error) {
    EXPECT_THAT(error.what(), HasSubstr("layer 37"));
  }
}

TEST(SlabPipeline, StopsInTheMiddleWhenCancelledByTheEnginesOwnSlab) {
  const KnownScene known = mast();
  std::atomic<bool> cancel{false};
  const Progress progress([](std::string_view, double) {}, &cancel);
  SlabEngine engine = carrying_engine(known);
  engine.cut = [&, inner = engine.cut](std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    inner(slab, out);
    if (slab.front().layer == 10 * kSlabLayers) cancel = true;
  };
  Recorder recorder;
  EXPECT_THROW((void)run(engine, known, recorder, 0, progress), Cancelled);
  EXPECT_FALSE(recorder.is_finished);
  EXPECT_FALSE(recorder.is_abandoned);
  EXPECT_LE(recorder.layers.size(), 10 * kSlabLayers);
  for (std::size_t k = 0; k < recorder.layers.size(); ++k) EXPECT_EQ(recorder.layers[k].index, k);
}

TEST(SlabPipeline, ReportsWhatTheEngineFound) {
  const KnownScene known = mast();
  SlabEngine engine = carrying_engine(known);
  engine.findings = [] { return std::vector<Finding>{{Severity::warning, {}, {}, "#7", "fitted", {}}}; };
  Recorder recorder;
  const SliceReport report = run(engine, known, recorder);
  ASSERT_FALSE(report.findings.empty());
  EXPECT_EQ(report.findings.back().what, "fitted");
}

}  // namespace
}  // namespace lamella
