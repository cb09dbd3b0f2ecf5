// How fast the spans of a row become segments, in ns a span: time per iteration is that of a layer of 1000 rows, and
// `per_span` is what counts. "Layer" adds up the lengths for the report too.

#include <benchmark/benchmark.h>
#include <random>
#include <string>
#include <vector>

#include "slicing/layer_lengths.h"

namespace lamella {
namespace {

constexpr std::size_t kRows = 1000;

/// Rows of spans and what combines them; coordinates differ from row to row so that no branch can be learnt by heart.
struct Case {
  MaterialTable table;
  CombineRules rules;
  std::vector<std::vector<Span>> rows;
  std::size_t spans = 0;

  explicit Case(std::size_t solids) {
    for (std::size_t s = 0; s < solids; ++s) {
      table.materials.push_back({});
      table.assignments.push_back({MaterialId{s}, static_cast<int>(s), ""});
      rules.rank.push_back(static_cast<int>(s));
    }
    IdVector<FaceId, Face> faces(1000);
    for (Face& face : faces) face.tolerance = 1e-7;
    rules.widen_at(faces);
    rules.table = &table;
  }
  Case(const Case&) = delete;
  Case& operator=(const Case&) = delete;

  void add(double begin, double end, std::size_t solid) {
    const FaceId in{(7 * spans) % 1000};
    const FaceId out{(7 * spans + 3) % 1000};
    rows.back().push_back({begin, end, SolidId{solid}, in, out});
    ++spans;
  }
};

/// Slots in one solid: spans that don't touch.
void fill_disjoint(Case& into, std::mt19937& random) {
  std::uniform_real_distribution<double> length(0.1, 1.0);
  for (std::size_t r = 0; r < kRows; ++r) {
    into.rows.emplace_back();
    double x = 0.0;
    for (int i = 0; i < 20; ++i) {
      const double begin = x + length(random);
      x = begin + length(random);
      into.add(begin, x, 0);
    }
  }
}

/// Each solid within the one before and of higher priority; all of different material.
void fill_nested(Case& into, std::mt19937& random) {
  std::uniform_real_distribution<double> jitter(0.0, 0.5);
  for (std::size_t r = 0; r < kRows; ++r) {
    into.rows.emplace_back();
    for (std::size_t s = 0; s < 5; ++s) {
      const double x = static_cast<double>(s);
      into.add(x + jitter(random), 20.0 - x - jitter(random), s);
    }
  }
}

/// Solids side by side; each begins where the one before ends.
void fill_touching(Case& into, std::mt19937& random) {
  std::uniform_real_distribution<double> length(0.1, 1.0);
  for (std::size_t r = 0; r < kRows; ++r) {
    into.rows.emplace_back();
    double x = 0.0;
    for (std::size_t s = 0; s < 20; ++s) {
      const double begin = x;
      x += length(random);
      into.add(begin, x, s);
    }
  }
}

using Fill = void (*)(Case&, std::mt19937&);

void report(benchmark::State& state, std::size_t spans) {
  state.counters["per_span"] = benchmark::Counter(
      static_cast<double>(spans), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void combine_rows(benchmark::State& state, std::size_t solids, Fill fill) {
  Case rows(solids);
  std::mt19937 random(1);
  fill(rows, random);
  RowCombiner combiner;
  std::vector<Segment> segments;
  for (auto _ : state) {
    segments.clear();
    for (const std::vector<Span>& row : rows.rows) combiner.combine(row, rows.rules, segments);
    benchmark::DoNotOptimize(segments.data());
  }
  report(state, rows.spans);
}

void combine_layer(benchmark::State& state, std::size_t solids, Fill fill) {
  Case rows(solids);
  std::mt19937 random(1);
  fill(rows, random);
  RowCombiner combiner;
  SegmentRows out;
  LengthSums sums;
  LayerLengths lengths;
  for (auto _ : state) {
    out.row_start.assign(1, 0);
    out.segments.clear();
    sums.clear(solids, solids);
    for (const std::vector<Span>& row : rows.rows) {
      combiner.combine(row, rows.rules, out.segments);
      sums.add(row, std::span<const Segment>(out.segments).subspan(out.row_start.back()), combiner);
      out.row_start.push_back(out.segments.size());
    }
    sums.write(lengths);
    benchmark::DoNotOptimize(lengths.overlaps.data());
  }
  report(state, rows.spans);
}

BENCHMARK_CAPTURE(combine_rows, disjoint, 1, fill_disjoint);
BENCHMARK_CAPTURE(combine_rows, nested, 5, fill_nested);
BENCHMARK_CAPTURE(combine_rows, touching, 20, fill_touching);
BENCHMARK_CAPTURE(combine_layer, disjoint, 1, fill_disjoint);
BENCHMARK_CAPTURE(combine_layer, nested, 5, fill_nested);
BENCHMARK_CAPTURE(combine_layer, touching, 20, fill_touching);

}  // namespace
}  // namespace lamella
