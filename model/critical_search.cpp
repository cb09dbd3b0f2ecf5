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

/// The gradient and the second derivatives at a place along the latter's own axes.
struct Principal {
  Vec2 axes[2];
  double slope[2];
  double bend[2];

  explicit Principal(const HeightJet& jet) {
    const double mean = 0.5 * (jet.uu + jet.vv);
    const double half = 0.5 * (jet.uu - jet.vv);
    const double radius = std::hypot(half, jet.uv);
    const double angle = 0.5 * std::atan2(jet.uv, half);
    axes[0] = {std::cos(angle), std::sin(angle)};
    axes[1] = {-std::sin(angle), std::cos(angle)};
    bend[0] = mean + radius;
    bend[1] = mean - radius;
    for (const int k : {0, 1}) slope[k] = axes[k].dot(Vec2(jet.u, jet.v));
  }

  /// No place of the cell, of which this is the middle, is stationary: up to |d| <= 1/2 away in u and in v the slope
  /// along an axis differs by bend axis . d, at most 0.71 |bend|, and D^3 z[axis, d, d] / 2, at most third / 8.
  [[nodiscard]] bool excludes_stationary(double third, double slack) const {
    const auto clear = [&](int k) { return std::abs(slope[k]) > 0.71 * std::abs(bend[k]) + 0.125 * third + slack; };
    return clear(0) || clear(1);
  }

  /// The gradient takes no value twice: each second derivative along the axes differs by D^3 z[axis, axis, d] at most,
  /// so the matrices of has_one_to_one_gradient() have a dominant diagonal.
  [[nodiscard]] bool is_one_to_one(double third) const {
    return std::abs(bend[0]) > third && std::abs(bend[1]) > third;
  }

  /// Bound of the difference of height between this place, if stationary, and others in the cell. From one to the other
  /// the height changes by the integral of its slope, by the trapezoidal rule at most D^3 z[d, d, d] / 12. As the slope
  /// along the axis of the larger bend vanishes at both, d goes along that axis by no more than any / (2 |bend|), and
  /// along the other by sqrt(2).
  [[nodiscard]] double spread_on_line(const ThirdDerivatives& third) const {
    const int steep = std::abs(bend[0]) >= std::abs(bend[1]) ? 0 : 1;
    const double aside = 0.5 * third.any / std::abs(bend[steep]);
    if (!(aside < 1.0)) return third.any / 12.0;
    const double mixed = aside * (6.0 + aside * (4.25 + aside));
    return std::min(third.any, 2.83 * third.along(axes[1 - steep]) + mixed * third.any) / 12.0;
  }
};

/// mm: what the heights of stationary places in a cell may differ by to have one level; half of what levels promise, as
/// the gradient at the one found needn't be quite zero.
constexpr double kLineSpread = 0.5 * kLevelAccuracy;

/// Share of the larger bend below which the other counts as none.
constexpr double kStraight = 1e-4;

/// A stationary place of the height in a net's own parameters.
struct Landing {
  Vec2 local;
  HeightJet jet;
  bool isolated = false;  ///< the last step went along both axes
};

/// How Newton's method goes about it. It leaves alone axes whose bend is at most `share` of the other's, or at most
/// `least`: with zeros it finds isolated points only, with more also places on lines of points.
struct LandingOptions {
  double rounding = 0.0;  ///< mm, of slopes
  double share = 0.0;
  double least = 0.0;
  int max_steps = 12;
};

/// Newton's method from the middle of a net.
std::optional<Landing> land(const NetShape& shape, const double* net, const LandingOptions& options) {
  Landing landing{{0.5, 0.5}, {}, false};
  for (int i = 0; i < options.max_steps; ++i) {
    landing.jet = evaluate_jet(shape, net, landing.local[0], landing.local[1]);
    const Principal at(landing.jet);
    const double least = std::max(options.share * std::max(std::abs(at.bend[0]), std::abs(at.bend[1])), options.least);
    bool arrived = true;
    double idle = 0.0;
    landing.isolated = true;
    for (const int k : {0, 1}) {
      if (std::abs(at.bend[k]) > least) {
        landing.local -= at.slope[k] / at.bend[k] * at.axes[k];
        arrived = arrived && std::abs(at.slope[k]) <= 1e-10 * std::abs(at.bend[k]) + options.rounding;
      } else {
        idle = at.slope[k];
        landing.isolated = false;
      }
    }
    if (!((landing.local.array() - 0.5).abs().maxCoeff() < 1.0)) return std::nullopt;  // also what isn't a number
    if (!arrived) continue;
    if (std::abs(idle) <= 1e-2 * kLevelAccuracy) return landing;
    return std::nullopt;
  }
  return std::nullopt;
}

