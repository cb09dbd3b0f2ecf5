#include "slicing/adaptive/thin_places.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <queue>
#include <utility>

#include "model/bezier.h"

namespace lamella {

namespace {

constexpr double kTouch = 1e-9;        // mm
constexpr double kLevelHeight = 1e-6;  // mm: what is no higher is level
/// Parts are looked at until they are no larger than this share of what middles
/// of layers may be apart.
constexpr double kFine = 0.25;
/// Of one face or line: beyond, parts stay coarse.
constexpr std::size_t kMaxParts = 200000;
constexpr std::size_t kMaxPairs = 4000000;

using Part = ThinSearch::Part;

double size_of(const Box3& box) { return box.isEmpty() ? 0.0 : box.sizes().maxCoeff(); }

double gap(const Interval& a, const Interval& b) { return std::max({0.0, a.lo - b.hi, b.lo - a.hi}); }

bool overlap_in_plan(const Box3& a, const Box3& b) {
  return a.min().x() <= b.max().x() && b.min().x() <= a.max().x() && a.min().y() <= b.max().y() &&
         b.min().y() <= a.max().y();
}

/// The part of a patch between parameters, or nothing where it lies outside the
/// trimmed face.
std::optional<Part> part_of(const FaceSlants& face, std::uint32_t index, std::uint32_t patch, const Interval& u,
                            const Interval& v) {
  if (face.is_outside(u, v)) return {};
  Part part{index, patch, u, v, {}, false, false, 1.0};
  part.box = control_box(restrict_to(face.form().patches[patch], u, v));
  // Of rounding, so that what only touches isn't lost.
  const Vec3 touch = Vec3::Constant(kTouch);
  part.box = Box3(part.box.min() - touch, part.box.max() + touch)
                 .intersection(Box3(face.box().min() - touch, face.box().max() + touch));
  if (part.box.isEmpty()) return {};
  const LookRange looks = face.looks_of(patch, u, v);
  part.may_look_up = looks.up;
  part.may_look_down = looks.down;
  part.slant = looks.slant;
  return part;
}

/// Is the patch's part longer along u, by its net's polygons?
bool is_longer_in_u(const FaceSlants& face, const Part& part) {
  const BezierPatch net = restrict_to(face.form().patches[part.patch], part.u, part.v);
  const auto point = [&](int i, int j) -> Vec3 {
    const Vec4& p = net.net[static_cast<std::size_t>(i * (net.degree_v + 1) + j)];
    return p.head<3>() / p[3];
  };
  double in_u = 0.0;
  for (int j = 0; j <= net.degree_v; ++j) {
    double length = 0.0;
    for (int i = 1; i <= net.degree_u; ++i) length += (point(i, j) - point(i - 1, j)).norm();
    in_u = std::max(in_u, length);
  }
  double in_v = 0.0;
  for (int i = 0; i <= net.degree_u; ++i) {
    double length = 0.0;
    for (int j = 1; j <= net.degree_v; ++j) length += (point(i, j) - point(i, j - 1)).norm();
    in_v = std::max(in_v, length);
  }
  return in_u >= in_v;
}

std::vector<Part> halves_of(const FaceSlants& face, const Part& part) {
  std::vector<Part> out;
  const bool along_u = is_longer_in_u(face, part);
  const Interval& whole = along_u ? part.u : part.v;
  for (const Interval& half : {Interval{whole.lo, whole.middle()}, Interval{whole.middle(), whole.hi}}) {
    const auto found = along_u ? part_of(face, part.face, part.patch, half, part.v)
                               : part_of(face, part.face, part.patch, part.u, half);
    if (found) out.push_back(*found);
  }
  return out;
}

/// What may lie above or below, halved as far as it is looked at.
class Partners {
 public:
  Partners(const std::vector<const FaceSlants*>& faces, const std::vector<Part>& patches)
      : faces_(faces), patches_(patches) {}

