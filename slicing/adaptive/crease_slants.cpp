#include "slicing/adaptive/crease_slants.h"

#include <algorithm>

#include "model/curve_extrema.h"
#include "slicing/adaptive/flat_features.h"

namespace lamella {

namespace {

/// The slant where a vertical direction lies between normals is 1 up to the rounding of the place, squared.
constexpr double kVertical = 1.0 - 1e-7;
/// Radians, about: normals that differ by less don't jump.
constexpr double kNoJump = 1e-6;

const BSplineSurface* spline_of(const Surface& surface) {
  if (const auto* spline = std::get_if<BSplineSurface>(&surface)) return spline;
  const auto* fitted = std::get_if<FittedSurface>(&surface);
  return fitted != nullptr ? &fitted->fit : nullptr;
}

/// The knots inside the domain at which a spline of this degree need not be smooth.
std::vector<double> full_knots(const std::vector<double>& knots, int degree) {
  std::vector<double> out;
  for (std::size_t i = 0; i < knots.size();) {
    const auto end = std::upper_bound(knots.begin() + static_cast<std::ptrdiff_t>(i), knots.end(), knots[i]);
    const auto next = static_cast<std::size_t>(end - knots.begin());
    const bool is_inside = knots[i] > knots.front() && knots[i] < knots.back();
    if (is_inside && next - i >= static_cast<std::size_t>(degree)) out.push_back(knots[i]);
    i = next;
  }
  return out;
}

/// The common border of two patches: the first one's upper one along v or u.
struct Joint {
  std::size_t first = 0;
  std::size_t second = 0;
  bool runs_along_u = false;
};

/// The creases of one face: its patches tile it, u-major.
class CreaseFinder {
 public:
  CreaseFinder(const FaceSlants& face, const BSplineSurface& spline)
      : face_(face),
        patches_(face.form().patches),
        full_u_(full_knots(spline.knots_u, spline.degree_u)),
        full_v_(full_knots(spline.knots_v, spline.degree_v)) {
    while (count_v_ < patches_.size() && patches_[count_v_].u.lo == patches_[0].u.lo) ++count_v_;
    if (full_u_.empty() && full_v_.empty()) return;
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      if (p + count_v_ < patches_.size() && is_full(full_u_, patches_[p].u.hi)) add({p, p + count_v_, false});
      if ((p + 1) % count_v_ != 0 && is_full(full_v_, patches_[p].v.hi)) add({p, p + 1, true});
    }
  }

  [[nodiscard]] const std::vector<Joint>& joints() const { return joints_; }

  /// Where joints end inside the domain: the patches whose upper corners these are.
  [[nodiscard]] std::vector<std::size_t> crossings() const {
    std::vector<std::size_t> out;
    const auto add = [&](std::size_t corner) {
      const bool is_inside = corner + count_v_ < patches_.size() && (corner + 1) % count_v_ != 0;
      if (is_inside && std::find(out.begin(), out.end(), corner) == out.end()) out.push_back(corner);
    };
    for (const Joint& joint : joints_) {
      const std::size_t before = joint.runs_along_u ? count_v_ : 1;
      if (joint.first >= before) add(joint.first - before);
      add(joint.first);
    }
    return out;
  }

  /// The normals of the four patches around the upper corner of one.
  [[nodiscard]] std::vector<Vec3> normals_around(std::size_t corner) const {
    const Interval u{patches_[corner].u.hi, patches_[corner].u.hi};
    const Interval v{patches_[corner].v.hi, patches_[corner].v.hi};
    std::vector<Vec3> out;
    for (const std::size_t patch : {corner, corner + 1, corner + count_v_, corner + count_v_ + 1}) {
      out.push_back(face_.normals_of(patch, u, v).axis);
    }
    return out;
  }

  [[nodiscard]] Interval along(const Joint& joint, const Interval& share) const {
    const Interval& own = joint.runs_along_u ? patches_[joint.first].u : patches_[joint.first].v;
    return {own.lo + share.lo * own.length(), own.lo + share.hi * own.length()};
  }
  [[nodiscard]] Interval across(const Joint& joint) const {
    const double at = joint.runs_along_u ? patches_[joint.first].v.hi : patches_[joint.first].u.hi;
    return {at, at};
  }
  [[nodiscard]] NormalCone normals(const Joint& joint, bool of_first, const Interval& share) const {
    const std::size_t patch = of_first ? joint.first : joint.second;
    return joint.runs_along_u ? face_.normals_of(patch, along(joint, share), across(joint))
                              : face_.normals_of(patch, across(joint), along(joint, share));
  }
  [[nodiscard]] bool is_outside(const Joint& joint, const Interval& share) const {
    return joint.runs_along_u ? face_.is_outside(along(joint, share), across(joint))
                              : face_.is_outside(across(joint), along(joint, share));
  }

