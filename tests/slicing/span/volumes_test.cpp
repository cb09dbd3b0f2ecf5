/// Volumes and areas from lattices laid at random: the mean over many origins is the exact value but for chance.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "model/measure.h"
#include "tests/support/cut_scene.h"
#include "tests/support/single_solid.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

constexpr std::size_t kOrigins = 32;

class Random {
 public:
  explicit Random(std::uint64_t seed) : random_(seed) {}
  /// In [0, 1).
  double unit() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  /// In [lo, hi].
  std::int64_t between(std::int64_t lo, std::int64_t hi) {
    return lo + static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(hi - lo + 1));
  }

 private:
  std::mt19937_64 random_;
};

/// Length of all spans.
double length_of(const SpanRows& rows) {
  double sum = 0.0;
  for (const Span& span : rows.spans) sum += span.end - span.begin;
  return sum;
}

/// Mean of samples and the standard error of the mean.
struct Estimate {
  double mean = 0.0;
  double error = 0.0;
};

Estimate estimate(const std::vector<double>& samples) {
  const auto n = static_cast<double>(samples.size());
  Estimate result;
  for (const double sample : samples) result.mean += sample / n;
  double squares = 0.0;
  for (const double sample : samples) squares += (sample - result.mean) * (sample - result.mean);
  result.error = std::sqrt(squares / (n - 1.0) / n);
  return result;
}

/// The volume by one lattice with a random origin in z, and in y on every layer, at a random hatch angle a layer. The
/// spacings are random too: with one for all, a box has the same number of layers from nearly every origin, and its few
/// exceptions are missed.
double lattice_volume(const SpanEngine& engine, const Box3& box, Random& random) {
  const auto count = static_cast<std::size_t>(random.between(40, 56));
  const double distance = box.sizes().z() / (static_cast<double>(count) - random.unit());
  const double first = box.min().z() - random.unit() * distance;
  std::vector<LayerRequest> requests;
  for (std::size_t k = 0; k <= count + 1; ++k) {
    const RowLattice lattice = test::lattice_over(box, kTwoPi * random.unit(), random.between(40, 56), random.unit());
    requests.push_back({k, first + static_cast<double>(k) * distance, {lattice}});
  }
  const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
  double volume = 0.0;
  for (std::size_t k = 0; k < requests.size(); ++k) {
    volume += length_of(layers[k].lattices[0]) * requests[k].lattices[0].spacing * distance;
  }
  return volume;
}

class Volumes : public testing::TestWithParam<std::filesystem::path> {};

/// A deviation in units of its standard error has Student's distribution with 31 degrees of freedom, its square the
/// mean 31 / 29 and a variance near 2.6. Sections may be off by 1e-7 mm along their whole border, which counts as error
/// too.
TEST_P(Volumes, AreRightOnAverageOverTheOriginsOfLattices) {
  const Scene scene = test::read_scene(GetParam());
  Random random(8);
  std::vector<SolidId> solids = test::sound_solids(scene);
  if (solids.size() > 40) solids.resize(40);
  double squares = 0.0;
  for (const SolidId id : solids) {
    const Scene single = test::single_solid(scene, id);
    const SolidMeasure measure = measure_solid(single, SolidId{0});
    const SpanEngine engine(single, test::all_solids(single), {1e-7, 1});
    std::vector<double> samples;
    for (std::size_t i = 0; i < kOrigins; ++i) samples.push_back(lattice_volume(engine, measure.bounds, random));
    const Estimate volume = estimate(samples);
    const double error = std::hypot(volume.error, 1e-7 * measure.area + measure.volume_error);
    const double deviation = (volume.mean - measure.volume) / error;
    EXPECT_LE(std::abs(deviation), 5.0) << "solid " << id.value() << " mean " << volume.mean << " exact "
                                        << measure.volume << " standard error " << volume.error;
    EXPECT_LE(volume.error, 0.02 * measure.volume) << "solid " << id.value();
    squares += deviation * deviation;
  }
  const auto n = static_cast<double>(solids.size());
  EXPECT_LE(squares, n * 31.0 / 29.0 + 4.0 * std::sqrt(2.6 * n));
}

/// Rows at any hatch angle give the area of the section's arcs.
TEST_P(Volumes, HaveSectionsOfOneAreaAtEveryHatchAngle) {
  const Scene scene = test::read_scene(GetParam());
  Random random(9);
  std::vector<SolidId> solids = test::sound_solids(scene);
  if (solids.size() > 8) solids.resize(8);
  for (const SolidId id : solids) {
    const Scene single = test::single_solid(scene, id);
    const SpanEngine engine(single, test::all_solids(single), {1e-7, 1});
    const Box3 box = test::solid_box(single, SolidId{0});
    std::vector<LayerRequest> requests;
    for (std::size_t k = 0; k < kSlabLayers; ++k) {
      const double part = (static_cast<double>(k) + 0.45) / static_cast<double>(kSlabLayers);
      requests.push_back({k, box.min().z() + part * box.sizes().z(), {}});
      for (const double angle : {0.0, 67.0 * kPi / 180.0}) {
        for (std::size_t i = 0; i < kOrigins; ++i) {
          requests.back().lattices.push_back(test::lattice_over(box, angle, random.between(200, 400), random.unit()));
        }
      }
    }
    std::vector<double> heights;
    for (const LayerRequest& request : requests) heights.push_back(request.z);
    const std::vector<double> exact = engine.section_areas(SolidId{0}, heights);
    const std::vector<LayerSpans> layers = test::cut_layers(engine, requests);
    for (std::size_t k = 0; k < requests.size(); ++k) {
      for (std::size_t first = 0; first < 2 * kOrigins; first += kOrigins) {
        std::vector<double> samples;
        for (std::size_t i = first; i < first + kOrigins; ++i) {
          samples.push_back(length_of(layers[k].lattices[i]) * requests[k].lattices[i].spacing);
        }
        const Estimate area = estimate(samples);
        // Six standard errors: none of some thousands of layers should lie beyond by chance.
        EXPECT_NEAR(area.mean, exact[k], 6.0 * area.error + 1e-6 * box.diagonal().norm())
            << "solid " << id.value() << " z " << requests[k].z << " lattice " << first;
      }
    }
  }
}

const auto kName = [](const auto& given) { return test::test_name(given.param); };
INSTANTIATE_TEST_SUITE_P(Datasets, Volumes, testing::ValuesIn(test::dataset_files()), kName);
INSTANTIATE_TEST_SUITE_P(Bench, Volumes, testing::ValuesIn(test::bench_files()), kName);

}  // namespace
}  // namespace lamella
