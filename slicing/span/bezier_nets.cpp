#include "slicing/span/bezier_nets.h"

#include <algorithm>
#include <array>

#include "model/bezier.h"
#include "model/bspline.h"
#include "slicing/span/net_kernel.h"

namespace lamella::span {

namespace {

std::vector<double> distinct(const std::vector<double>& knots, double lo, double hi) {
  std::vector<double> breaks;
  for (const double knot : knots) {
    if (knot >= lo && knot <= hi && (breaks.empty() || knot > breaks.back())) breaks.push_back(knot);
  }
  return breaks;
}

/// One sum of a net: (w x, w y, w z, w) or a derivative of that.
struct Sum {
  explicit Sum(const double* sums, int number) : at(sums + kNetStride * number) {}

  [[nodiscard]] Vec3 xyz() const { return {at[0], at[1], at[2]}; }
  [[nodiscard]] double w() const { return at[3]; }

  const double* at;
};

/// Derivatives of the quotient by Leibniz' rule on numerator = weight * point.
SurfacePoint2 divide(const double* sums, const Vec3& origin) {
  const Sum s(sums, 0), su(sums, 1), sv(sums, 2), suu(sums, 3), suv(sums, 4), svv(sums, 5);
  const double inverse = 1.0 / s.w();
  SurfacePoint2 result;
  const Vec3 point = s.xyz() * inverse;
  result.du = (su.xyz() - su.w() * point) * inverse;
  result.dv = (sv.xyz() - sv.w() * point) * inverse;
  result.duu = (suu.xyz() - 2.0 * su.w() * result.du - suu.w() * point) * inverse;
  result.duv = (suv.xyz() - su.w() * result.dv - sv.w() * result.du - suv.w() * point) * inverse;
  result.dvv = (svv.xyz() - 2.0 * sv.w() * result.dv - svv.w() * point) * inverse;
  result.point = origin + point;
  return result;
}

}  // namespace

Breaks::Breaks(std::vector<double> limits) : limits_(std::move(limits)) {
  if (limits_.size() < 2) return;
  const double length = limits_.back() - limits_.front();
  constexpr std::size_t kBucketsPerPart = 4;
  const std::size_t buckets = kBucketsPerPart * (limits_.size() - 1);
  if (length > 0.0) buckets_per_length_ = static_cast<double>(buckets) / length;
  last_bucket_ = static_cast<double>(buckets - 1);
  std::size_t part = 0;
  for (std::size_t i = 0; i < buckets; ++i) {
    const double low = limits_.front() + length * static_cast<double>(i) / static_cast<double>(buckets);
    while (part + 2 < limits_.size() && limits_[part + 1] <= low) ++part;
    first_in_bucket_.push_back(static_cast<int>(part));
  }
  for (std::size_t i = 0; i + 1 < limits_.size(); ++i) scales_.push_back(1.0 / (limits_[i + 1] - limits_[i]));
}

SurfaceNets::SurfaceNets(const BSplineSurface& surface)
    : degree_u_(surface.degree_u),
      degree_v_(surface.degree_v),
      rational_(!surface.weights.empty()),
      origin_(surface.poles.front()) {
  const Interval u = surface.domain_u();
  const Interval v = surface.domain_v();
  breaks_u_ = Breaks(distinct(surface.knots_u, u.lo, u.hi));
  breaks_v_ = Breaks(distinct(surface.knots_v, v.lo, v.hi));
  for (const BezierPatch& patch : split_to_bezier(surface)) {
    for (const Vec4& pole : patch.net) {
      const Vec3 local = pole.head<3>() - pole[3] * origin_;
      poles_.insert(poles_.end(), {local.x(), local.y(), local.z(), pole[3]});
    }
  }
}

void SurfaceNets::sum_net(const Vec2& uv, int piece_u, int piece_v, bool bends, double* sums) const {
  const NetPlace u = breaks_u_.place_in(piece_u, uv[0], degree_u_);
  const NetPlace v = breaks_v_.place_in(piece_v, uv[1], degree_v_);
  const NetKernel& kernel = net_kernel();
  (bends ? kernel.surface_bends : kernel.surface_slopes)(net(piece_u, piece_v), u, v, sums);
}

NetShape SurfaceNets::shape() const {
  return {degree_u_, degree_v_, rational_, {origin_.x(), origin_.y(), origin_.z()}};
}

SurfacePoint2 SurfaceNets::evaluate(const Vec2& uv, int piece_u, int piece_v) const {
  std::array<double, 6 * kNetStride> sums;
  sum_net(uv, piece_u, piece_v, true, sums.data());
  if (rational_) return divide(sums.data(), origin_);
  const auto xyz = [&](int number) { return Sum(sums.data(), number).xyz(); };
  return {{origin_ + xyz(0), xyz(1), xyz(2)}, xyz(3), xyz(4), xyz(5)};
}

SurfacePoint SurfaceNets::evaluate_slopes(const Vec2& uv, int piece_u, int piece_v) const {
  std::array<double, 3 * kNetStride> sums;
  sum_net(uv, piece_u, piece_v, false, sums.data());
  const Sum s(sums.data(), 0), su(sums.data(), 1), sv(sums.data(), 2);
  if (!rational_) return {origin_ + s.xyz(), su.xyz(), sv.xyz()};
  const double inverse = 1.0 / s.w();
  const Vec3 point = s.xyz() * inverse;
  return {origin_ + point, (su.xyz() - su.w() * point) * inverse, (sv.xyz() - sv.w() * point) * inverse};
}

template <int Dim>
CurveNets<Dim>::CurveNets(const BSplineCurve<Dim>& curve) : degree_(curve.degree), origin_(curve.poles.front()) {
  const BSplineCurve<Dim> fine = refine(curve, bezier_knots(curve.knots, curve.degree));
  const int count = static_cast<int>(fine.poles.size());
  breaks_ = Breaks(distinct(fine.knots, fine.knots[degree_], fine.knots[count]));
  for (int span = degree_; span < count; ++span) {
    if (!(fine.knots[span] < fine.knots[span + 1])) continue;
    for (int i = span - degree_; i <= span; ++i) {
      const double weight = fine.weights.empty() ? 1.0 : fine.weights[i];
      Vec3 local = Vec3::Zero();
      local.template head<Dim>() = weight * (fine.poles[i] - origin_);
      poles_.insert(poles_.end(), {local.x(), local.y(), local.z(), weight});
    }
  }
}

template <int Dim>
CurvePoint2<Dim> CurveNets<Dim>::evaluate(double t, int piece) const {
  std::array<double, 3 * kNetStride> sums;
  const std::ptrdiff_t net = static_cast<std::ptrdiff_t>(piece) * (degree_ + 1);
  net_kernel().curve(poles_.data() + kNetStride * net, breaks_.place_in(piece, t, degree_), sums.data());
  const Sum c(sums.data(), 0), ct(sums.data(), 1), ctt(sums.data(), 2);
  const double inverse = 1.0 / c.w();
  const auto xyz = [](const Sum& sum) { return Vec<Dim>(sum.xyz().template head<Dim>()); };
  CurvePoint2<Dim> result;
  const Vec<Dim> point = xyz(c) * inverse;
  result.dt = (xyz(ct) - ct.w() * point) * inverse;
  result.dtt = (xyz(ctt) - 2.0 * ct.w() * result.dt - ctt.w() * point) * inverse;
  result.point = origin_ + point;
  return result;
}

template <int Dim>
SectionCurve<Dim>::SectionCurve(const Curve<Dim>& curve) {
  if (const auto* spline = std::get_if<BSplineCurve<Dim>>(&curve)) {
    nets_ = CurveNets<Dim>(*spline);
    analytic_ = BSplineCurve<Dim>{};
  } else {
    analytic_ = curve;
  }
}

template <int Dim>
CurvePoint2<Dim> SectionCurve<Dim>::evaluate(double t) const {
  if (nets_.breaks().empty()) return evaluate2(analytic_, t);
  return nets_.evaluate(t, nets_.breaks().part_of(t));
}

template class CurveNets<2>;
template class CurveNets<3>;
template class SectionCurve<2>;
template class SectionCurve<3>;

}  // namespace lamella::span
