#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "model/critical_detail.h"
#include "model/height_net.h"

namespace lamella {

namespace {

constexpr int kMaxBoxes = 200000;
/// mm: what is left at a limit is no level if its heights differ by more.
constexpr double kMaxLeftover = 1e-4;

/// A part of a patch; both intervals are parts of [0, 1].
struct Cell {
  Interval u{0.0, 1.0};
  Interval v{0.0, 1.0};

  [[nodiscard]] Vec2 at(const Vec2& local) const {
    return {u.lo + local[0] * u.length(), v.lo + local[1] * v.length()};
  }
};

/// Newton's method for a stationary place near the middle of a net. Directions along which the gradient hardly changes
/// (below `rank` of the largest change) are left alone: 0 for isolated points only, more to land on lines of points.
struct Landing {
  Vec2 local;
  HeightJet jet;
  bool isolated = false;  ///< the last step went along both directions
};

struct Step {
  Vec2 move;
  double idle;  ///< the gradient along directions left alone
  bool full;
};

Step newton_step(const HeightJet& jet, double rank) {
  const double mean = 0.5 * (jet.uu + jet.vv);
  const double half = 0.5 * (jet.uu - jet.vv);
  const double radius = std::hypot(half, jet.uv);
  const double angle = 0.5 * std::atan2(jet.uv, half);
  const double values[2] = {mean + radius, mean - radius};
  const Vec2 axes[2] = {{std::cos(angle), std::sin(angle)}, {-std::sin(angle), std::cos(angle)}};
  const double largest = std::max(std::abs(values[0]), std::abs(values[1]));
  Step step{Vec2::Zero(), 0.0, true};
  for (const int k : {0, 1}) {
    const double along = axes[k].dot(Vec2(jet.u, jet.v));
    if (std::abs(values[k]) > rank * largest) {
      step.move -= along / values[k] * axes[k];
    } else {
      step.idle = along;
      step.full = false;
    }
  }
  return step;
}

std::optional<Landing> land(const NetShape& shape, const double* net, double rank, int max_steps) {
  Landing landing{{0.5, 0.5}, {}, false};
  for (int i = 0; i < max_steps; ++i) {
    landing.jet = evaluate_jet(shape, net, landing.local[0], landing.local[1]);
    const Step step = newton_step(landing.jet, rank);
    landing.local += step.move;
    if (!((landing.local.array() - 0.5).abs().maxCoeff() < 1.0)) return std::nullopt;  // also what isn't a number
    if (step.move.cwiseAbs().maxCoeff() > 1e-10) continue;
    if (!(std::abs(step.idle) <= 1e-2 * kLevelAccuracy)) return std::nullopt;
    landing.isolated = step.full;
    return landing;
  }
  return std::nullopt;
}

class PatchSearch {
 public:
  PatchSearch(const RationalForm& form, double reference, CriticalCollector& collector)
      : form_(form), reference_(reference), collector_(collector) {}

  /// `budget` boxes at most; returns how many were used.
  int run(const BezierPatch& patch, int budget) {
    if (!start(patch)) return 1;
    int boxes = 0;
    while (!cells_.empty()) {
      if (++boxes > budget) {
        leave_rest();
        break;
      }
      if (examine()) {
        divide();
      } else {
        cells_.pop_back();
      }
    }
    return boxes;
  }

 private:
  [[nodiscard]] double* net(std::size_t k) { return nets_.data() + k * shape_.doubles(); }

  /// False if the patch is done with at once.
  bool start(const BezierPatch& patch) {
    patch_ = &patch;
    bool rational = false;
    for (const Vec4& p : patch.net) rational = rational || p[3] != 1.0;
    shape_ = {patch.degree_u, patch.degree_v, rational};
    nets_.resize(shape_.doubles());
    for (std::size_t i = 0; i < shape_.count(); ++i) {
      nets_[i] = patch.net[i][2];
      if (rational) nets_[shape_.count() + i] = patch.net[i][3];
    }
    const Interval range = height_range(shape_, net(0));
    // Differences of the poles carry a few roundings of the poles themselves.
    rounding_ = 4e-15 * std::max(std::abs(range.lo), std::abs(range.hi));
    // Two patches that meet smoothly agree on the slope at their border up to rounding only; with no slack a point on
    // the border could be lost by both.
    slack_ = 10.0 * rounding_ + 1e-11 * range.length() + 1e-12;
    landings_.clear();
    cells_.assign(1, Cell{});
    return !is_horizontal(patch, range);
  }