  /// The joint in space, over [0, 1].
  [[nodiscard]] BSplineCurve<3> line(const Joint& joint) const {
    const BezierPatch& patch = patches_[joint.first];
    BSplineCurve<3> out;
    out.degree = joint.runs_along_u ? patch.degree_u : patch.degree_v;
    for (int i = 0; i <= out.degree; ++i) {
      const int row = joint.runs_along_u ? i : patch.degree_u;
      const int column = joint.runs_along_u ? patch.degree_v : i;
      const Vec4& p = patch.net[static_cast<std::size_t>(row * (patch.degree_v + 1) + column)];
      out.poles.emplace_back(p.head<3>() / p[3]);
      out.weights.push_back(p[3]);
    }
    out.knots.assign(static_cast<std::size_t>(out.degree) + 1, 0.0);
    out.knots.insert(out.knots.end(), static_cast<std::size_t>(out.degree) + 1, 1.0);
    return out;
  }

 private:
  static bool is_full(const std::vector<double>& knots, double at) {
    return std::find(knots.begin(), knots.end(), at) != knots.end();
  }

  void add(const Joint& joint) {
    if (has_jump(joint)) joints_.push_back(joint);
  }

  /// The product of the two sides' normals is a polynomial along the joint: if it vanishes at as many places as its
  /// degree and one more, it vanishes.
  [[nodiscard]] bool has_jump(const Joint& joint) const {
    const auto& nets = face_.nets();
    const auto degree = [&](std::size_t p) { return joint.runs_along_u ? nets[p].degree_u : nets[p].degree_v; };
    const int places = degree(joint.first) + degree(joint.second);
    for (int k = 0; k <= places; ++k) {
      const double share = places > 0 ? static_cast<double>(k) / places : 0.5;
      const NormalCone a = normals(joint, true, {share, share});
      const NormalCone b = normals(joint, false, {share, share});
      if (a.half_angle > 1.0 || b.half_angle > 1.0) return true;  // no normal there: look closer
      if ((a.axis - b.axis).norm() > kNoJump) return true;
    }
    return false;
  }

  const FaceSlants& face_;
  const std::vector<BezierPatch>& patches_;
  std::vector<double> full_u_;
  std::vector<double> full_v_;
  std::size_t count_v_ = 0;
  std::vector<Joint> joints_;
};

/// Where the line's height has an extremum, or all along it, and a vertical lies between the normals.
void add_extrema(const BSplineCurve<3>& line, const RidgeLine& ridge, CreaseSlants& out) {
  const Curve3 curve = line;
  std::vector<double> shares{0.5};
  if (exact_bounds(curve, {0.0, 1.0}).sizes().z() > kSameHeight) {
    shares = critical_parameters(curve, {0.0, 1.0}, Vec3::UnitZ());
  }
  for (const double share : shares) {
    const Interval at{share, share};
    if (ridge.is_outside(at)) continue;
    if (largest_slant_between({ridge.first(at).axis, 0.0}, {ridge.second(at).axis, 0.0}) < kVertical) continue;
    out.extrema.push_back(ridge.heights(at).middle());
  }
}

}  // namespace

CreaseSlants crease_slants(const FaceSlants& face, const SlantProfile& known, const WedgeRule& wedges) {
  CreaseSlants out;
  const BSplineSurface* spline = spline_of(face.surface());
  if (spline == nullptr) return out;
  const CreaseFinder creases(face, *spline);
  for (const Joint& joint : creases.joints()) {
    const BSplineCurve<3> line = creases.line(joint);
    RidgeLine ridge;
    ridge.heights = [&](const Interval& share) {
      const Box3 box = exact_bounds(Curve3(line), share);
      return Interval{box.min().z(), box.max().z()};
    };
    ridge.first = [&](const Interval& share) { return creases.normals(joint, true, share); };
    ridge.second = [&](const Interval& share) { return creases.normals(joint, false, share); };
    ridge.is_outside = [&](const Interval& share) { return creases.is_outside(joint, share); };
    const EdgeSlants found = ridge_slants(ridge, known, wedges);
    out.parts.insert(out.parts.end(), found.parts.begin(), found.parts.end());
    if (found.is_too_sharp) ++out.sharp;
    add_extrema(line, ridge, out);
  }
  for (const std::size_t corner : creases.crossings()) {
    const BezierPatch& patch = face.form().patches[corner];
    if (face.is_outside({patch.u.hi, patch.u.hi}, {patch.v.hi, patch.v.hi})) continue;
    const double z = patch.net.back()[2] / patch.net.back()[3];
    const double slant = largest_slant_among(creases.normals_around(corner));
    out.parts.push_back({{z, z}, slant});
    if (slant >= kVertical) out.extrema.push_back(z);
  }
  return out;
}

}  // namespace lamella
