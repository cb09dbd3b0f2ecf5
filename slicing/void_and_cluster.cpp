#include "slicing/void_and_cluster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace lamella {
namespace {

constexpr int kSide = kTorusSide;
constexpr int kWrap = kSide - 1;
constexpr int kRows = kSide * kSide;
constexpr int kVoxels = kRows * kSide;

/// Points of the pattern that the ranking starts from: few enough for all of them to be moved to where they lie evenly.
constexpr int kStart = kVoxels / 16;

/// Energies are integers, so that taking a point away undoes its adding exactly and no order of sums matters. All
/// points together give kFull everywhere; kTaken lifts the voxels with a point above all others.
constexpr double kFull = 1 << 29;
constexpr std::int32_t kTaken = 1 << 30;

/// Rows of the kernel whose peak is less than this part of the kernel's own are left out: 3.7 standard deviations.
constexpr double kCutOff = 1e-3;

/// Standard deviation of the kernel over the mean spacing of the rarer kind of voxel. Ulichney's 1.5 pixels in the
/// plane are 1.06 spacings at 1/2 and 0.47 at 1/10; docs/methods/dithering.md has what was tried.
constexpr double kSpread = 0.65;

/// Peak of the plane kernels over that of the kernel in space: each of a point's three axial planes gets one, so that
/// single layers are spread evenly too, which a section of an even pattern in space need not be.
constexpr double kSlice = 0.1;

/// What a point adds to every voxel of its three axial planes, over the kernel's peak. It keeps the counts of planes
/// within about one point of one another, and so the means of gradients along an axis.
constexpr double kPlane = 0.1;

/// Bits without order for breaking ties (Steele, Lea and Flood, Fast splittable pseudorandom number generators, 2014).
std::uint64_t mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15U;
  x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27U)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31U);
}

using Profile = std::array<double, kSide>;

/// A gaussian along one axis, wound around the torus.
Profile wind_gaussian(double sigma, double pitch) {
  Profile profile{};
  if (pitch == 0.0) return profile[0] = 1.0, profile;
  const int reach = static_cast<int>(std::ceil(6.0 * sigma / pitch));
  for (int d = -reach; d <= reach; ++d) {
    const double t = d * pitch / sigma;
    profile[static_cast<std::size_t>(d & kWrap)] += std::exp(-0.5 * t * t);
  }
  return profile;
}

/// What a point does to one row of voxels.
struct KernelRow {
  int dy = 0;
  int dz = 0;
  std::array<std::int32_t, 2 * kSide> weights{};  ///< by x - x of the point + kSide
};

struct Kernel {
  std::vector<KernelRow> rows;
  std::int32_t plane = 0;  ///< what a point adds to all voxels of each of the three planes that it is in
};

/// A gaussian on the torus or, along axes of pitch 0, on the planes where these are 0.
class Gaussian {
 public:
  Gaussian(double sigma, const Vec3& pitch)
      : x_(wind_gaussian(sigma, pitch.x())), y_(wind_gaussian(sigma, pitch.y())), z_(wind_gaussian(sigma, pitch.z())) {}
  [[nodiscard]] double at(int x, int y, int z) const { return x_[x] * y_[y] * z_[z]; }

 private:
  Profile x_;
  Profile y_;
  Profile z_;
};

/// Weights by x, y, z of the kernel for a pattern in which one voxel of 2^octave is of the rarer kind.
std::vector<double> sum_gaussians(int octave, const Vec3& pitch) {
  const double sparsity = std::exp2(octave + 0.5);
  const double widest = 0.25 * kSide * pitch.maxCoeff();  // wider on a torus this small tells nothing apart
  const double sigma = kSpread * std::min(widest, std::cbrt(pitch.prod() * sparsity));
  std::vector<double> weights(kVoxels);
  const auto add = [&](double factor, const Gaussian& gaussian) {
    for (int v = 0; v < kVoxels; ++v) {
      weights[v] += factor * gaussian.at(v % kSide, v / kSide % kSide, v / kRows);
    }
  };
  add(1.0, Gaussian(sigma, pitch));
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 in_plane = pitch;
    in_plane[axis] = 0.0;
    const double area = pitch.prod() / pitch[axis];
    add(kSlice, Gaussian(kSpread * std::min(widest, std::sqrt(area * sparsity)), in_plane));
  }
  return weights;
}

