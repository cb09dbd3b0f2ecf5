#include "slicing/orient/orientations.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <tuple>

#include "core/parallel.h"
#include "slicing/orient/sphere.h"

namespace lamella {

namespace {

const double kSame = std::cos(0.05 / 180.0 * kPi);  ///< directions nearer than this are one
const double kNear = std::cos(5.0 / 180.0 * kPi);

/// mm: sides may exceed the room by rounding.
constexpr double kRoomSlack = 1e-9;

struct Direction {
  Vec3 up;
  std::string origin;
};

class Finder {
 public:
  Finder(const OrientationJudge& judge, const SupportFunction& support, const OrientationWishes& wishes,
         const Progress& progress, int threads)
      : judge_(judge),
        support_(support),
        wishes_(wishes),
        progress_(progress),
        threads_(threads),
        points_(judge.outline_points()) {}

  Orientations run(const LeastWidth& least, const std::optional<AxisScanResult>& scan) {
    list_directions(least, scan);
    std::vector<OrientationCandidate> found = judge_all();
    if (wishes_.down.empty()) refine(found);
    result_.candidates = choose(std::move(found));
    for (OrientationCandidate& one : result_.candidates) one.support_error = judge_.support_error(one.up);
    return std::move(result_);
  }

 private:
  void add(const Vec3& up, const char* origin) {
    const bool is_new =
        std::none_of(directions_.begin(), directions_.end(), [&](const Direction& d) { return d.up.dot(up) > kSame; });
    if (is_new) directions_.push_back({up, origin});
  }

