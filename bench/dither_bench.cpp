// How fast material fractions become materials, in voxels a second on one core, next to error diffusion; and how long
// the mask takes to make, for some shapes of voxels. Fractions differ from voxel to voxel, in blocks as large as a
// layer of 1000 rows of 1000 voxels.

#include <algorithm>
#include <benchmark/benchmark.h>
#include <cmath>
#include <random>
#include <vector>

#include "bench/error_diffusion.h"
#include "slicing/dither_band.h"

namespace lamella {
namespace {

constexpr std::size_t kColumns = 1000;
constexpr std::size_t kRows = 1000;

/// Rows of fractions, planes a material each.
std::vector<float> draw_rows(std::size_t materials) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> part(0.0F, 1.0F);
  std::vector<float> rows(kRows * materials * kColumns);
  for (std::size_t n = 0; n < kRows * kColumns; ++n) {
    float* const voxel = rows.data() + n / kColumns * materials * kColumns + n % kColumns;
    float total = 0.0F;
    for (std::size_t m = 0; m < materials; ++m) total += voxel[m * kColumns] = part(random);
    for (std::size_t m = 0; m < materials; ++m) voxel[m * kColumns] /= total;
  }
  return rows;
}

/// Slopes askew in the layer: material m has its share where the sine of the place, shifted by m, is large.
std::vector<float> make_slope(std::size_t materials) {
  std::vector<float> rows(kRows * materials * kColumns);
  for (std::size_t n = 0; n < kRows * kColumns; ++n) {
    float* const voxel = rows.data() + n / kColumns * materials * kColumns + n % kColumns;
    const double place = 0.008 * static_cast<double>(n % kColumns) + 0.006 * static_cast<double>(n / kColumns);
    float total = 0.0F;
    for (std::size_t m = 0; m < materials; ++m) {
      total += voxel[m * kColumns] = static_cast<float>(1.0 + std::sin(place + static_cast<double>(m)));
    }
    for (std::size_t m = 0; m < materials; ++m) voxel[m * kColumns] /= total;
  }
  return rows;
}

void report(benchmark::State& state) {
  state.counters["voxels"] =
      benchmark::Counter(static_cast<double>(kColumns * kRows), benchmark::Counter::kIsIterationInvariantRate);
}

void make_mask(benchmark::State& state, double x, double y, double z) {
  for (auto _ : state) {
    DitherMask mask(Vec3(x, y, z));
    benchmark::DoNotOptimize(mask.threshold({}));
  }
}

void dither_layer(benchmark::State& state) {
  const auto materials = static_cast<std::size_t>(state.range(0));
  const DitherMask mask(Vec3(0.042, 0.084, 0.027));
  const std::vector<float> rows = draw_rows(materials);
  std::vector<std::uint8_t> out(kColumns);
  std::int64_t layer = 0;
  for (auto _ : state) {
    for (std::size_t j = 0; j < kRows; ++j) {
      const std::span<const float> row(rows.data() + j * materials * kColumns, materials * kColumns);
      dither_row(mask, {3, static_cast<std::int64_t>(j), layer}, row, out);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
    ++layer;
  }
  report(state);
}

/// Rows of equal fractions of all materials, for which the mask is left as it is.
std::vector<float> make_even(std::size_t materials) {
  return std::vector<float>(kRows * materials * kColumns, 1.0F / static_cast<float>(materials));
}

/// Rows, and tiles settled.
void dither_bands(benchmark::State& state, std::vector<float> (*make_rows)(std::size_t)) {
  const auto materials = static_cast<std::size_t>(state.range(0));
  const DitherMask mask(Vec3(0.042, 0.084, 0.027));
  const std::vector<float> rows = make_rows(materials);
  DitherBand band(mask);
  std::int64_t layer = 0;
  for (auto _ : state) {
    for (std::size_t begin = 0; begin < kRows; begin += DitherBand::kRows) {
      band.begin();
      for (std::size_t j = begin; j < std::min<std::size_t>(kRows, begin + DitherBand::kRows); ++j) {
        const std::span<const float> row(rows.data() + j * materials * kColumns, materials * kColumns);
        band.add(0, {3, static_cast<std::int64_t>(j), layer}, row, kColumns);
      }
      band.settle();
      benchmark::DoNotOptimize(band.chosen(0).data());
      benchmark::ClobberMemory();
    }
    ++layer;
  }
  report(state);
}

void diffuse_layer(benchmark::State& state) {
  const std::vector<float> rows = draw_rows(2);
  std::vector<std::uint8_t> out(kColumns);
  ErrorDiffusion peer(kColumns, kRows, 0.0F);
  for (auto _ : state) {
    for (std::size_t j = 0; j < kRows; ++j) {
      peer.dither_row(j, std::span<const float>(rows.data() + (2 * j + 1) * kColumns, kColumns), out);
      benchmark::DoNotOptimize(out.data());
      benchmark::ClobberMemory();
    }
    peer.end_layer();
  }
  report(state);
}

BENCHMARK_CAPTURE(make_mask, cube, 1, 1, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make_mask, printer, 0.042, 0.084, 0.027)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make_mask, rods, 100, 1, 1)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make_mask, sheets, 1, 1, 100)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make_mask, needles, 1, 100, 100)->Unit(benchmark::kMillisecond);
BENCHMARK(dither_layer)->Arg(2)->Arg(3)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dither_bands, even, make_even)->Arg(2)->Arg(3)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dither_bands, slope, make_slope)->Arg(2)->Arg(3)->Arg(4)->Arg(8)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(dither_bands, random, draw_rows)->Arg(2)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK(diffuse_layer)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lamella
