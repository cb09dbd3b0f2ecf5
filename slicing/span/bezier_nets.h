#pragma once

#include <cstddef>
#include <vector>

#include "core/geometry.h"
#include "model/curve.h"
#include "model/evaluate.h"
#include "model/surface.h"
#include "slicing/span/lane_kernel.h"
#include "slicing/span/net_kernel.h"

namespace lamella::span {

/// Ascending limits of consecutive parts, and which part holds a place.
class Breaks {
 public:
  Breaks() = default;
  explicit Breaks(std::vector<double> limits);

  [[nodiscard]] const std::vector<double>& all() const { return limits_; }
  [[nodiscard]] double operator[](int i) const { return limits_[static_cast<std::size_t>(i)]; }
  /// Where a place lies in a part, 0 to 1, and the derivative of that.
  [[nodiscard]] NetPlace place_in(int part, double place, int degree) const {
    const double scale = scales_[static_cast<std::size_t>(part)];
    return {degree, (place - limits_[static_cast<std::size_t>(part)]) * scale, scale};
  }
  [[nodiscard]] bool empty() const { return limits_.empty(); }
  /// Among parts [first, last) the one that holds `place`; the outer ones go on without end.
  [[nodiscard]] int part_of(double place, int first, int last) const {
    if (last - first == 1) return first;
    const double* limits = limits_.data();
    // Written so that NaN gives the first bucket.
    double bucket = (place - limits[0]) * buckets_per_length_;
    bucket = bucket > 0.0 ? bucket : 0.0;
    bucket = bucket < last_bucket_ ? bucket : last_bucket_;
    int part = first_in_bucket_[static_cast<std::size_t>(bucket)];
    part = part < last ? part : last - 1;
    part = part > first ? part : first;
    while (place < limits[part] && part > first) --part;
    while (place >= limits[part + 1] && part + 1 < last) ++part;
    return part;
  }
  [[nodiscard]] int part_of(double place) const { return part_of(place, 0, static_cast<int>(limits_.size()) - 1); }

 private:
  std::vector<double> limits_;
  std::vector<double> scales_;        ///< one over the length of each part
  std::vector<int> first_in_bucket_;  ///< the part at the lower end of each of many equal buckets: where to begin
  double buckets_per_length_ = 0.0;
  double last_bucket_ = 0.0;
};

/// Rational Bezier nets of a surface, evaluated with derivatives. Poles are kept relative to an origin near the part,
/// (w (x - o), w), so that parts far from the origin keep digits. A piece goes on analytically beyond its own limits.
class SurfaceNets {
 public:
  SurfaceNets() = default;
  explicit SurfaceNets(const BSplineSurface& surface);

  [[nodiscard]] const Breaks& breaks_u() const { return breaks_u_; }
  [[nodiscard]] const Breaks& breaks_v() const { return breaks_v_; }
  /// By the net number (piece_u, piece_v).
  [[nodiscard]] SurfacePoint2 evaluate(const Vec2& uv, int piece_u, int piece_v) const;
  [[nodiscard]] SurfacePoint evaluate_slopes(const Vec2& uv, int piece_u, int piece_v) const;
  /// Has a lane evaluated at (u, v) by the net number (piece_u, piece_v).
  void set_lane(const Vec2& uv, int piece_u, int piece_v, int lane, NetLanes& lanes) const {
    const NetPlace u = breaks_u_.place_in(piece_u, uv[0], degree_u_);
    const NetPlace v = breaks_v_.place_in(piece_v, uv[1], degree_v_);
    lanes.net[lane] = net(piece_u, piece_v);
    lanes.place_u[lane] = u.place;
    lanes.scale_u[lane] = u.scale;
    lanes.place_v[lane] = v.place;
    lanes.scale_v[lane] = v.scale;
  }
  [[nodiscard]] NetShape shape() const;

 private:
  [[nodiscard]] const double* net(int piece_u, int piece_v) const {
    const auto pieces_v = static_cast<std::ptrdiff_t>(breaks_v_.all().size()) - 1;
    return poles_.data() + kNetStride * (piece_u * pieces_v + piece_v) * (degree_u_ + 1) * (degree_v_ + 1);
  }
  void sum_net(const Vec2& uv, int piece_u, int piece_v, bool bends, double* sums) const;

  int degree_u_ = 0;
  int degree_v_ = 0;
  bool rational_ = false;
  Breaks breaks_u_;
  Breaks breaks_v_;
  std::vector<double> poles_;  ///< (w x, w y, w z, w) of net (i, j) from (i * pieces_v + j) * net size
  Vec3 origin_ = Vec3::Zero();
};

/// The same of a curve in space or in (u, v).
template <int Dim>
class CurveNets {
 public:
  CurveNets() = default;
  explicit CurveNets(const BSplineCurve<Dim>& curve);

  [[nodiscard]] const Breaks& breaks() const { return breaks_; }
  [[nodiscard]] CurvePoint2<Dim> evaluate(double t, int piece) const;

 private:
  int degree_ = 0;
  Breaks breaks_;
  std::vector<double> poles_;  ///< (w x, w y, w z or 0, w)
  Vec<Dim> origin_ = Vec<Dim>::Zero();
};

/// A curve that is evaluated often: a B-spline by its nets, others by their formula.
template <int Dim>
class SectionCurve {
 public:
  explicit SectionCurve(const Curve<Dim>& curve);

  [[nodiscard]] CurvePoint2<Dim> evaluate(double t) const;
  /// The line if it is one.
  [[nodiscard]] const Line<Dim>* line() const { return std::get_if<Line<Dim>>(&analytic_); }

 private:
  Curve<Dim> analytic_;  ///< unless there are nets
  CurveNets<Dim> nets_;
};

extern template class CurveNets<2>;
extern template class CurveNets<3>;
extern template class SectionCurve<2>;
extern template class SectionCurve<3>;

}  // namespace lamella::span
