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

/// Bernstein polynomials of one degree with first and second derivatives at a place.
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

void fill_row(int degree, double s, double scale, BernsteinRow& row) {
  double* b = row.value.data();
  b[0] = 1.0;
  for (int n = 1; n <= degree - 2; ++n) raise(b, n, s);
  for (int i = 0; i <= degree; ++i) row.bend[i] = 0.0;
  if (degree >= 2) {
    const double factor = degree * (degree - 1) * scale * scale;
    for (int i = 0; i <= degree - 2; ++i) {
      row.bend[i] += factor * b[i];
      row.bend[i + 1] -= 2.0 * factor * b[i];
      row.bend[i + 2] += factor * b[i];
    }
    raise(b, degree - 1, s);
  }
  for (int i = 0; i <= degree; ++i) row.slope[i] = 0.0;
  if (degree >= 1) {
    const double factor = degree * scale;
    for (int i = 0; i <= degree - 1; ++i) {
      row.slope[i] -= factor * b[i];
      row.slope[i + 1] += factor * b[i];
    }
    raise(b, degree, s);
  }
}

std::vector<double> distinct(const std::vector<double>& knots, double lo, double hi) {
  std::vector<double> breaks;
  for (const double knot : knots) {
    if (knot >= lo && knot <= hi && (breaks.empty() || knot > breaks.back())) breaks.push_back(knot);
  }
  return breaks;
}

/// Whether no inner knot comes more often than leaves the curve its second derivative.
bool has_second_derivatives(const std::vector<double>& knots, int degree) {
  const double lo = knots[static_cast<std::size_t>(degree)];
  const double hi = knots[knots.size() - 1 - static_cast<std::size_t>(degree)];
  int run = 0;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    run = i > 0 && knots[i] == knots[i - 1] ? run + 1 : 1;
    if (knots[i] > lo && knots[i] < hi && run > degree - 2) return false;
  }
  return true;
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

SurfacePoint2 BezierNets::evaluate(const Vec2& uv, const Cell& cell) const {
  const int count_u = degree_u_ + 1;
  const int count_v = degree_v_ + 1;
  const double scale_u = 1.0 / (breaks_u_[cell.u + 1] - breaks_u_[cell.u]);
  const double scale_v = 1.0 / (breaks_v_[cell.v + 1] - breaks_v_[cell.v]);
  BernsteinRow bu, bv;
  fill_row(degree_u_, (uv[0] - breaks_u_[cell.u]) * scale_u, scale_u, bu);
  fill_row(degree_v_, (uv[1] - breaks_v_[cell.v]) * scale_v, scale_v, bv);
  const int cells_v = static_cast<int>(breaks_v_.size()) - 1;
  const Vec4* net = poles_.data() + static_cast<std::ptrdiff_t>(cell.u * cells_v + cell.v) * count_u * count_v;
  Vec4 s = Vec4::Zero(), su = s, sv = s, suu = s, suv = s, svv = s;
  for (int i = 0; i < count_u; ++i, net += count_v) {
    Vec4 r = bv.value[0] * net[0], rv = bv.slope[0] * net[0], rvv = bv.bend[0] * net[0];
    for (int j = 1; j < count_v; ++j) {
      r += bv.value[j] * net[j];
      rv += bv.slope[j] * net[j];
      rvv += bv.bend[j] * net[j];
    }
    s += bu.value[i] * r;
    su += bu.slope[i] * r;
    sv += bu.value[i] * rv;
    suu += bu.bend[i] * r;
    suv += bu.slope[i] * rv;
    svv += bu.value[i] * rvv;
  }
  return divide(s, su, sv, suu, suv, svv, origin_);
}

CurvePoint2<3> BezierNets::evaluate(double t, int cell) const {
  const double scale = 1.0 / (breaks_u_[cell + 1] - breaks_u_[cell]);
  BernsteinRow row;
  fill_row(degree_u_, (t - breaks_u_[cell]) * scale, scale, row);
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
  if (spline != nullptr) {
    kind_ = Kind::spline;
    nets_ = BezierNets(*spline);
    is_smooth_ = has_second_derivatives(spline->knots_u, spline->degree_u) &&
                 has_second_derivatives(spline->knots_v, spline->degree_v);
    breaks_u_ = nets_.breaks_u();
    breaks_v_ = nets_.breaks_v();
  } else if (const auto* extrusion = std::get_if<Extrusion>(&surface)) {
    kind_ = Kind::extrusion;
    if (const auto* basis = std::get_if<BSplineCurve<3>>(&extrusion->basis)) {
      nets_ = BezierNets(*basis);
      is_smooth_ = has_second_derivatives(basis->knots, basis->degree);
      breaks_u_ = nets_.breaks_u();
      has_nets_ = true;
    }
  } else if (const auto* revolution = std::get_if<Revolution>(&surface)) {
    kind_ = Kind::revolution;
    if (const auto* meridian = std::get_if<BSplineCurve<3>>(&revolution->meridian)) {
      nets_ = BezierNets(*meridian);
      is_smooth_ = has_second_derivatives(meridian->knots, meridian->degree);
      breaks_v_ = nets_.breaks_u();
      has_nets_ = true;
    }
  }
}

CurvePoint2<3> SectionSurface::basis_point(double t, int cell) const {
  if (has_nets_) return nets_.evaluate(t, cell);
  if (kind_ == Kind::extrusion) return evaluate2(std::get<Extrusion>(*surface_).basis, t);
  return evaluate2(std::get<Revolution>(*surface_).meridian, t);
}

SurfacePoint2 SectionSurface::evaluate(const Vec2& uv, const Cell& cell) const {
  switch (kind_) {
    case Kind::spline:
      return nets_.evaluate(uv, cell);
    case Kind::extrusion:
      return extrude(basis_point(uv[0], cell.u), std::get<Extrusion>(*surface_).direction, uv[1]);
    case Kind::revolution:
      return revolve(basis_point(uv[1], cell.v), std::get<Revolution>(*surface_), uv[0]);
    case Kind::analytic:
      break;
  }
  return evaluate2(*surface_, uv);
}

Cell SectionSurface::find_cell(const Vec2& uv, const Vec2& heading) const {
  Cell cell;
  for (int axis = 0; axis < 2; ++axis) {
    const std::vector<double>& all = breaks(axis);
    if (all.empty()) continue;
    const auto last = static_cast<int>(all.size()) - 2;
    const auto above = std::upper_bound(all.begin(), all.end(), uv[axis]) - all.begin() - 1;
    int index = std::clamp(static_cast<int>(above), 0, last);
    if (heading[axis] < 0.0 && index > 0 && uv[axis] == all[index]) --index;
    (axis == 0 ? cell.u : cell.v) = index;
  }
  return cell;
}

Interval SectionSurface::limits(const Cell& cell, int axis) const {
  const std::vector<double>& all = breaks(axis);
  if (all.empty()) return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  const int index = axis == 0 ? cell.u : cell.v;
  // Nodes may lie outside the domain by an edge's tolerance: the outer pieces go on a little.
  const double margin = kOuterMargin * (all.back() - all.front());
  Interval limits{all[index], all[index + 1]};
  if (index == 0) limits.lo -= margin;
  if (index + 2 == static_cast<int>(all.size())) limits.hi += margin;
  return limits;
}

bool SectionSurface::has_neighbor(const Cell& cell, int axis, bool upper) const {
  const int index = axis == 0 ? cell.u : cell.v;
  return upper ? index + 2 < static_cast<int>(breaks(axis).size()) : index > 0;
}

}  // namespace lamella::span