Kernel make_kernel(int octave, const Vec3& pitch) {
  const std::vector<double> weights = sum_gaussians(octave, pitch);
  const double total = std::accumulate(weights.begin(), weights.end(), 3.0 * kRows * kPlane);
  const double scale = kFull / total;
  Kernel kernel{{}, static_cast<std::int32_t>(std::lround(scale * kPlane))};
  for (int row = 0; row < kRows; ++row) {
    const double* const from = weights.data() + row * kSide;
    if (*std::max_element(from, from + kSide) < kCutOff) continue;
    KernelRow out{row % kSide, row / kSide, {}};
    for (int i = 0; i < 2 * kSide; ++i) {
      out.weights[i] = static_cast<std::int32_t>(std::lround(scale * from[i & kWrap]));
    }
    kernel.rows.push_back(out);
  }
  return kernel;
}

/// Points on the torus and the energy that they give every voxel.
class Pattern {
 public:
  explicit Pattern(const Vec3& pitch) : pitch_(pitch) { energy_.resize(kVoxels); }

  [[nodiscard]] bool holds(int voxel) const { return energy_[voxel] >= kTaken / 4 * 3; }
  [[nodiscard]] int size() const { return static_cast<int>(points_.size()); }

  void add(int voxel);
  void remove(int voxel);
  /// The empty voxel of least energy.
  [[nodiscard]] int find_void() const;
  /// The point of greatest energy. Looks at all of them.
  [[nodiscard]] int find_cluster() const;
  /// Fits the kernel to how many points there are now. Cheap unless that has halved or doubled.
  void fit_kernel();

 private:
  void spread(int voxel, std::int32_t sign);
  void lift_planes(int voxel, std::int32_t by);
  void update_least(int row);

  Vec3 pitch_;
  std::vector<int> points_;
  int octave_ = -1;  ///< of the rarer kind's count, that the kernel was made for
  Kernel kernel_;
  std::vector<std::int32_t> energy_;
  std::array<std::int32_t, kSide> planes_y_{};  ///< energy to add, by y
  std::array<std::int32_t, kSide> planes_z_{};  ///< energy to add, by z
  std::array<std::int32_t, kRows> least_{};     ///< of energy_, by row
};

void Pattern::add(int voxel) {
  energy_[voxel] += kTaken;
  spread(voxel, 1);
  points_.push_back(voxel);
}

void Pattern::remove(int voxel) {
  energy_[voxel] -= kTaken;
  spread(voxel, -1);
  *std::find(points_.begin(), points_.end(), voxel) = points_.back();
  points_.pop_back();
}

void Pattern::spread(int voxel, std::int32_t sign) {
  const int x = voxel % kSide;
  const int y = voxel / kSide % kSide;
  const int z = voxel / kRows;
  for (const KernelRow& from : kernel_.rows) {
    const int row = ((z + from.dz) & kWrap) * kSide + ((y + from.dy) & kWrap);
    std::int32_t* const energy = energy_.data() + row * kSide;
    const std::int32_t* const weights = from.weights.data() + kSide - x;
    const std::int32_t flip = sign >> 31;  // w ^ -1 - -1 is -w
    for (int i = 0; i < kSide; ++i) energy[i] += (weights[i] ^ flip) - flip;
    update_least(row);
  }
  lift_planes(voxel, sign * kernel_.plane);
}

void Pattern::lift_planes(int voxel, std::int32_t by) {
  planes_y_[voxel / kSide % kSide] += by;
  planes_z_[voxel / kRows] += by;
  for (int row = 0; row < kRows; ++row) {
    std::int32_t& energy = energy_[row * kSide + voxel % kSide];
    const std::int32_t old = energy;
    energy += by;
    if (old == least_[row] || energy < least_[row]) update_least(row);
  }
}

void Pattern::update_least(int row) {
  const std::int32_t* const energy = energy_.data() + row * kSide;
  std::int32_t least = energy[0];
  for (int i = 1; i < kSide; ++i) least = std::min(least, energy[i]);
  least_[row] = least;
}

