#include "slicing/span/section_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

#include "model/bezier.h"
#include "model/bspline.h"

namespace lamella::span {

namespace {

/// Share of the domain by which the outer cells reach beyond it.
constexpr double kOuterMargin = 0.02;

/// Share of a cell by which a point beyond its limit is still on it.
constexpr double kCellSlack = 1e-9;

/// Share of a cell within which an edge's tolerance may move a point over its limit.
constexpr double kNearLimit = 1e-4;

/// Bernstein polynomials of one degree with first and, if asked for, second derivatives at a place.
struct BernsteinRow {
  std::array<double, kMaxDegree + 1> value;
  std::array<double, kMaxDegree + 1> slope;
  std::array<double, kMaxDegree + 1> bend;
};

/// One step of the triangular recursion: degree n - 1 to n, in place.
void raise(double* b, int n, double s) {
  const double r = 1.0 - s;
  b[n] = s * b[n - 1];
  for (int i = n - 1; i > 0; --i) b[i] = r * b[i] + s * b[i - 1];
  b[0] = r * b[0];
}

/// The derivative's row from that of one degree less: factor (b[i - 1] - b[i]).
void differ(const double* b, int degree, double factor, double* out) {
  out[0] = -factor * b[0];
  for (int i = 1; i < degree; ++i) out[i] = factor * (b[i - 1] - b[i]);
  out[degree] = factor * b[degree - 1];
}

void fill_general(int degree, double s, double scale, bool bends, BernsteinRow& row) {
  double* b = row.value.data();
  b[0] = 1.0;
  for (int n = 1; n <= degree - 2; ++n) raise(b, n, s);
  if (bends) row.bend.fill(0.0);
  if (degree >= 2) {
    if (bends) {
      std::array<double, kMaxDegree + 1> first;
      differ(b, degree - 1, (degree - 1) * scale, first.data());
      differ(first.data(), degree, degree * scale, row.bend.data());
    }
    raise(b, degree - 1, s);
  }
  row.slope[0] = 0.0;
  if (degree >= 1) {
    differ(b, degree, degree * scale, row.slope.data());
    raise(b, degree, s);
  }
}

/// The degree of most surfaces, written out.
void fill_cubic(double s, double scale, BernsteinRow& row) {
  const double r = 1.0 - s;
  const double rr = r * r, rs = r * s, ss = s * s;
  row.value[0] = r * rr;
  row.value[1] = 3.0 * s * rr;
  row.value[2] = 3.0 * r * ss;
  row.value[3] = s * ss;
  const double d = 3.0 * scale;
  row.slope[0] = -d * rr;
  row.slope[1] = d * (rr - 2.0 * rs);
  row.slope[2] = d * (2.0 * rs - ss);
  row.slope[3] = d * ss;
  const double e = 6.0 * scale * scale;
  row.bend[0] = e * r;
  row.bend[1] = e * (s - 2.0 * r);
  row.bend[2] = e * (r - 2.0 * s);
  row.bend[3] = e * s;
}

void fill_row(int degree, double s, double scale, bool bends, BernsteinRow& row) {
  if (degree == 3) {
    fill_cubic(s, scale, row);
  } else {
    fill_general(degree, s, scale, bends, row);
  }
}

std::vector<double> distinct(const std::vector<double>& knots, double lo, double hi) {
  std::vector<double> breaks;
  for (const double knot : knots) {
    if (knot >= lo && knot <= hi && (breaks.empty() || knot > breaks.back())) breaks.push_back(knot);
  }
  return breaks;
}

/// Multiplicity of a knot.
int count_of(const std::vector<double>& knots, double knot) {
  const auto [first, last] = std::equal_range(knots.begin(), knots.end(), knot);
  return static_cast<int>(last - first);
}

Vec4 homogeneous(const Vec3& pole, double weight, const Vec3& origin) {
  Vec4 point;
  point << weight * (pole - origin), weight;
  return point;
}

/// Derivatives of the quotient by Leibniz' rule on numerator = weight * point.
SurfacePoint2 divide(const Vec4& s, const Vec4& su, const Vec4& sv, const Vec4& suu, const Vec4& suv, const Vec4& svv,
                     const Vec3& origin) {
  const double inverse = 1.0 / s[3];
  SurfacePoint2 result;
  const Vec3 point = s.head<3>() * inverse;
  result.du = (su.head<3>() - su[3] * point) * inverse;
  result.dv = (sv.head<3>() - sv[3] * point) * inverse;
  result.duu = (suu.head<3>() - 2.0 * su[3] * result.du - suu[3] * point) * inverse;
  result.duv = (suv.head<3>() - su[3] * result.dv - sv[3] * result.du - suv[3] * point) * inverse;
  result.dvv = (svv.head<3>() - 2.0 * sv[3] * result.dv - svv[3] * point) * inverse;
  result.point = origin + point;
  return result;
}

}  // namespace

BezierNets::BezierNets(const BSplineSurface& surface) : degree_u_(surface.degree_u), degree_v_(surface.degree_v) {
  const Interval u = surface.domain_u();
  const Interval v = surface.domain_v();
  breaks_u_ = distinct(surface.knots_u, u.lo, u.hi);
  breaks_v_ = distinct(surface.knots_v, v.lo, v.hi);
  origin_ = surface.poles.front();
  rational_ = !surface.weights.empty();
  for (const BezierPatch& patch : split_to_bezier(surface)) {
    for (const Vec4& pole : patch.net) {
      Vec4 local = pole;
      local.head<3>() -= pole[3] * origin_;
      poles_.push_back(local);
    }
  }
}

BezierNets::BezierNets(const BSplineCurve<3>& curve) : degree_u_(curve.degree) {
  const BSplineCurve<3> fine = refine(curve, bezier_knots(curve.knots, curve.degree));
  const int count = static_cast<int>(fine.poles.size());
  breaks_u_ = distinct(fine.knots, fine.knots[degree_u_], fine.knots[count]);
  origin_ = fine.poles.front();
  for (int span = degree_u_; span < count; ++span) {
    if (!(fine.knots[span] < fine.knots[span + 1])) continue;
    for (int i = span - degree_u_; i <= span; ++i) {
      poles_.push_back(homogeneous(fine.poles[i], fine.weights.empty() ? 1.0 : fine.weights[i], origin_));
    }
  }
}

const Vec4* BezierNets::net_of(const Cell& cell) const {
  const auto cells_v = static_cast<std::ptrdiff_t>(breaks_v_.size()) - 1;
  return poles_.data() + (cell.u * cells_v + cell.v) * (degree_u_ + 1) * (degree_v_ + 1);
}

namespace {

/// Sums of a net with the rows of both parameters: S, S_u, S_v and, if asked for, S_uu, S_uv, S_vv.
template <bool Bends>
void contract(const Vec4* net, int count_u, int count_v, const BernsteinRow& bu, const BernsteinRow& bv, Vec4* sums) {
  for (int k = 0; k < (Bends ? 6 : 3); ++k) sums[k].setZero();
  for (int i = 0; i < count_u; ++i, net += count_v) {
    Vec4 r = bv.value[0] * net[0];
    Vec4 rv = bv.slope[0] * net[0];
    for (int j = 1; j < count_v; ++j) {
      r += bv.value[j] * net[j];
      rv += bv.slope[j] * net[j];
    }
    sums[0] += bu.value[i] * r;
    sums[1] += bu.slope[i] * r;
    sums[2] += bu.value[i] * rv;
    if constexpr (Bends) {
      Vec4 rvv = bv.bend[0] * net[0];
      for (int j = 1; j < count_v; ++j) rvv += bv.bend[j] * net[j];
      sums[3] += bu.bend[i] * r;
      sums[4] += bu.slope[i] * rv;
      sums[5] += bu.value[i] * rvv;
    }
  }
}

}  // namespace

SurfacePoint2 BezierNets::evaluate(const Vec2& uv, const Cell& cell) const {
  const double scale_u = 1.0 / (breaks_u_[cell.u + 1] - breaks_u_[cell.u]);
  const double scale_v = 1.0 / (breaks_v_[cell.v + 1] - breaks_v_[cell.v]);
  BernsteinRow bu, bv;
  fill_row(degree_u_, (uv[0] - breaks_u_[cell.u]) * scale_u, scale_u, true, bu);
  fill_row(degree_v_, (uv[1] - breaks_v_[cell.v]) * scale_v, scale_v, true, bv);
  Vec4 s[6];
  contract<true>(net_of(cell), degree_u_ + 1, degree_v_ + 1, bu, bv, s);
  if (rational_) return divide(s[0], s[1], s[2], s[3], s[4], s[5], origin_);
  return {{origin_ + s[0].head<3>(), s[1].head<3>(), s[2].head<3>()}, s[3].head<3>(), s[4].head<3>(), s[5].head<3>()};
}

SurfacePoint BezierNets::evaluate_slopes(const Vec2& uv, const Cell& cell) const {
  const double scale_u = 1.0 / (breaks_u_[cell.u + 1] - breaks_u_[cell.u]);
  const double scale_v = 1.0 / (breaks_v_[cell.v + 1] - breaks_v_[cell.v]);
  BernsteinRow bu, bv;
  fill_row(degree_u_, (uv[0] - breaks_u_[cell.u]) * scale_u, scale_u, false, bu);
  fill_row(degree_v_, (uv[1] - breaks_v_[cell.v]) * scale_v, scale_v, false, bv);
  Vec4 s[3];
  contract<false>(net_of(cell), degree_u_ + 1, degree_v_ + 1, bu, bv, s);
  const double inverse = rational_ ? 1.0 / s[0][3] : 1.0;
  const Vec3 point = s[0].head<3>() * inverse;
  if (!rational_) return {origin_ + point, s[1].head<3>(), s[2].head<3>()};
  return {origin_ + point, (s[1].head<3>() - s[1][3] * point) * inverse, (s[2].head<3>() - s[2][3] * point) * inverse};
}

CurvePoint2<3> BezierNets::evaluate(double t, int cell) const {
  const double scale = 1.0 / (breaks_u_[cell + 1] - breaks_u_[cell]);
  BernsteinRow row;
  fill_row(degree_u_, (t - breaks_u_[cell]) * scale, scale, true, row);
  const Vec4* net = poles_.data() + static_cast<std::ptrdiff_t>(cell) * (degree_u_ + 1);
  Vec4 c = Vec4::Zero(), ct = c, ctt = c;
  for (int i = 0; i <= degree_u_; ++i) {
    c += row.value[i] * net[i];
    ct += row.slope[i] * net[i];
    ctt += row.bend[i] * net[i];
  }
  const double inverse = 1.0 / c[3];
  CurvePoint2<3> result;
  const Vec3 point = c.head<3>() * inverse;
  result.dt = (ct.head<3>() - ct[3] * point) * inverse;
  result.dtt = (ctt.head<3>() - 2.0 * ct[3] * result.dt - ctt[3] * point) * inverse;
  result.point = origin_ + point;
  return result;
}

SectionSurface::SectionSurface(const Surface& surface) : surface_(&surface), periods_(lamella::periods(surface)) {
  const auto* spline = std::get_if<BSplineSurface>(&surface);
  if (const auto* fitted = std::get_if<FittedSurface>(&surface)) spline = &fitted->fit;
  const auto* extrusion = std::get_if<Extrusion>(&surface);
  const auto* revolution = std::get_if<Revolution>(&surface);
  if (spline != nullptr) {
    kind_ = Kind::spline;
    has_nets_ = true;
    nets_ = BezierNets(*spline);
    set_breaks(0, nets_.breaks_u(), spline->knots_u, spline->degree_u);
    set_breaks(1, nets_.breaks_v(), spline->knots_v, spline->degree_v);
  } else if (extrusion != nullptr || revolution != nullptr) {
    kind_ = extrusion != nullptr ? Kind::extrusion : Kind::revolution;
    const Curve3& curve = extrusion != nullptr ? extrusion->basis : revolution->meridian;
    if (const auto* basis = std::get_if<BSplineCurve<3>>(&curve)) {
      has_nets_ = true;
      nets_ = BezierNets(*basis);
      set_breaks(extrusion != nullptr ? 0 : 1, nets_.breaks_u(), basis->knots, basis->degree);
    }
  }
}

void SectionSurface::set_breaks(int axis, const std::vector<double>& pieces, const std::vector<double>& knots,
                                int degree) {
  pieces_[axis] = pieces;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const bool is_end = i == 0 || i + 1 == pieces.size();
    if (!is_end && count_of(knots, pieces[i]) <= degree - 2) continue;
    breaks_[axis].push_back(pieces[i]);
    first_piece_[axis].push_back(static_cast<int>(i));
  }
}