  void list_directions(const LeastWidth& least, const std::optional<AxisScanResult>& scan) {
    if (!wishes_.down.empty()) {
      for (const Vec3& normal : wishes_.down) add(-normal, "named face down");
      return;
    }
    // The first of those that are the same keeps its name: the proved one.
    add(least.direction, "least height");
    add(-least.direction, "least height");
    if (scan) {
      const Vec3 up = scan->turn.row(2).transpose().normalized();
      add(up, "axis scheme");
      add(-up, "axis scheme");
    }
    add(Vec3::UnitZ(), "as it is");
    for (const Vec3& axis : {Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {
      add(axis, "along an axis");
      add(-axis, "along an axis");
    }
    for (const Vec3& normal : large_planes()) add(-normal, "plane face down");
    constexpr std::size_t kMinima = 12;
    for (std::size_t i = 0; i < std::min(kMinima, least.minima.size()); ++i) {
      add(least.minima[i], "low height");
      add(-least.minima[i], "low height");
    }
    for (const Vec3& up : half_sphere(3)) {
      add(up, "direction");
      add(-up, "direction");
    }
  }

  /// Normals of the faces with the largest areas, equal ones taken together.
  [[nodiscard]] std::vector<Vec3> large_planes() const {
    constexpr std::size_t kMost = 40;
    std::vector<std::pair<double, Vec3>> sums;
    for (const auto& [normal, area] : judge_.plane_areas()) {
      const auto same =
          std::find_if(sums.begin(), sums.end(), [&, n = normal](const auto& s) { return s.second.dot(n) > kSame; });
      if (same != sums.end()) {
        same->first += area;
      } else if (sums.size() < 2000) {
        sums.emplace_back(area, normal);
      }
    }
    std::stable_sort(sums.begin(), sums.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Vec3> normals;
    for (const auto& [area, normal] : sums) {
      if (normals.size() == kMost) break;
      normals.push_back(normal);
    }
    return normals;
  }

  [[nodiscard]] OrientationCandidate judged(const Vec3& up, const std::string& origin) const {
    OrientationCandidate one;
    one.up = up;
    one.origin = origin;
    one.figures = judge_.judge(up);
    one.score = score_of(one.figures, judge_.scale(), wishes_.weights);
    one.is_free = !(one.figures.touched_area > 0.0);
    if (wishes_.room) place(one);
    return one;
  }

  void place(OrientationCandidate& one) const {
    std::optional<Vec2> room;
    if (wishes_.room) room = wishes_.room->head<2>();
    one.lying = lay_down(support_, points_, one.up, room);
    one.fits = !wishes_.room || ((*wishes_.room - one.lying.size).array() >= -kRoomSlack).all();
  }

  std::vector<OrientationCandidate> judge_all() {
    std::vector<OrientationCandidate> found(directions_.size());
    std::atomic<std::size_t> done{0};
    parallel_for(
        directions_.size(),
        [&](std::size_t i) {
          progress_.throw_if_cancelled();
          found[i] = judged(directions_[i].up, directions_[i].origin);
          progress_.report("judging orientations", static_cast<double>(++done) / static_cast<double>(found.size()));
        },
        threads_);
    result_.tried += found.size();
    std::stable_sort(found.begin(), found.end(), is_better);
    return found;
  }

  static bool is_better(const OrientationCandidate& a, const OrientationCandidate& b) {
    // Heights of a direction and its opposite are equal but for rounding: then the one with less support is better.
    constexpr double kEqual = 1e-9;
    const auto rank = [](const OrientationCandidate& one) {
      return std::tuple(!one.is_free, !one.fits, std::round(one.score / kEqual), one.figures.support_volume);
    };
    return rank(a) < rank(b);
  }

  /// Height alone has its proved optimum. Any other score is followed downhill from a few places, in smaller and
  /// smaller steps.
  void refine(std::vector<OrientationCandidate>& found) {
    if (wishes_.weights.height + wishes_.weights.layers >= wishes_.weights.sum()) return;
    constexpr std::size_t kStarts = 4;
    std::vector<OrientationCandidate> best = choose_apart(found, kStarts);
    for (std::size_t i = 0; i < best.size(); ++i) {
      const OrientationCandidate start = best[i];
      progress_.report("refining orientations", static_cast<double>(i) / static_cast<double>(best.size()));
      climb_down(best[i]);
      if (is_better(best[i], start)) found.push_back(best[i]);
    }
    std::stable_sort(found.begin(), found.end(), is_better);
  }

  void climb_down(OrientationCandidate& best) {
    for (double step = 6.0 / 180.0 * kPi; step > 0.1 / 180.0 * kPi;) {
      progress_.throw_if_cancelled();
      const Mat3 axes = turn_upright(best.up);
      std::array<OrientationCandidate, 4> tries;
      parallel_for(
          tries.size(),
          [&](std::size_t i) {
            const Vec3 way = (i % 2 == 0 ? 1.0 : -1.0) * axes.row(i / 2).transpose();
            tries[i] = judged((best.up + std::tan(step) * way).normalized(), "refined");
          },
          threads_);
      result_.tried += tries.size();
      const auto next = std::min_element(tries.begin(), tries.end(), is_better);
      // Less than 0.5 % is within what the samples' columns make of support when they are turned a little.
      constexpr double kGain = 0.995;
      const bool is_gain =
          (next->is_free && !best.is_free) || (next->fits && !best.fits) || next->score < kGain * best.score;
      if (is_gain && is_better(*next, best)) {
        best = *next;
      } else {
        step *= 0.5;
      }
    }
  }

  /// The best ones, no two nearer than 5 degrees.
  static std::vector<OrientationCandidate> choose_apart(const std::vector<OrientationCandidate>& sorted,
                                                        std::size_t count) {
    std::vector<OrientationCandidate> chosen;
    for (const OrientationCandidate& one : sorted) {
      if (chosen.size() >= count) break;
      const bool is_apart = std::none_of(chosen.begin(), chosen.end(),
                                         [&](const OrientationCandidate& c) { return c.up.dot(one.up) > kNear; });
      if (is_apart) chosen.push_back(one);
    }
    return chosen;
  }

  std::vector<OrientationCandidate> choose(const std::vector<OrientationCandidate>& sorted) const {
    std::vector<OrientationCandidate> chosen = choose_apart(sorted, wishes_.count);
    for (OrientationCandidate& one : chosen) place(one);
    return chosen;
  }

  const OrientationJudge& judge_;
  const SupportFunction& support_;
  const OrientationWishes& wishes_;
  const Progress& progress_;
  int threads_;
  std::vector<Vec3> points_;
  std::vector<Direction> directions_;
  Orientations result_;
};

}  // namespace

double score_of(const OrientationFigures& figures, const OrientationFigures& scale, const OrientationWeights& weights) {
  double score = weights.height * figures.height / scale.height;
  score += weights.layers * static_cast<double>(figures.layers) / static_cast<double>(scale.layers);
  score += weights.support_area * figures.support_area / scale.support_area;
  score += weights.support_volume * figures.support_volume / scale.support_volume;
  score += weights.cusp * figures.cusp_error / scale.cusp_error;
  score += weights.contact * std::max(0.0, 1.0 - figures.contact_area / scale.contact_area);
  score += weights.tool_changes * static_cast<double>(figures.tool_changes) / static_cast<double>(scale.tool_changes);
  return score / weights.sum();
}

Orientations find_orientations(const OrientationJudge& judge, const SupportFunction& support, const LeastWidth& least,
                               const std::optional<AxisScanResult>& scan, const OrientationWishes& wishes,
                               const Progress& progress, int threads) {
  return Finder(judge, support, wishes, progress, threads).run(least, scan);
}

}  // namespace lamella