  std::uint32_t add(const Part& part) {
    nodes_.push_back({part, {}, false});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }
  /// Whole patches, each entered once.
  std::vector<std::uint32_t> add_all(const std::vector<std::size_t>& patches) {
    std::vector<std::uint32_t> out;
    for (const std::size_t patch : patches) {
      const auto [known, is_new] = entered_.try_emplace(patch, 0);
      if (is_new) known->second = add(patches_[patch]);
      out.push_back(known->second);
    }
    return out;
  }
  [[nodiscard]] const Part& part(std::uint32_t node) const { return nodes_[node].part; }
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  const std::vector<std::uint32_t>& halves(std::uint32_t node) {
    if (!nodes_[node].is_halved) {
      std::vector<std::uint32_t> children;
      const Part whole = nodes_[node].part;
      for (const Part& half : halves_of(*faces_[whole.face], whole)) children.push_back(add(half));
      nodes_[node].halves = std::move(children);
      nodes_[node].is_halved = true;
    }
    return nodes_[node].halves;
  }

 private:
  struct Node {
    Part part;
    std::vector<std::uint32_t> halves;
    bool is_halved = false;
  };

  const std::vector<const FaceSlants*>& faces_;
  const std::vector<Part>& patches_;
  std::map<std::size_t, std::uint32_t> entered_;
  std::vector<Node> nodes_;
};

/// What the search needs of a face or a line that it halves.
class Halved {
 public:
  virtual ~Halved() = default;
  [[nodiscard]] virtual bool is_line() const { return false; }
  [[nodiscard]] virtual std::vector<Part> halves(const Part& part) const = 0;
  /// A bound of the slant over a part that costs little.
  [[nodiscard]] virtual double coarse_slant(const Part& part) const { return slant(part); }
  /// Bound of the slant over a part.
  [[nodiscard]] virtual double slant(const Part& part) const = 0;
};

class HalvedFace : public Halved {
 public:
  explicit HalvedFace(const FaceSlants& face) : face_(face) {}
  [[nodiscard]] std::vector<Part> halves(const Part& part) const override { return halves_of(face_, part); }
  [[nodiscard]] double coarse_slant(const Part& part) const override { return part.slant; }
  [[nodiscard]] double slant(const Part& part) const override {
    return std::min(part.slant, face_.largest_slant_of(part.patch, part.u, part.v));
  }

 private:
  const FaceSlants& face_;
};

class HalvedLine : public Halved {
 public:
  explicit HalvedLine(const RidgeLine& line) : line_(line) {}

  [[nodiscard]] bool is_line() const override { return true; }

  /// Nothing where its sides certainly look up and down, or where there is no
  /// line.
  [[nodiscard]] std::optional<Part> part(const Interval& share) const {
    if (line_.is_outside && line_.is_outside(share)) return {};
    Part part;
    part.u = share;
    const NormalCone a = line_.first(share);
    const NormalCone b = line_.second(share);
    part.may_look_up = may_look(a, 1.0) && may_look(b, 1.0);
    part.may_look_down = may_look(a, -1.0) && may_look(b, -1.0);
    if (!part.may_look_up && !part.may_look_down) return {};
    part.box = line_.box(share);
    return part;
  }
  [[nodiscard]] std::vector<Part> halves(const Part& whole) const override {
    std::vector<Part> out;
    for (const Interval& share : {Interval{whole.u.lo, whole.u.middle()}, Interval{whole.u.middle(), whole.u.hi}}) {
      if (const auto half = part(share)) out.push_back(*half);
    }
    return out;
  }
  [[nodiscard]] double slant(const Part& part) const override {
    return largest_slant_between(line_.first(part.u), line_.second(part.u));
  }

 private:
  static bool may_look(const NormalCone& cone, double way) {
    return cone.half_angle >= 0.5 * kPi || way * cone.axis.z() > -std::sin(cone.half_angle);
  }

  const RidgeLine& line_;
};

/// The search for one face or line.
class Look {
 public:
  Look(const Halved& halved, LayerHalf half, Partners& partners, const SlantProfile& known, const LayerReach& reach,
       const WedgeRule& rule)
      : halved_(halved), half_(half), partners_(partners), known_(known), reach_(reach), rule_(rule) {}

  /// Enters a part, to be looked at by run(), with what may lie above or below.
  void add(const Part& part, std::vector<std::uint32_t> others) {
    const double reach = reach_.at(heights_of(part.box));
    if (!(reach > 0.0)) return;
    std::erase_if(others, [&](std::uint32_t other) { return !meets(part, partners_.part(other), reach); });
    if (others.empty()) return;
    open_.push({halved_.coarse_slant(part), parts_++, part, reach, std::move(others)});
  }