  /// Horizontal up to the accuracy of levels: whatever its slopes are, they mean nothing.
  bool is_horizontal(const BezierPatch& patch, const Interval& range) {
    if (!(range.length() <= kLevelAccuracy)) return false;
    const Box3 box = control_box(patch);
    if (range.length() > 1e-3 * box.sizes().head<2>().maxCoeff()) return false;
    collector_.add_level(reference_ + range.middle(), false);
    return true;
  }

  /// True if the last cell must be halved.
  bool examine() {
    const Cell cell = cells_.back();
    const double* last = net(cells_.size() - 1);
    range_ = height_range(shape_, last);
    if (keeps_sign(shape_, last, true, range_, slack_) || keeps_sign(shape_, last, false, range_, slack_)) {
      return false;
    }
    if (has_one_to_one_gradient(shape_, last, range_, rounding_)) {
      const std::optional<Landing> landing = land(shape_, last, 0.0, 12);
      // A place beyond the cell is another's, unless rounding alone put it there.
      if (landing && (landing->local.array() - 0.5).abs().maxCoeff() <= 0.5 + 1e-7) {
        collector_.add_near(to_surface(cell.at(landing->local)));
        return false;
      }
    }
    const bool small = !(range_.length() > kLevelAccuracy) || std::min(cell.u.length(), cell.v.length()) < 1e-13;
    if (small) leave(cell, last);
    return !small;
  }

  void divide() {
    const std::size_t k = cells_.size() - 1;
    nets_.resize(std::max(nets_.size(), (k + 2) * shape_.doubles()));
    const bool along_u = varies_more_in_u(shape_, net(k), range_);
    halve(shape_, net(k), net(k + 1), along_u);
    cells_.push_back(cells_.back());
    Interval& first = along_u ? cells_[k].u : cells_[k].v;
    Interval& second = along_u ? cells_[k + 1].u : cells_[k + 1].v;
    first.hi = second.lo = first.middle();
  }

  /// The cell may hold a line of stationary points, or one where second derivatives vanish.
  void leave(const Cell& cell, const double* last) {
    const std::optional<Landing> landing = land(shape_, last, 1e-4, 50);
    if (!landing) return collector_.add_level(reference_ + height_range(shape_, last).middle(), false);
    collector_.add_level(reference_ + landing->jet.value);
    const Vec2 size(cell.u.length(), cell.v.length());
    // Long cells are what is left along lines.
    if (landing->isolated && size.maxCoeff() < 0.1) add_degenerate(cell.at(landing->local), size);
  }

  /// Around a point without curvature several cells are left, from which Newton's method lands less exactly.
  void add_degenerate(const Vec2& place, const Vec2& size) {
    for (const Vec2& other : landings_) {
      if (((other - place).cwiseAbs().array() <= size.array()).all()) return;
    }
    landings_.push_back(place);
    const Vec2 uv = to_surface(place);
    const Vec2 radius = (to_surface(place + 0.5 * size) - to_surface(place - 0.5 * size)).cwiseAbs();
    collector_.add_point(uv, kind_of(look_around(collector_.surface(), uv, radius)));
  }

  void leave_rest() {
    collector_.give_up();
    for (std::size_t k = 0; k < cells_.size(); ++k) {
      const Interval range = height_range(shape_, net(k));
      if (range.length() <= kMaxLeftover) collector_.add_level(reference_ + range.middle(), false);
    }
  }

  [[nodiscard]] Vec2 to_surface(const Vec2& place) const {
    const Vec2 st(patch_->u.lo + place[0] * patch_->u.length(), patch_->v.lo + place[1] * patch_->v.length());
    const Vec2 lo(patch_->u.lo, patch_->v.lo);
    const Vec2 hi(patch_->u.hi, patch_->v.hi);
    return form_.to_surface(st.cwiseMax(lo).cwiseMin(hi));
  }

  const RationalForm& form_;
  double reference_;
  CriticalCollector& collector_;
  const BezierPatch* patch_ = nullptr;
  NetShape shape_;
  double rounding_ = 0.0;  ///< mm
  double slack_ = 0.0;     ///< mm: slopes over a whole cell up to this may be zero
  Interval range_;         ///< of the last cell
  std::vector<Cell> cells_;
  std::vector<double> nets_;  ///< one after the other, as the cells
  std::vector<Vec2> landings_;
};

}  // namespace

void search_patches(const RationalForm& form, double reference, CriticalCollector& collector) {
  PatchSearch search(form, reference, collector);
  int left = kMaxBoxes;
  std::size_t patches_left = form.patches.size();
  for (const BezierPatch& patch : form.patches) {
    // One patch with an area of critical points must not starve all others.
    const int share = left / static_cast<int>(std::min<std::size_t>(4, patches_left--)) + 64;
    left -= std::min(left, search.run(patch, share));
  }
}

}  // namespace lamella