int Pattern::find_void() const {
  int best = 0;
  std::int32_t least = std::numeric_limits<std::int32_t>::max();
  for (int row = 0; row < kRows; ++row) {
    const std::int32_t energy = least_[row] + planes_y_[row % kSide] + planes_z_[row / kSide];
    if (energy < least) least = energy, best = row;
  }
  const auto begin = energy_.begin() + best * kSide;
  return static_cast<int>(std::find(begin, begin + kSide, least_[best]) - energy_.begin());
}

int Pattern::find_cluster() const {
  const auto energy = [this](int v) { return energy_[v] + planes_y_[v / kSide % kSide] + planes_z_[v / kRows]; };
  return *std::max_element(points_.begin(), points_.end(), [&](int a, int b) { return energy(a) < energy(b); });
}

void Pattern::fit_kernel() {
  const int rarer = std::max(1, std::min(size(), kVoxels - size()));
  int octave = 1;
  while (kVoxels >> (octave + 1) >= rarer) ++octave;
  if (octave == octave_) return;
  octave_ = octave;
  kernel_ = make_kernel(octave, pitch_);
  // Energies of all points are those of a full torus less those of the empty voxels: the rarer kind is added up.
  const bool sparse = size() <= kVoxels / 2;
  std::vector<int> rare;
  for (int v = 0; v < kVoxels; ++v) {
    const bool taken = holds(v);
    if (taken == sparse) rare.push_back(v);
    const auto tie = static_cast<std::int32_t>(mix(static_cast<std::uint64_t>(v)) & 0xffU);
    energy_[v] = (taken ? kTaken : 0) + (sparse ? 0 : static_cast<std::int32_t>(kFull)) + tie;
  }
  planes_y_.fill(0);
  planes_z_.fill(0);
  for (int row = 0; row < kRows; ++row) update_least(row);
  for (const int v : rare) spread(v, sparse ? 1 : -1);
}

/// kStart points without order, moved from the tightest clusters to the largest voids until that changes nothing.
void start(Pattern& pattern) {
  std::vector<std::uint64_t> order(kVoxels);  // bits without order above, the voxel below
  for (int v = 0; v < kVoxels; ++v) {
    order[v] = (mix(static_cast<std::uint64_t>(v + kVoxels)) & ~0xffffULL) | static_cast<std::uint64_t>(v);
  }
  std::nth_element(order.begin(), order.begin() + kStart, order.end());
  std::sort(order.begin(), order.begin() + kStart);
  for (int n = 0; n < kStart; ++n) {
    pattern.fit_kernel();
    pattern.add(static_cast<int>(order[n] & 0xffffU));
  }
  pattern.fit_kernel();
  for (int moves = 0; moves < kVoxels; ++moves) {
    const int cluster = pattern.find_cluster();
    pattern.remove(cluster);
    const int empty = pattern.find_void();
    pattern.add(empty);
    if (empty == cluster) break;
  }
}

bool is_usable(const Vec3& pitch) {
  return pitch.allFinite() && pitch.minCoeff() > 0.0 && pitch.maxCoeff() <= 100.0 * pitch.minCoeff();
}

}  // namespace

std::vector<std::uint16_t> void_and_cluster(const Vec3& pitch) {
  if (!is_usable(pitch)) throw std::invalid_argument("void_and_cluster: the pitch is not positive or too uneven");
  Pattern pattern(pitch / pitch.minCoeff());
  start(pattern);
  std::vector<std::uint16_t> ranks(kVoxels);
  // Both halves go on from the same start: down by taking away clusters, up by filling voids.
  Pattern fewer = pattern;
  while (fewer.size() > 0) {
    fewer.fit_kernel();
    const int cluster = fewer.find_cluster();
    fewer.remove(cluster);
    ranks[cluster] = static_cast<std::uint16_t>(fewer.size());
  }
  while (pattern.size() < kVoxels) {
    pattern.fit_kernel();
    const int empty = pattern.find_void();
    ranks[empty] = static_cast<std::uint16_t>(pattern.size());
    pattern.add(empty);
  }
  return ranks;
}

}  // namespace lamella