int SectionSurface::piece_of(int axis, double place, int cell) const {
  const std::vector<double>& all = pieces_[axis];
  if (all.empty()) return 0;
  const int first = first_piece_[axis][cell];
  const int last = first_piece_[axis][cell + 1];
  if (last - first == 1) return first;
  const auto above = std::upper_bound(all.begin() + first + 1, all.begin() + last, place);
  return static_cast<int>(above - all.begin()) - 1;
}

bool SectionSurface::crosses_knot(const Vec2& a, const Vec2& b, const Cell& cell) const {
  return piece_of(0, a[0], cell.u) != piece_of(0, b[0], cell.u) ||
         piece_of(1, a[1], cell.v) != piece_of(1, b[1], cell.v);
}

CurvePoint2<3> SectionSurface::basis_point(double t, int piece) const {
  if (has_nets_) return nets_.evaluate(t, piece);
  if (kind_ == Kind::extrusion) return evaluate2(std::get<Extrusion>(*surface_).basis, t);
  return evaluate2(std::get<Revolution>(*surface_).meridian, t);
}

SurfacePoint2 SectionSurface::evaluate(const Vec2& uv, const Cell& cell) const {
  if (kind_ == Kind::analytic) return evaluate2(*surface_, uv);
  const Cell piece{piece_of(0, uv[0], cell.u), piece_of(1, uv[1], cell.v)};
  if (kind_ == Kind::spline) return nets_.evaluate(uv, piece);
  if (kind_ == Kind::extrusion) {
    return extrude(basis_point(uv[0], piece.u), std::get<Extrusion>(*surface_).direction, uv[1]);
  }
  return revolve(basis_point(uv[1], piece.v), std::get<Revolution>(*surface_), uv[0]);
}

