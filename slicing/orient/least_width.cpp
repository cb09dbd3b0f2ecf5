#include "slicing/orient/least_width.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <queue>

#include "slicing/orient/matrix_game.h"
#include "slicing/orient/sphere.h"

namespace lamella {

namespace {

using Points = std::vector<std::uint32_t>;

/// A triangle of directions, and which of the known points can be furthest somewhere in it.
struct Cell {
  std::array<Vec3, 3> corners;  ///< unit vectors
  Points high;                  ///< candidates for the furthest along a direction
  Points low;                   ///< and for the furthest against it
  double bound = 0.0;           ///< no direction inside has less height

  [[nodiscard]] Vec3 at(const Vec3& weights) const {
    return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  }
  bool operator<(const Cell& other) const { return bound > other.bound; }
};

class Search {
 public:
  Search(const SupportFunction& support, const LeastWidthLimits& limits, const Progress& progress)
      : support_(support), limits_(limits), progress_(progress), points_(support.points()) {}

  LeastWidth run(const std::vector<Vec3>& known) {
    for (const Vec3& direction : known) measure(direction);
    for (const Vec3& direction : half_sphere(2)) measure(direction);
    start();
    double pruned = std::numeric_limits<double>::infinity();
    while (!open_.empty() && result_.cells < limits_.max_cells) {
      if (result_.cells % 64 == 0) tell();
      if (!(open_.top().bound < enough())) break;
      Cell cell = open_.top();
      open_.pop();
      bound(cell);
      if (cell.bound < enough()) {
        divide(cell);
      } else {
        pruned = std::min(pruned, cell.bound);
      }
    }
    if (!open_.empty()) pruned = std::min(pruned, open_.top().bound);
    result_.proved = std::max(0.0, std::min(pruned, result_.height));
    result_.accuracy = support_.accuracy();
    result_.minima = spread(std::move(minima_));
    return result_;
  }

 private:
  struct Minimum {
    double height;
    Vec3 direction;
  };

  [[nodiscard]] double enough() const { return result_.height * (1.0 - limits_.gap); }

  void tell() {
    progress_.throw_if_cancelled();
    if (open_.empty() || !(result_.height > 0.0)) return;
    // Every quartering of the triangles cuts the gap to a quarter.
    const double gap = std::max((result_.height - open_.top().bound) / result_.height, limits_.gap);
    progress_.report("finding the least height", std::log(gap) / std::log(limits_.gap));
  }

  /// The exact height along a direction of any length; keeps the points found and the lowest height.
  void measure(const Vec3& x, Points* high = nullptr, Points* low = nullptr) {
    const Vec3 direction = x.normalized();
    const Reach up = support_(direction);
    const Reach down = support_(-direction);
    ++result_.heights;
    result_.converged = result_.converged && up.converged && down.converged;
    for (const Reach* reach : {&up, &down}) {
      Points* list = reach == &up ? high : low;
      if (list != nullptr) list->push_back(static_cast<std::uint32_t>(points_.size()));
      points_.push_back(reach->point);
    }
    const double height = up.value + down.value;
    minima_.push_back({height, direction});
    // Known directions come first and keep their place against what is lower by rounding.
    constexpr double kGain = 1e-13;
    if (result_.heights > 1 && !(height < result_.height * (1.0 - kGain))) return;
    result_.height = height;
    result_.direction = direction;
  }

  void start() {
    // Heights of d and -d are equal: half of an octahedron is enough.
    const Vec3 x = Vec3::UnitX();
    const Vec3 y = Vec3::UnitY();
    const Vec3 z = Vec3::UnitZ();
    Points all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint32_t>(i);
    for (const auto& [a, b] : {std::pair<Vec3, Vec3>{x, y}, {y, -x}, {-x, -y}, {-y, x}}) {
      open_.push({{a, b, z}, all, all, 0.0});
    }
  }

  [[nodiscard]] std::uint32_t furthest(const Points& list, const Vec3& x) const {
    std::uint32_t best = list.front();
    double reach = x.dot(points_[best]);
    for (const std::uint32_t i : list) {
      const double value = x.dot(points_[i]);
      if (value > reach) {
        reach = value;
        best = i;
      }
    }
    return best;
  }

  [[nodiscard]] Vec3 values(const Cell& cell, std::uint32_t high, std::uint32_t low) const {
    const Vec3 difference = points_[high] - points_[low];
    return {difference.dot(cell.corners[0]), difference.dot(cell.corners[1]), difference.dot(cell.corners[2])};
  }

