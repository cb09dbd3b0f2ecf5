#include "model/step/convert_geometry.h"

#include <Geom2dConvert.hxx>
#include <Geom2dConvert_ApproxCurve.hxx>
#include <Geom2d_BSplineCurve.hxx>
#include <Geom2d_BezierCurve.hxx>
#include <Geom2d_Circle.hxx>
#include <Geom2d_Ellipse.hxx>
#include <Geom2d_Hyperbola.hxx>
#include <Geom2d_Line.hxx>
#include <Geom2d_Parabola.hxx>
#include <Geom2d_TrimmedCurve.hxx>
#include <GeomConvert.hxx>
#include <GeomConvert_ApproxCurve.hxx>
#include <GeomConvert_ApproxSurface.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Geom_BezierCurve.hxx>
#include <Geom_BezierSurface.hxx>
#include <Geom_Circle.hxx>
#include <Geom_ConicalSurface.hxx>
#include <Geom_CylindricalSurface.hxx>
#include <Geom_Ellipse.hxx>
#include <Geom_Hyperbola.hxx>
#include <Geom_Line.hxx>
#include <Geom_OffsetSurface.hxx>
#include <Geom_Parabola.hxx>
#include <Geom_Plane.hxx>
#include <Geom_RectangularTrimmedSurface.hxx>
#include <Geom_SphericalSurface.hxx>
#include <Geom_SurfaceOfLinearExtrusion.hxx>
#include <Geom_SurfaceOfRevolution.hxx>
#include <Geom_ToroidalSurface.hxx>
#include <Geom_TrimmedCurve.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <algorithm>
#include <cmath>

#include "model/bspline.h"

namespace lamella::step {
namespace {

Vec3 vec(const gp_XYZ& p) { return {p.X(), p.Y(), p.Z()}; }
Vec2 vec(const gp_XY& p) { return {p.X(), p.Y()}; }

/// Where a space curve's points and axes go; plane curves stay as they are.
struct Placed {
  const Placement& placement;
  [[nodiscard]] Vec3 point(const gp_Pnt& p) const { return placement.point(vec(p.XYZ())); }
  [[nodiscard]] Vec3 axis(const gp_Dir& d) const { return placement.direction(vec(d.XYZ())); }
};
struct InPlane {
  [[nodiscard]] Vec2 point(const gp_Pnt2d& p) const { return vec(p.XY()); }
  [[nodiscard]] Vec2 axis(const gp_Dir2d& d) const { return vec(d.XY()); }
};

std::vector<double> to_vector(const TColStd_Array1OfReal& array) { return {array.begin(), array.end()}; }

/// How many periods before and after a periodic spline's own domain are needed to cover `wanted`.
struct Periods {
  int before = 0;
  int after = 0;
};

Periods periods_to_cover(const Interval& domain, const Interval& wanted) {
  constexpr double kSlack = 1e-9;    // of a period: ends that only rounding puts outside need no further period
  constexpr double kMaxPeriods = 8;  // no sound edge or face winds round more often
  const double period = domain.length();
  const double before = std::ceil((domain.lo - wanted.lo) / period - kSlack);
  const double after = std::ceil((wanted.hi - domain.hi) / period - kSlack);
  if (!(before <= kMaxPeriods) || !(after <= kMaxPeriods))
    throw Unconvertible("a range winds round a periodic spline too often");
  return {std::max(0, static_cast<int>(before)), std::max(0, static_cast<int>(after))};
}

/// Clamped knots of one period repeated; the period's ends become knots of multiplicity `degree`.
std::vector<double> repeat_knots(const std::vector<double>& knots, int degree, const Periods& periods) {
  const double period = knots.back() - knots.front();
  std::vector<double> result(static_cast<std::size_t>(degree) + 1, knots.front() - periods.before * period);
  for (int k = -periods.before; k <= periods.after; ++k) {
    for (std::size_t i = degree + 1; i + 1 < knots.size(); ++i) result.push_back(knots[i] + k * period);
  }
  result.push_back(result.back());
  return result;
}

/// Poles (or weights) of one period repeated, each period's first being the last of the one before.
template <class T>
std::vector<T> repeat_poles(const std::vector<T>& poles, int times) {
  std::vector<T> result = poles;
  for (int k = 1; k < times; ++k) result.insert(result.end(), poles.begin() + 1, poles.end());
  return result;
}

template <int Dim>
BSplineCurve<Dim> extend(BSplineCurve<Dim> curve, const Interval& wanted) {
  const Periods periods = periods_to_cover({curve.knots.front(), curve.knots.back()}, wanted);
  const int times = 1 + periods.before + periods.after;
  if (times == 1) return curve;
  curve.knots = repeat_knots(curve.knots, curve.degree, periods);
  curve.poles = repeat_poles(curve.poles, times);
  if (!curve.weights.empty()) curve.weights = repeat_poles(curve.weights, times);
  return curve;
}

/// The same curve, not periodic and with full multiplicity at both ends.
template <class Spline>
opencascade::handle<Spline> clamp(const opencascade::handle<Spline>& source) {
  const auto clamped = [full = source->Degree() + 1](const Spline& s) {
    return !s.IsPeriodic() && s.Multiplicity(1) == full && s.Multiplicity(s.NbKnots()) == full;
  };
  if (clamped(*source)) return source;
  const auto copy = opencascade::handle<Spline>::DownCast(source->Copy());
  const double first = copy->FirstParameter();
  const double last = copy->LastParameter();
  if (copy->IsPeriodic()) copy->SetNotPeriodic();
  if (!clamped(*copy)) copy->Segment(first, last);
  return copy;
}

/// B-spline of either dimension. `Spline` is Geom_BSplineCurve or Geom2d_BSplineCurve.
template <int Dim, class Spline, class Place>
BSplineCurve<Dim> convert_spline(const opencascade::handle<Spline>& source, const Place& place, const Interval& range) {
  const bool periodic = source->IsPeriodic();
  const auto spline = clamp<Spline>(source);
  BSplineCurve<Dim> result;
  result.degree = spline->Degree();
  result.knots = to_vector(spline->KnotSequence());
  for (int i = 1; i <= spline->NbPoles(); ++i) {
    result.poles.push_back(place.point(spline->Pole(i)));
    if (spline->IsRational()) result.weights.push_back(spline->Weight(i));
  }
  check_limits(result);
  return periodic ? extend(std::move(result), range) : result;
}

}  // namespace

Placement placement_of(const gp_Trsf& trsf) {
  Placement placement;
  const gp_Mat m = trsf.VectorialPart();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) placement.linear(i, j) = m.Value(i + 1, j + 1);
  }
  placement.translation = vec(trsf.TranslationPart());
  if (!placement.translation.allFinite()) throw Unconvertible("a placement is infinite or not a number");
  return placement;
}