/// A place beyond the net is another's, unless rounding alone put it there.
bool is_within(const Landing& landing) { return (landing.local.array() - 0.5).abs().maxCoeff() <= 0.5 + 1e-7; }

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
    add_degenerate();
    return boxes;
  }

 private:
  /// A stationary place in a cell too small to tell more about it.
  struct Degenerate {
    Vec2 place;
    Vec2 size;
  };

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
    isolated_.clear();
    degenerate_.clear();
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
    const Principal middle(evaluate_jet(shape_, last, 0.5, 0.5));
    const ThirdDerivatives third = third_derivatives(shape_, last, range_);
    if (middle.excludes_stationary(third.any, slack_)) return false;
    if (middle.is_one_to_one(third.any + 1e3 * rounding_) || has_one_to_one_gradient(shape_, last, range_, rounding_)) {
      const std::optional<Landing> landing = land(shape_, last, {rounding_});
      if (landing && is_within(*landing)) {
        isolated_.push_back(cell.at(landing->local));
        collector_.add_near(to_surface(isolated_.back()));
        return false;
      }
    }
    if (middle.spread_on_line(third) <= 2.0 * kLineSpread && lies_on_line(last, third)) return false;
    const bool small = !(range_.length() > kLevelAccuracy) || std::min(cell.u.length(), cell.v.length()) < 1e-13;
    if (small) leave(cell, last);
    return !small;
  }

  /// One place on a line of stationary places stands for all those in the cell.
  bool lies_on_line(const double* last, const ThirdDerivatives& third) {
    // Only along axes whose bend is certain; along others the way would be anywhere.
    const std::optional<Landing> landing = land(shape_, last, {rounding_, kStraight, third.any});
    if (!landing || landing->isolated || !is_within(*landing)) return false;
    const Principal at(landing->jet);
    const double less = std::min(std::abs(at.bend[0]), std::abs(at.bend[1]));
    const double more = std::max(std::abs(at.bend[0]), std::abs(at.bend[1]));
    if (less > kStraight * more || !(at.spread_on_line(third) <= kLineSpread)) return false;
    collector_.add_level(reference_ + landing->jet.value);
    return true;
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
    const std::optional<Landing> landing = land(shape_, last, {rounding_, kStraight, 0.0, 50});
    if (!landing) return collector_.add_level(reference_ + height_range(shape_, last).middle(), false);
    collector_.add_level(reference_ + landing->jet.value);
    const Vec2 size(cell.u.length(), cell.v.length());
    // Long cells are what is left along lines.
    if (landing->isolated && size.maxCoeff() < 0.1) degenerate_.push_back({cell.at(landing->local), size});
  }

  /// Around a point without curvature several cells are left, from which Newton's method lands less exactly.
  void add_degenerate() {
    for (const Degenerate& point : degenerate_) {
      const auto near = [&](const Vec2& other) {
        return ((other - point.place).cwiseAbs().array() <= point.size.array()).all();
      };
      if (std::any_of(isolated_.begin(), isolated_.end(), near)) continue;
      isolated_.push_back(point.place);
      const Vec2 half = 0.5 * point.size;
      const Vec2 uv = to_surface(point.place);
      const Vec2 radius = to_surface(point.place + half) - to_surface(point.place - half);
      collector_.add_point(uv, kind_of(look_around(collector_.surface(), uv, radius)));
    }
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
  std::vector<double> nets_;    ///< one after the other, as the cells
  std::vector<Vec2> isolated_;  ///< places in the patch's unit square
  std::vector<Degenerate> degenerate_;
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