  /// The most slanted parts first: others at the same heights then tell
  /// nothing.
  void run() {
    while (!open_.empty()) {
      Open next = open_.top();
      open_.pop();
      look_at(next);
    }
  }

  void take(ThinParts& out) const {
    for (const auto& [heights, place] : beyond_) out.beyond.push_back(place);
    std::vector<Slant>& parts = half_ == LayerHalf::upper ? out.upper : out.lower;
    parts.insert(parts.end(), found_.begin(), found_.end());
  }

 private:
  struct Open {
    double slant = 0.0;
    std::size_t order = 0;
    Part part;
    double reach = 0.0;
    std::vector<std::uint32_t> others;

    bool operator<(const Open& other) const { return slant != other.slant ? slant < other.slant : order > other.order; }
  };

  void look_at(Open& open) {
    const Interval z = heights_of(open.part.box);
    const double known = (seen_ ? *seen_ : known_).least_rate(z, half_);
    if (receding_rate(open.slant) <= known) return;
    open.slant = halved_.slant(open.part);
    const double rate = receding_rate(open.slant);
    if (rate <= known) return;
    // What is hardly more than is known isn't worth a closer look.
    if (receding_rate(open.slant - kSlantAccuracy) <= known_.least_rate(z, half_)) {
      note(open.part, open.others, open.slant, rate);
      return;
    }
    const double size = size_of(open.part.box);
    const auto others = those_near(open.part, std::move(open.others), open.reach, size);
    if (others.empty()) return;
    const bool has_much = parts_ + partners_.size() > kMaxParts || pairs_ > kMaxPairs;
    if (size <= kFine * open.reach || has_much) {
      note(open.part, others, open.slant, rate);
      return;
    }
    for (const Part& half : halved_.halves(open.part)) add(half, others);
  }

  /// Of the parts, halved to about the size, those that face the other way
  /// within reach above or below.
  std::vector<std::uint32_t> those_near(const Part& part, std::vector<std::uint32_t> open, double reach, double size) {
    std::vector<std::uint32_t> out;
    while (!open.empty()) {
      const std::uint32_t node = open.back();
      open.pop_back();
      ++pairs_;
      if (!meets(part, partners_.part(node), reach)) continue;
      const bool is_small = size_of(partners_.part(node).box) <= std::max(size, kFine * reach);
      if (is_small || partners_.size() > kMaxParts || pairs_ > kMaxPairs) {
        out.push_back(node);
        continue;
      }
      const std::vector<std::uint32_t>& halves = partners_.halves(node);
      open.insert(open.end(), halves.begin(), halves.end());
    }
    return out;
  }

  [[nodiscard]] bool meets(const Part& a, const Part& b, double reach) const {
    if (!(a.may_look_up && b.may_look_down) && !(a.may_look_down && b.may_look_up)) return false;
    const Interval z = heights_of(a.box);
    const Interval other = heights_of(b.box);
    // What meets in an edge only isn't above.
    if (half_ == LayerHalf::upper ? other.hi < z.lo + 4.0 * kTouch : other.lo > z.hi - 4.0 * kTouch) return false;
    return overlap_in_plan(a.box, b.box) && gap(z, other) < reach;
  }

  void note(const Part& part, const std::vector<std::uint32_t>& others, double slant, double rate) {
    const Interval z = heights_of(part.box);
    if (rate > rule_.steepest) {
      for (const std::uint32_t other : others) note_beyond(part, other, z.length() > kLevelHeight ? rate : kNever);
    }
    if (slant >= kLevel) return;
    const Slant found{z, std::min(rate, rule_.steepest)};
    found_.push_back(found);
    if (!seen_) seen_ = known_;
    seen_->add_thin(found, half_);
  }

  static constexpr double kNever = std::numeric_limits<double>::infinity();

  void note_beyond(const Part& part, std::uint32_t other, double rate) {
    if (rate == kNever && halved_.is_line()) return;  // the faces beside it tell
    const Interval z = heights_of(part.box);
    const Interval facing = heights_of(partners_.part(other).box);
    // A level one that faces a sloping one is lost where that is.
    if (rate == kNever && facing.length() > kLevelHeight) return;
    const auto bin = [&](double height) { return std::llround((height - known_.bottom()) / known_.width()); };
    const ThinPlace place{half_, z, facing, rate, part.box.center(), {}};
    const auto [known, is_new] = beyond_.try_emplace({bin(z.middle()), bin(facing.middle())}, place);
    if (!is_new) join(known->second, place);
  }