Curve3 convert_curve(const Handle(Geom_Curve) & curve, const Placement& placement, const Interval& range,
                     double tolerance) {
  const Placed place{placement};
  if (const auto c = Handle(Geom_TrimmedCurve)::DownCast(curve)) {
    return convert_curve(c->BasisCurve(), placement, range, tolerance);
  }
  if (const auto c = Handle(Geom_Line)::DownCast(curve)) {
    return Line<3>{place.point(c->Position().Location()), place.axis(c->Position().Direction())};
  }
  if (const auto c = Handle(Geom_BSplineCurve)::DownCast(curve)) return convert_spline<3>(c, place, range);
  if (Handle(Geom_BezierCurve)::DownCast(curve)) {
    return convert_spline<3>(GeomConvert::CurveToBSplineCurve(curve), place, range);
  }
  if (const auto conic = Handle(Geom_Conic)::DownCast(curve)) {
    const Vec3 center = place.point(conic->Location());
    const Vec3 x = place.axis(conic->XAxis().Direction());
    const Vec3 y = place.axis(conic->YAxis().Direction());
    if (const auto c = Handle(Geom_Circle)::DownCast(curve))
      return Ellipse<3>{center, c->Radius() * x, c->Radius() * y};
    if (const auto c = Handle(Geom_Ellipse)::DownCast(curve)) {
      return Ellipse<3>{center, c->MajorRadius() * x, c->MinorRadius() * y};
    }
    if (const auto c = Handle(Geom_Hyperbola)::DownCast(curve)) {
      return Hyperbola<3>{center, c->MajorRadius() * x, c->MinorRadius() * y};
    }
    if (const auto c = Handle(Geom_Parabola)::DownCast(curve)) return Parabola<3>{center, x / (4.0 * c->Focal()), y};
  }
  GeomConvert_ApproxCurve fit(new Geom_TrimmedCurve(curve, range.lo, range.hi), tolerance, GeomAbs_C1, 1000, 9);
  if (!fit.HasResult()) throw Unconvertible("a curve could not be fitted by a B-spline");
  return convert_spline<3>(fit.Curve(), place, range);
}

