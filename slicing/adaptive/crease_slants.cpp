#include "slicing/adaptive/crease_slants.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "model/bernstein_roots.h"
#include "model/bezier.h"
#include "model/curve_extrema.h"
#include "model/evaluate.h"
#include "model/rational_form.h"
#include "slicing/adaptive/flat_features.h"

namespace lamella {

namespace {

/// The slant where a vertical direction lies between normals is 1 up to the rounding of the place, squared.
constexpr double kVertical = 1.0 - 1e-7;
/// Of an edge's range: what is that near to its ends is the vertex's.
constexpr double kAtEnd = 1e-9;
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

/// A line of the surface's parameters: v = at, or u = at.
struct IsoLine {
  int axis = 0;
  double at = 0.0;
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

  /// The lines of parameters that joints run along, each once.
  [[nodiscard]] std::vector<IsoLine> lines() const {
    std::vector<IsoLine> out;
    for (const Joint& joint : joints_) {
      const IsoLine line{joint.runs_along_u ? 1 : 0, across(joint).lo};
      const auto same = [&](const IsoLine& other) { return other.axis == line.axis && other.at == line.at; };
      if (std::none_of(out.begin(), out.end(), same)) out.push_back(line);
    }
    return out;
  }

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

/// Where on a conic's piece its point comes nearest to `uv`: its pieces have a parameter of their own.
double nearest_parameter(const Curve2& pcurve, Interval t, const Vec2& uv) {
  const auto distance = [&](double at) { return (evaluate<2>(pcurve, at).point - uv).squaredNorm(); };
  for (int k = 0; k < 100; ++k) {
    const double third = (t.hi - t.lo) / 3.0;
    if (distance(t.lo + third) < distance(t.hi - third)) {
      t.hi -= third;
    } else {
      t.lo += third;
    }
  }
  return t.middle();
}

/// The pcurve's parameters where it crosses or touches the line, between and at the ends of its pieces.
std::vector<double> crossings(const Curve2& pcurve, const std::vector<BezierCurve2>& pieces, const IsoLine& line) {
  const bool keeps_parameter =
      std::holds_alternative<Line<2>>(pcurve) || std::holds_alternative<BSplineCurve<2>>(pcurve);
  std::vector<double> out;
  for (const BezierCurve2& piece : pieces) {
    std::vector<double> net;
    double scale = 0.0;
    for (const Vec3& p : piece.net) {
      net.push_back(p[line.axis] - line.at * p.z());
      scale = std::max(scale, std::abs(p[line.axis]) + std::abs(line.at * p.z()));
    }
    std::vector<double> roots = bernstein_roots(net, scale);
    if (std::abs(net.back()) <= 1e-12 * scale && std::abs(net.front()) > 1e-12 * scale) roots.push_back(1.0);
    for (const double root : roots) {
      const double t = piece.t.lo + root * piece.t.length();
      out.push_back(keeps_parameter ? t : nearest_parameter(pcurve, piece.t, evaluate_point(piece, t)));
    }
  }
  return out;
}

/// A crease in space, over [0, 1], and what there is beside it.
struct Crease {
  Curve3 curve;
  RidgeLine ridge;
};

std::vector<Crease> creases_of(const std::shared_ptr<const CreaseFinder>& finder) {
  std::vector<Crease> out;
  for (const Joint& joint : finder->joints()) {
    Crease crease{finder->line(joint), {}};
    crease.ridge.box = [curve = crease.curve](const Interval& share) { return exact_bounds(curve, share); };
    crease.ridge.first = [finder, joint](const Interval& share) { return finder->normals(joint, true, share); };
    crease.ridge.second = [finder, joint](const Interval& share) { return finder->normals(joint, false, share); };
    crease.ridge.is_outside = [finder, joint](const Interval& share) { return finder->is_outside(joint, share); };
    out.push_back(std::move(crease));
  }
  return out;
}

/// None where the surface isn't a spline.
std::shared_ptr<const CreaseFinder> finder_of(const FaceSlants& face) {
  const BSplineSurface* spline = spline_of(face.surface());
  return spline != nullptr ? std::make_shared<const CreaseFinder>(face, *spline) : nullptr;
}

/// Where the line's height has an extremum, or all along it, and a vertical lies between the normals.
void add_extrema(const Crease& crease, CreaseSlants& out) {
  const auto& [curve, ridge] = crease;
  std::vector<double> shares{0.5};
  if (exact_bounds(curve, {0.0, 1.0}).sizes().z() > kSameHeight) {
    shares = critical_parameters(curve, {0.0, 1.0}, Vec3::UnitZ());
  }
  for (const double share : shares) {
    const Interval at{share, share};
    if (ridge.is_outside(at)) continue;
    if (largest_slant_between({ridge.first(at).axis, 0.0}, {ridge.second(at).axis, 0.0}) < kVertical) continue;
    out.extrema.push_back(heights_of(ridge.box(at)).middle());
  }
}

}  // namespace

CreaseSlants crease_slants(const FaceSlants& face, const SlantProfile& known, const WedgeRule& wedges) {
  CreaseSlants out;
  const auto finder = finder_of(face);
  if (!finder) return out;
  for (const Crease& crease : creases_of(finder)) {
    const EdgeSlants found = ridge_slants(crease.ridge, known, wedges);
    out.parts.insert(out.parts.end(), found.parts.begin(), found.parts.end());
    if (found.is_too_sharp) ++out.sharp;
    add_extrema(crease, out);
  }
  for (const std::size_t corner : finder->crossings()) {
    const BezierPatch& patch = face.form().patches[corner];
    if (face.is_outside({patch.u.hi, patch.u.hi}, {patch.v.hi, patch.v.hi})) continue;
    const double z = patch.net.back()[2] / patch.net.back()[3];
    const double slant = largest_slant_among(finder->normals_around(corner));
    out.parts.push_back({{z, z}, slant});
    if (slant >= kVertical) out.extrema.push_back(z);
  }
  return out;
}

std::vector<RidgeLine> crease_lines(const FaceSlants& face) {
  std::vector<RidgeLine> out;
  if (const auto finder = finder_of(face)) {
    for (Crease& crease : creases_of(finder)) out.push_back(std::move(crease.ridge));
  }
  return out;
}

std::vector<double> crease_crossings(const FaceSlants& face, const Scene& scene, HalfEdgeId half_edge) {
  std::vector<double> shares;
  const auto finder = finder_of(face);
  if (!finder || finder->joints().empty()) return shares;
  const HalfEdge& half = scene.half_edges[half_edge];
  const std::vector<BezierCurve2> pieces = rational_pieces(half.pcurve, half.prange);
  for (const IsoLine& line : finder->lines()) {
    for (const double t : crossings(half.pcurve, pieces, line)) {
      shares.push_back((t - half.prange.lo) / (half.prange.hi - half.prange.lo));
    }
  }
  std::erase_if(shares, [](double share) { return !(share > kAtEnd && share < 1.0 - kAtEnd); });
  std::sort(shares.begin(), shares.end());
  return shares;
}

}  // namespace lamella