SurfacePoint SectionSurface::evaluate_slopes(const Vec2& uv, const Cell& cell) const {
  if (kind_ != Kind::spline) return evaluate(uv, cell);
  return nets_.evaluate_slopes(uv, {piece_of(0, uv[0], cell.u), piece_of(1, uv[1], cell.v)});
}

Cell SectionSurface::find_cell(const Vec2& uv, const Vec2& heading) const {
  Cell cell;
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& all = breaks_[axis];
    if (all.empty()) continue;
    const auto last = static_cast<int>(all.size()) - 2;
    const auto above = std::upper_bound(all.begin(), all.end(), uv[axis]) - all.begin() - 1;
    int index = std::clamp(static_cast<int>(above), 0, last);
    const double slack = kCellSlack * (all[index + 1] - all[index]);
    if (heading[axis] < 0.0 && index > 0 && uv[axis] <= all[index] + slack) {
      --index;
    } else if (heading[axis] > 0.0 && index < last && uv[axis] >= all[index + 1] - slack) {
      ++index;
    }
    (axis == 0 ? cell.u : cell.v) = index;
  }
  return cell;
}

Interval SectionSurface::limits(const Cell& cell, int axis) const {
  const std::vector<double>& all = breaks_[axis];
  if (all.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const int index = axis == 0 ? cell.u : cell.v;
  // Nodes may lie outside the domain by an edge's tolerance: the outer cells go on a little.
  const double margin = kOuterMargin * (all.back() - all.front());
  Interval limits{all[index], all[index + 1]};
  if (index == 0) limits.lo -= margin;
  if (index + 2 == static_cast<int>(all.size())) limits.hi += margin;
  return limits;
}

bool SectionSurface::holds(const Cell& cell, const Vec2& uv, int free_axis) const {
  for (int axis = 0; axis < 2; ++axis) {
    if (axis == free_axis) continue;
    const Interval range = limits(cell, axis);
    const double slack = kCellSlack * range.length();
    // Written so that NaN fails; an infinite range has an infinite slack.
    if (!(uv[axis] >= range.lo - slack && uv[axis] <= range.hi + slack)) return false;
  }
  return true;
}

bool SectionSurface::is_near_limit(const Cell& cell, const Vec2& uv) const {
  for (int axis = 0; axis < 2; ++axis) {
    const Interval range = limits(cell, axis);
    const double slack = kNearLimit * range.length();
    if (has_neighbor(cell, axis, false) && uv[axis] - range.lo < slack) return true;
    if (has_neighbor(cell, axis, true) && range.hi - uv[axis] < slack) return true;
  }
  return false;
}

double SectionSurface::extent(int axis) const {
  if (periods_[axis] > 0.0) return periods_[axis];
  if (breaks_[axis].empty()) return std::numeric_limits<double>::infinity();
  return breaks_[axis].back() - breaks_[axis].front();
}

bool SectionSurface::has_neighbor(const Cell& cell, int axis, bool upper) const {
  const int index = axis == 0 ? cell.u : cell.v;
  return upper ? index + 2 < static_cast<int>(breaks_[axis].size()) : index > 0;
}

}  // namespace lamella::span