Curve2 convert_curve(const Handle(Geom2d_Curve) & curve, const Interval& range, double tolerance) {
  const InPlane place;
  if (const auto c = Handle(Geom2d_TrimmedCurve)::DownCast(curve)) {
    return convert_curve(c->BasisCurve(), range, tolerance);
  }
  if (const auto c = Handle(Geom2d_Line)::DownCast(curve))
    return Line<2>{vec(c->Location().XY()), vec(c->Direction().XY())};
  if (const auto c = Handle(Geom2d_BSplineCurve)::DownCast(curve)) return convert_spline<2>(c, place, range);
  if (Handle(Geom2d_BezierCurve)::DownCast(curve)) {
    return convert_spline<2>(Geom2dConvert::CurveToBSplineCurve(curve), place, range);
  }
  if (const auto conic = Handle(Geom2d_Conic)::DownCast(curve)) {
    const Vec2 center = place.point(conic->Location());
    const Vec2 x = place.axis(conic->XAxis().Direction());
    const Vec2 y = place.axis(conic->YAxis().Direction());
    if (const auto c = Handle(Geom2d_Circle)::DownCast(curve))
      return Ellipse<2>{center, c->Radius() * x, c->Radius() * y};
    if (const auto c = Handle(Geom2d_Ellipse)::DownCast(curve)) {
      return Ellipse<2>{center, c->MajorRadius() * x, c->MinorRadius() * y};
    }
    if (const auto c = Handle(Geom2d_Hyperbola)::DownCast(curve)) {
      return Hyperbola<2>{center, c->MajorRadius() * x, c->MinorRadius() * y};
    }
    if (const auto c = Handle(Geom2d_Parabola)::DownCast(curve)) return Parabola<2>{center, x / (4.0 * c->Focal()), y};
  }
  Geom2dConvert_ApproxCurve fit(new Geom2d_TrimmedCurve(curve, range.lo, range.hi), tolerance, GeomAbs_C1, 1000, 9);
  if (!fit.HasResult()) throw Unconvertible("a curve on a surface could not be fitted by a B-spline");
  return convert_spline<2>(fit.Curve(), place, range);
}

namespace {

Frame convert_frame(const gp_Ax3& axes, const Placement& placement) {
  const Placed place{placement};
  return {place.point(axes.Location()), place.axis(axes.XDirection()), place.axis(axes.YDirection()),
          place.axis(axes.Direction())};
}

/// Repeats the rows (i) of a surface that is periodic in u.
BSplineSurface extend_u(BSplineSurface s, const Interval& wanted) {
  const Periods periods = periods_to_cover(s.domain_u(), wanted);
  const int times = 1 + periods.before + periods.after;
  if (times == 1) return s;
  s.knots_u = repeat_knots(s.knots_u, s.degree_u, periods);
  const auto repeat_rows = [&s, times](const auto& values) {
    auto result = values;
    for (int k = 1; k < times; ++k) result.insert(result.end(), values.begin() + s.count_v, values.end());
    return result;
  };
  s.poles = repeat_rows(s.poles);
  if (!s.weights.empty()) s.weights = repeat_rows(s.weights);
  s.count_u = times * (s.count_u - 1) + 1;
  return s;
}

BSplineSurface swap_uv(const BSplineSurface& s) {
  BSplineSurface t{s.degree_v, s.degree_u, s.count_v, s.count_u, s.knots_v, s.knots_u, {}, {}};
  for (int j = 0; j < s.count_v; ++j) {
    for (int i = 0; i < s.count_u; ++i) {
      t.poles.push_back(s.poles[i * s.count_v + j]);
      if (!s.weights.empty()) t.weights.push_back(s.weights[i * s.count_v + j]);
    }
  }
  return t;
}

/// The same surface, not periodic and with full multiplicity at all ends.
Handle(Geom_BSplineSurface) clamp(const Handle(Geom_BSplineSurface) & source) {
  const auto full = [](int first, int last, int degree) { return first == degree + 1 && last == degree + 1; };
  const auto clamped = [&full](const Geom_BSplineSurface& s) {
    return full(s.UMultiplicity(1), s.UMultiplicity(s.NbUKnots()), s.UDegree()) &&
           full(s.VMultiplicity(1), s.VMultiplicity(s.NbVKnots()), s.VDegree());
  };
  if (!source->IsUPeriodic() && !source->IsVPeriodic() && clamped(*source)) return source;
  const auto copy = Handle(Geom_BSplineSurface)::DownCast(source->Copy());
  if (copy->IsUPeriodic()) copy->SetUNotPeriodic();
  if (copy->IsVPeriodic()) copy->SetVNotPeriodic();
  if (!clamped(*copy)) {
    double u_lo = 0.0, u_hi = 0.0, v_lo = 0.0, v_hi = 0.0;
    copy->Bounds(u_lo, u_hi, v_lo, v_hi);
    copy->Segment(u_lo, u_hi, v_lo, v_hi);
  }
  return copy;
}

BSplineSurface convert_spline_surface(const Handle(Geom_BSplineSurface) & source, const Placement& placement,
                                      const Box2& uv) {
  const bool periodic_u = source->IsUPeriodic();
  const bool periodic_v = source->IsVPeriodic();
  const auto spline = clamp(source);
  BSplineSurface result{spline->UDegree(),
                        spline->VDegree(),
                        spline->NbUPoles(),
                        spline->NbVPoles(),
                        to_vector(spline->UKnotSequence()),
                        to_vector(spline->VKnotSequence()),
                        {},
                        {}};
  const bool rational = spline->IsURational() || spline->IsVRational();
  result.poles.reserve(static_cast<std::size_t>(result.count_u) * result.count_v);
  for (int i = 1; i <= result.count_u; ++i) {
    for (int j = 1; j <= result.count_v; ++j) {
      result.poles.push_back(placement.point(vec(spline->Pole(i, j).XYZ())));
      if (rational) result.weights.push_back(spline->Weight(i, j));
    }
  }
  check_limits(result);
  if (periodic_u && !uv.isEmpty()) result = extend_u(std::move(result), {uv.min().x(), uv.max().x()});
  if (periodic_v && !uv.isEmpty()) result = swap_uv(extend_u(swap_uv(result), {uv.min().y(), uv.max().y()}));
  return result;
}

/// Largest distance between the surfaces at equal parameters, on a grid finer than any fit's own test points.
double measure_fit(const Geom_Surface& exact, const Geom_Surface& fit, const Box2& uv) {
  constexpr int kSamples = 61;
  double worst = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    for (int j = 0; j < kSamples; ++j) {
      const double u = uv.min().x() + uv.sizes().x() * i / (kSamples - 1);
      const double v = uv.min().y() + uv.sizes().y() * j / (kSamples - 1);
      worst = std::max(worst, exact.Value(u, v).Distance(fit.Value(u, v)));
    }
  }
  return worst;
}