  /// Leaves out points that another one exceeds at all three corners, and so in the whole triangle.
  void thin_out(const Cell& cell, double sign, Points& list) const {
    const auto corner_values = [&](std::uint32_t i) {
      return Vec3(sign * Vec3(cell.corners[0].dot(points_[i]), cell.corners[1].dot(points_[i]),
                              cell.corners[2].dot(points_[i])));
    };
    std::array<Vec3, 4> leaders;
    std::array<std::uint32_t, 4> keep{};
    for (int k = 0; k < 4; ++k) {
      const Vec3 x = k < 3 ? cell.corners[k] : cell.at(Vec3::Constant(1.0 / 3.0));
      keep[k] = furthest(list, sign * x);
      leaders[k] = corner_values(keep[k]);
    }
    std::erase_if(list, [&](std::uint32_t i) {
      if (std::find(keep.begin(), keep.end(), i) != keep.end()) return false;
      const Vec3 own = corner_values(i);
      return std::any_of(leaders.begin(), leaders.end(),
                         [&](const Vec3& v) { return (own.array() <= v.array()).all(); });
    });
  }

  /// The height, taken along x as it is, is convex over the plane triangle of the corners, and |x| <= 1 there: what is
  /// least on it is a bound for the directions inside. Pieces come from points known, then from exact heights.
  void bound(Cell& cell) {
    ++result_.cells;
    thin_out(cell, 1.0, cell.high);
    thin_out(cell, -1.0, cell.low);
    const Vec3 middle = cell.at(Vec3::Constant(1.0 / 3.0));
    MatrixGame game(values(cell, furthest(cell.high, middle), furthest(cell.low, -middle)));
    const double rounding = 1e-13 * support_.bounds().diagonal().norm();
    bool is_exact = false;
    // Each round adds a piece; on smooth parts they never end, and the triangle is halved instead.
    for (int round = 0; round < 40; ++round) {
      if (game.bound() >= enough()) break;
      const Vec3 x = cell.at(game.place());
      const Vec3 piece = values(cell, furthest(cell.high, x), furthest(cell.low, -x));
      if (piece.dot(game.place()) > game.value() + rounding && game.add(piece)) continue;
      if (is_exact) break;
      measure(x, &cell.high, &cell.low);
      is_exact = round > 24 || !improves(game, cell, x, rounding);
    }
    cell.bound = std::max(cell.bound, game.bound());
  }

  [[nodiscard]] bool improves(const MatrixGame& game, const Cell& cell, const Vec3& x, double rounding) const {
    // Less than a tenth of what halving the triangle will bring isn't worth an exact height.
    const double worth = std::max(rounding, 0.1 * result_.height * (1.0 - x.norm()));
    return (points_[cell.high.back()] - points_[cell.low.back()]).dot(x) > game.value() + worth;
  }

  void divide(const Cell& cell) {
    int longest = 0;
    double length = -1.0;
    for (int i = 0; i < 3; ++i) {
      const double l = (cell.corners[i] - cell.corners[(i + 1) % 3]).squaredNorm();
      if (l > length) {
        length = l;
        longest = i;
      }
    }
    const Vec3& a = cell.corners[longest];
    const Vec3& b = cell.corners[(longest + 1) % 3];
    const Vec3& c = cell.corners[(longest + 2) % 3];
    const Vec3 middle = (a + b).normalized();
    open_.push({{a, middle, c}, cell.high, cell.low, cell.bound});
    open_.push({{middle, b, c}, cell.high, cell.low, cell.bound});
  }

  /// The lowest of the directions, no two nearer to each other than 5 degrees.
  static std::vector<Vec3> spread(std::vector<Minimum> minima) {
    constexpr std::size_t kMost = 64;
    std::stable_sort(minima.begin(), minima.end(),
                     [](const Minimum& a, const Minimum& b) { return a.height < b.height; });
    const double near = std::cos(5.0 / 180.0 * kPi);
    std::vector<Vec3> kept;
    for (const Minimum& one : minima) {
      const bool is_new =
          std::none_of(kept.begin(), kept.end(), [&](const Vec3& d) { return std::abs(d.dot(one.direction)) > near; });
      if (is_new) kept.push_back(one.direction);
      if (kept.size() == kMost) break;
    }
    return kept;
  }

  const SupportFunction& support_;
  const LeastWidthLimits& limits_;
  const Progress& progress_;
  std::vector<Vec3> points_;  ///< of the solids: what any two of them span is a bound
  std::priority_queue<Cell> open_;
  std::vector<Minimum> minima_;
  LeastWidth result_;
};

}  // namespace

LeastWidth find_least_width(const SupportFunction& support, const LeastWidthLimits& limits,
                            const std::vector<Vec3>& known, const Progress& progress) {
  if (support.points().empty()) return {};
  return Search(support, limits, progress).run(known);
}

}  // namespace lamella