  /// Of places at about the same heights one that holds them all.
  static void join(ThinPlace& known, const ThinPlace& place) {
    if (known.rate < place.rate) known.at = place.at;
    known.z = {std::min(known.z.lo, place.z.lo), std::max(known.z.hi, place.z.hi)};
    known.other = {std::min(known.other.lo, place.other.lo), std::max(known.other.hi, place.other.hi)};
    known.rate = std::max(known.rate, place.rate);
  }

  const Halved& halved_;
  LayerHalf half_;
  Partners& partners_;
  const SlantProfile& known_;
  std::optional<SlantProfile> seen_;  ///< what is known, and what was found, if anything
  const LayerReach& reach_;
  const WedgeRule& rule_;
  std::priority_queue<Open> open_;
  std::size_t parts_ = 0;
  std::size_t pairs_ = 0;
  std::map<std::pair<long long, long long>, ThinPlace> beyond_;
  std::vector<Slant> found_;
};

}  // namespace

ThinSearch::ThinSearch(std::vector<const FaceSlants*> faces) : faces_(std::move(faces)) {
  for (std::uint32_t f = 0; f < faces_.size(); ++f) {
    const std::vector<BezierPatch>& patches = faces_[f]->form().patches;
    for (std::uint32_t p = 0; p < patches.size(); ++p) {
      if (const auto part = part_of(*faces_[f], f, p, patches[p].u, patches[p].v)) patches_.push_back(*part);
    }
  }
  const auto left = [](const Part& a, const Part& b) { return a.box.min().x() < b.box.min().x(); };
  std::stable_sort(patches_.begin(), patches_.end(), left);
  for (const Part& patch : patches_) widest_ = std::max(widest_, patch.box.sizes().x());
}

/// Those that the box overlaps in plan.
std::vector<std::size_t> ThinSearch::patches_near(const Box3& box) const {
  const auto before = [](const Part& patch, double x) { return patch.box.min().x() < x; };
  auto at = std::lower_bound(patches_.begin(), patches_.end(), box.min().x() - widest_, before);
  std::vector<std::size_t> out;
  for (; at != patches_.end() && at->box.min().x() <= box.max().x(); ++at) {
    if (overlap_in_plan(at->box, box)) out.push_back(static_cast<std::size_t>(at - patches_.begin()));
  }
  return out;
}

ThinParts ThinSearch::of_face(std::size_t face, const SlantProfile& known, const LayerReach& reach,
                              const WedgeRule& rule) const {
  if (!(reach.largest() > 0.0)) return {};
  const HalvedFace halved(*faces_[face]);
  Partners partners(faces_, patches_);
  ThinParts out;
  const std::vector<BezierPatch>& patches = faces_[face]->form().patches;
  for (const LayerHalf half : {LayerHalf::upper, LayerHalf::lower}) {
    Look look(halved, half, partners, known, reach, rule);
    for (std::uint32_t p = 0; p < patches.size(); ++p) {
      const auto part = part_of(*faces_[face], static_cast<std::uint32_t>(face), p, patches[p].u, patches[p].v);
      if (part) look.add(*part, partners.add_all(patches_near(part->box)));
    }
    look.run();
    look.take(out);
  }
  return out;
}

ThinParts ThinSearch::of_line(const RidgeLine& line, const SlantProfile& known, const LayerReach& reach,
                              const WedgeRule& rule) const {
  if (!(reach.largest() > 0.0)) return {};
  const HalvedLine halved(line);
  const auto part = halved.part({0.0, 1.0});
  if (!part) return {};
  Partners partners(faces_, patches_);
  ThinParts out;
  for (const LayerHalf half : {LayerHalf::upper, LayerHalf::lower}) {
    Look look(halved, half, partners, known, reach, rule);
    look.add(*part, partners.add_all(patches_near(part->box)));
    look.run();
    look.take(out);
  }
  return out;
}

}  // namespace lamella