FittedSurface fit_surface(const Handle(Geom_Surface) & surface, const Placement& placement, const Box2& uv) {
  if (uv.isEmpty()) throw Unconvertible("a surface without an exact form has no bounds to fit it in");
  double u_lo = 0.0, u_hi = 0.0, v_lo = 0.0, v_hi = 0.0;
  surface->Bounds(u_lo, u_hi, v_lo, v_hi);
  // The fit covers the trims; the source may end there, so it is only enlarged where it goes on.
  const Box2 domain{Vec2{surface->IsUPeriodic() ? uv.min().x() : std::max(u_lo, uv.min().x()),
                         surface->IsVPeriodic() ? uv.min().y() : std::max(v_lo, uv.min().y())},
                    Vec2{surface->IsUPeriodic() ? uv.max().x() : std::min(u_hi, uv.max().x()),
                         surface->IsVPeriodic() ? uv.max().y() : std::min(v_hi, uv.max().y())}};
  if (!(domain.sizes().minCoeff() > 0.0)) throw Unconvertible("the trims lie outside the surface");
  const Handle(Geom_Surface) patch = new Geom_RectangularTrimmedSurface(surface, domain.min().x(), domain.max().x(),
                                                                        domain.min().y(), domain.max().y());
  for (const double tolerance : {1e-7, 1e-5, 1e-3}) {
    GeomConvert_ApproxSurface fit(patch, tolerance, GeomAbs_C1, GeomAbs_C1, 9, 9, 400, 1);
    if (!fit.HasResult()) continue;
    const double bound = measure_fit(*surface, *fit.Surface(), domain);
    if (bound > 10.0 * tolerance) continue;
    // Twice the largest sampled distance: the samples needn't meet the extremum.
    return {convert_spline_surface(fit.Surface(), placement, domain), std::max(2.0 * bound, 1e-12),
            surface->IsKind(STANDARD_TYPE(Geom_OffsetSurface)) ? "offset surface" : surface->DynamicType()->Name()};
  }
  throw Unconvertible("an offset surface could not be fitted within 1e-3 mm");
}

