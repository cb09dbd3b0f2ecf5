/// The kernels that find rows on arcs: right by bisection in extended precision, and the same bytes on every level of
/// the architecture that this machine runs.

#include "slicing/span/depth_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "slicing/span/cpu_level.h"

namespace lamella::span {
namespace {

using Quintic = std::array<double, 6>;

long double value_at(const Quintic& c, long double t) {
  long double sum = 0.0L;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * t + c[i];
  return sum;
}

/// An arc over which y runs one way, with rows on it and beyond its ends.
struct Stretch {
  Quintic x;
  Quintic y;
  double begin = 0.0;
  double end = 1.0;
  std::vector<double> rows;

  [[nodiscard]] DepthTask task() const { return {x.data(), y.data(), begin, end, rows.data(), rows.size()}; }
};

/// y' = a square times a positive factor, so that y is monotone and may turn flat inside or at an end.
Stretch random_stretch(std::mt19937_64& random) {
  const auto real = [&](double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); };
  Stretch stretch;
  for (double& c : stretch.x) c = real(-1.0, 1.0);
  const double at = real(-0.3, 1.3);
  const double lift = random() % 3 == 0 ? 0.0 : real(0.0, 1.0);
  const double tilt = real(-0.9, 0.9);
  const double scale = real(-1.0, 1.0) * std::exp2(real(-12.0, 6.0));
  // (lift + (t - at)^2) (1 + tilt t), integrated.
  const double b0 = lift + at * at, b1 = -2.0 * at, b2 = 1.0;
  const std::array<double, 4> slope{b0, b1 + tilt * b0, b2 + tilt * b1, tilt * b2};
  stretch.y = {real(-100.0, 100.0)};
  for (std::size_t i = 0; i < 4; ++i) stretch.y[i + 1] = scale * slope[i] / static_cast<double>(i + 1);
  if (random() % 2 == 0) {
    stretch.begin = real(0.0, 0.5);
    stretch.end = real(0.5, 1.0);
  }
  const auto from = static_cast<double>(value_at(stretch.y, stretch.begin));
  const auto to = static_cast<double>(value_at(stretch.y, stretch.end));
  stretch.rows.resize(random() % 200);
  for (double& row : stretch.rows) row = from + (to - from) * real(-0.05, 1.05);
  std::sort(stretch.rows.begin(), stretch.rows.end());
  return stretch;
}

/// Parameter at which y reaches `row`, clamped to the stretch.
long double find_parameter(const Stretch& stretch, long double row) {
  long double lo = stretch.begin;
  long double hi = stretch.end;
  const bool rises = value_at(stretch.y, lo) < value_at(stretch.y, hi);
  for (int i = 0; i < 80; ++i) {
    const long double middle = 0.5L * (lo + hi);
    ((value_at(stretch.y, middle) < row) == rises ? lo : hi) = middle;
  }
  return 0.5L * (lo + hi);
}

constexpr double kResidual = 1e-9;  ///< mm

/// The xs of one stretch; `failed` is how many rows the kernel gave up.
std::vector<double> solve(const DepthKernel& kernel, const Stretch& stretch, std::size_t& failed) {
  std::vector<double> xs(stretch.rows.size());
  DepthTask task = stretch.task();
  kernel.solve(&task, 1, kResidual, xs.data());
  failed = task.failed;
  return xs;
}

TEST(DepthKernel, FindsEveryRowOfRandomStretches) {
  for (const DepthKernel& kernel : depth_kernels()) {
    std::mt19937_64 random(1);
    for (int k = 0; k < 2000; ++k) {
      const Stretch stretch = random_stretch(random);
      std::size_t failed = 0;
      const std::vector<double> xs = solve(kernel, stretch, failed);
      EXPECT_EQ(failed, 0U) << &kernel - depth_kernels().data();
      for (std::size_t i = 0; i < xs.size(); ++i) {
        // What a row within the residual has, plus rounding.
        const long double first = find_parameter(stretch, stretch.rows[i] - 2.0 * kResidual);
        const long double last = find_parameter(stretch, stretch.rows[i] + 2.0 * kResidual);
        const long double exact = value_at(stretch.x, find_parameter(stretch, stretch.rows[i]));
        // |x'| is at most 15 for coefficients within 1.
        const long double bound = 15.0L * std::abs(last - first) + 1e-12L;
        ASSERT_LE(std::abs(xs[i] - exact), bound)
            << &kernel - depth_kernels().data() << " stretch " << k << " row " << i;
      }
    }
  }
}

TEST(DepthKernel, GivesTheEndForRowsBeyondTheStretch) {
  const std::vector<double> rows{-1e3, 5.0 - 0.75 * 3.0 - 1e-3, 5.0 - 0.25 * 3.0 + 1e-3, 1e3};
  const Stretch stretch{{1.0, 2.0, 0, 0, 0, 0}, {5.0, -3.0, 0, 0, 0, 0}, 0.25, 0.75, rows};
  for (const DepthKernel& kernel : depth_kernels()) {
    std::size_t failed = 0;
    EXPECT_EQ(solve(kernel, stretch, failed), (std::vector<double>{2.5, 2.5, 1.5, 1.5}))
        << &kernel - depth_kernels().data();
    EXPECT_EQ(failed, 0U);
  }
}

TEST(DepthKernel, SolvesManyStretchesAsItSolvesEach) {
  std::mt19937_64 random(5);
  std::vector<Stretch> stretches(500);
  for (Stretch& stretch : stretches) {
    stretch = random_stretch(random);
    if (random() % 4 != 0) stretch.rows.resize(std::min<std::size_t>(stretch.rows.size(), random() % 12));
  }
  for (const DepthKernel& kernel : depth_kernels()) {
    std::vector<DepthTask> tasks;
    std::vector<double> each;
    for (const Stretch& stretch : stretches) {
      tasks.push_back(stretch.task());
      std::size_t failed = 0;
      const std::vector<double> xs = solve(kernel, stretch, failed);
      each.insert(each.end(), xs.begin(), xs.end());
    }
    std::vector<double> all(each.size());
    kernel.solve(tasks.data(), tasks.size(), kResidual, all.data());
    EXPECT_EQ(std::memcmp(all.data(), each.data(), all.size() * sizeof(double)), 0) << &kernel - depth_kernels().data();
  }
}

TEST(DepthKernel, CountsRowsThatItCannotMeetByStretch) {
  const Stretch sound{{0, 1, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, 0.0, 1.0, {0.25, 0.5}};
  // So steep that no number of steps that is worth while finds a row.
  const Stretch broken{{0, 1, 0, 0, 0, 0}, {0, 1e-3, 0, 0, 0, 1e300}, 0.0, 1.0, {0.25, 0.5, 0.75}};
  for (const DepthKernel& kernel : depth_kernels()) {
    std::array<DepthTask, 3> tasks{sound.task(), broken.task(), sound.task()};
    std::array<double, 7> xs{};
    kernel.solve(tasks.data(), tasks.size(), kResidual, xs.data());
    EXPECT_EQ(tasks[0].failed, 0U) << &kernel - depth_kernels().data();
    EXPECT_EQ(tasks[1].failed, 3U) << &kernel - depth_kernels().data();
    EXPECT_EQ(tasks[2].failed, 0U) << &kernel - depth_kernels().data();
  }
}

TEST(DepthKernel, FindsRowsOnChords) {
  for (const DepthKernel& kernel : depth_kernels()) {
    const std::array<double, 4> rows{-1.0, 1.0, 2.5, 7.0};
    std::array<double, 4> xs{};
    kernel.line({10.0, 8.0, 1.0, 4.0}, rows.data(), rows.size(), xs.data());
    EXPECT_EQ(xs, (std::array<double, 4>{10.0, 10.0, 13.0, 18.0})) << &kernel - depth_kernels().data();
    kernel.line({10.0, 8.0, 1.0, 0.0}, rows.data(), rows.size(), xs.data());
    EXPECT_EQ(xs, (std::array<double, 4>{10.0, 10.0, 10.0, 10.0})) << &kernel - depth_kernels().data();
  }
}

TEST(DepthKernel, FindsRowsOnRoundSections) {
  // The circle of radius 2 about (1, 3).
  for (const DepthKernel& kernel : depth_kernels()) {
    const std::array<double, 6> rows{1.0, 1.0 + 1e-9, 2.0, 3.0, 4.5, 5.0};
    for (const double side : {-1.0, 1.0}) {
      std::array<double, 6> xs{};
      kernel.round({1.0, 3.0, 2.0, 0.0, side * 2.0}, rows.data(), rows.size(), xs.data());
      for (std::size_t i = 0; i < rows.size(); ++i) {
        const double half = std::sqrt((2.0 - (rows[i] - 3.0)) * (2.0 + (rows[i] - 3.0)));
        EXPECT_NEAR(xs[i], 1.0 + side * half, 1e-8) << &kernel - depth_kernels().data() << " row " << rows[i];
      }
    }
  }
}

TEST(DepthKernel, BlendsPolynomialsOfDegreeFour) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> real(-1.0, 1.0);
  for (const std::size_t count : {0U, 1U, 7U, 64U, 131U}) {
    std::vector<double> coefficients(5 * count);
    for (double& c : coefficients) c = real(random);
    for (const DepthKernel& kernel : depth_kernels()) {
      std::vector<double> sums(count, -1.0);
      kernel.blend(coefficients.data(), count, 0.3, sums.data());
      for (std::size_t i = 0; i < count; ++i) {
        long double sum = 0.0L;
        for (std::size_t power = 5; power-- > 0;) sum = sum * 0.3L + coefficients[power * count + i];
        EXPECT_NEAR(sums[i], static_cast<double>(sum), 1e-14) << &kernel - depth_kernels().data();
      }
    }
  }
}

/// Everything the kernel gives for many random tasks, as one run of numbers.
std::vector<double> results_of(const DepthKernel& kernel) {
  std::mt19937_64 random(7);
  std::vector<double> all;
  for (int k = 0; k < 3000; ++k) {
    const Stretch stretch = random_stretch(random);
    std::size_t failed = 0;
    std::vector<double> xs = solve(kernel, stretch, failed);
    all.push_back(static_cast<double>(failed));
    all.insert(all.end(), xs.begin(), xs.end());
    kernel.line({stretch.x[0], stretch.x[1], stretch.y[0], stretch.y[1]}, stretch.rows.data(), xs.size(), xs.data());
    all.insert(all.end(), xs.begin(), xs.end());
    kernel.round({stretch.x[0], stretch.y[0], std::abs(stretch.y[1]), stretch.x[1], stretch.x[2]}, stretch.rows.data(),
                 xs.size(), xs.data());
    all.insert(all.end(), xs.begin(), xs.end());
    const std::size_t count = stretch.rows.size() / 5;
    xs.resize(count);
    kernel.blend(stretch.rows.data(), count, stretch.x[0], xs.data());
    all.insert(all.end(), xs.begin(), xs.end());
  }
  return all;
}

TEST(DepthKernel, GivesTheSameBytesOnEveryLevel) {
  const std::span<const DepthKernel> kernels = depth_kernels();
  ASSERT_FALSE(kernels.empty());
  const std::vector<double> expected = results_of(kernels.front());
  EXPECT_GT(expected.size(), 100'000U);
  for (const DepthKernel& kernel : kernels.subspan(1)) {
    const std::vector<double> found = results_of(kernel);
    ASSERT_EQ(found.size(), expected.size());
    EXPECT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(double)), 0)
        << &kernel - depth_kernels().data();
  }
}

/// By the flags that the system tells of the processor.
TEST(CpuLevel, IsTheHighestThatTheMachineRuns) {
  std::ifstream info("/proc/cpuinfo");
  std::set<std::string> flags;
  for (std::string line; std::getline(info, line);) {
    if (!line.starts_with("flags")) continue;
    std::istringstream words(line);
    for (std::string word; words >> word;) flags.insert(word);
    break;
  }
  if (flags.empty()) GTEST_SKIP() << "no flags in /proc/cpuinfo";
  const auto has = [&](std::initializer_list<const char*> names) {
    return std::all_of(names.begin(), names.end(), [&](const char* name) { return flags.contains(name); });
  };
  const bool runs_v3 = has({"avx2", "fma", "bmi2"});
  const bool runs_v4 = runs_v3 && has({"avx512f", "avx512dq", "avx512bw", "avx512vl", "avx512cd"});
  EXPECT_STREQ(cpu_levels().back(), runs_v4 ? "x86-64-v4" : runs_v3 ? "x86-64-v3" : "baseline");
  EXPECT_EQ(depth_kernels().size(), cpu_levels().size());
  EXPECT_EQ(&depth_kernel(), &depth_kernels().back());
}

}  // namespace
}  // namespace lamella::span