/// Planes and quadrics, tori: everything given by axes and radii.
Surface convert_elementary(const Handle(Geom_ElementarySurface) & surface, const Placement& placement) {
  const Frame frame = convert_frame(surface->Position(), placement);
  if (const auto s = Handle(Geom_CylindricalSurface)::DownCast(surface)) return Cylinder{frame, s->Radius()};
  if (const auto s = Handle(Geom_ConicalSurface)::DownCast(surface)) return Cone{frame, s->RefRadius(), s->SemiAngle()};
  if (const auto s = Handle(Geom_SphericalSurface)::DownCast(surface)) return Sphere{frame, s->Radius()};
  if (const auto s = Handle(Geom_ToroidalSurface)::DownCast(surface)) {
    return Torus{frame, s->MajorRadius(), s->MinorRadius()};
  }
  if (Handle(Geom_Plane)::DownCast(surface)) return Plane{frame};
  throw Unconvertible(std::string("unknown elementary surface ") + surface->DynamicType()->Name());
}

}  // namespace

Surface convert_surface(const Handle(Geom_Surface) & surface, const Placement& placement, const Box2& uv) {
  if (const auto s = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface)) {
    return convert_surface(s->BasisSurface(), placement, uv);
  }
  if (const auto s = Handle(Geom_ElementarySurface)::DownCast(surface)) return convert_elementary(s, placement);
  if (const auto s = Handle(Geom_BSplineSurface)::DownCast(surface)) return convert_spline_surface(s, placement, uv);
  if (Handle(Geom_BezierSurface)::DownCast(surface)) {
    return convert_spline_surface(GeomConvert::SurfaceToBSplineSurface(surface), placement, uv);
  }
  const Placed place{placement};
  if (const auto s = Handle(Geom_SurfaceOfLinearExtrusion)::DownCast(surface)) {
    const Interval range{uv.min().x(), uv.max().x()};
    return Extrusion{convert_curve(s->BasisCurve(), placement, range), place.axis(s->Direction())};
  }
  if (const auto s = Handle(Geom_SurfaceOfRevolution)::DownCast(surface)) {
    // A mirror turns the sense of rotation, so the axis vector changes sign on top of being mirrored.
    const double sense = placement.mirrors() ? -1.0 : 1.0;
    const Interval range{uv.min().y(), uv.max().y()};
    return Revolution{convert_curve(s->BasisCurve(), placement, range), place.point(s->Location()),
                      sense * place.axis(s->Direction())};
  }
  if (const auto s = Handle(Geom_OffsetSurface)::DownCast(surface)) {
    // The offset of a plane, quadric or torus is one again, over the same parameters.
    if (const auto same = s->Surface(); !same.IsNull() && !same->IsKind(STANDARD_TYPE(Geom_OffsetSurface))) {
      return convert_surface(same, placement, uv);
    }
  }
  return fit_surface(surface, placement, uv);
}

bool is_plane(const Handle(Geom_Surface) & surface) {
  if (const auto s = Handle(Geom_RectangularTrimmedSurface)::DownCast(surface)) return is_plane(s->BasisSurface());
  return !Handle(Geom_Plane)::DownCast(surface).IsNull();
}

Curve2 project_onto(const Plane& plane, const Curve3& curve) {
  const Frame& f = plane.frame;
  const auto axis = [&f](const Vec3& d) { return Vec2{d.dot(f.x), d.dot(f.y)}; };
  const auto point = [&f, &axis](const Vec3& p) { return axis(p - f.origin); };
  struct Visitor {
    const decltype(axis)& axis_;
    const decltype(point)& point_;
    Curve2 operator()(const Line<3>& c) const { return Line<2>{point_(c.origin), axis_(c.direction)}; }
    Curve2 operator()(const Ellipse<3>& c) const {
      return Ellipse<2>{point_(c.center), axis_(c.major), axis_(c.minor)};
    }
    Curve2 operator()(const Parabola<3>& c) const {
      return Parabola<2>{point_(c.apex), axis_(c.axis), axis_(c.tangent)};
    }
    Curve2 operator()(const Hyperbola<3>& c) const {
      return Hyperbola<2>{point_(c.center), axis_(c.major), axis_(c.minor)};
    }
    Curve2 operator()(const BSplineCurve<3>& c) const {
      BSplineCurve<2> result{c.degree, c.knots, {}, c.weights};
      for (const Vec3& pole : c.poles) result.poles.push_back(point_(pole));
      return result;
    }
  };
  return std::visit(Visitor{axis, point}, curve);
}

}  // namespace lamella::step
