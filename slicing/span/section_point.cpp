#include "slicing/span/section_point.h"

namespace lamella::span {

SectionPoint section_point(const SurfacePoint2& at, const Vec2& uv, double sign) {
  SectionPoint point;
  point.uv = uv;
  point.xy = at.point.head<2>();
  point.z = at.point.z();
  point.height_slope = Vec2(at.du.z(), at.dv.z());
  const Vec3 normal = sign * at.normal();
  const double horizontal = normal.head<2>().norm();
  const double inverse = 1.0 / horizontal;
  // z x n = S_u z_v - S_v z_u for n = S_u x S_v.
  point.tangent = Vec2(-normal.y(), normal.x()) * inverse;
  point.uv_slope = Vec2(at.dv.z(), -at.du.z()) * (sign * inverse);
  const double du = point.uv_slope[0];
  const double dv = point.uv_slope[1];
  const Vec3 bend = at.duu * (du * du) + at.duv * (2.0 * du * dv) + at.dvv * (dv * dv);
  // The second derivative by s is horizontal and normal to the tangent: k (z x t), and n . (z x t) = -|n_h|.
  point.curvature = -normal.dot(bend) * inverse;
  const Vec3 rest = Vec3(-point.tangent.y() * point.curvature, point.tangent.x() * point.curvature, 0.0) - bend;
  const double e = at.du.squaredNorm();
  const double f = at.du.dot(at.dv);
  const double g = at.dv.squaredNorm();
  const double determinant = e * g - f * f;
  const double a = at.du.dot(rest);
  const double b = at.dv.dot(rest);
  point.uv_bend = Vec2(g * a - f * b, e * b - f * a) / determinant;
  point.metric[0] = e;
  point.metric[1] = f;
  point.metric[2] = g;
  point.steepness = horizontal / std::sqrt(determinant);
  return point;
}

Vec2 steepest_step(const SurfacePoint& at, double dz) {
  const double e = at.du.squaredNorm();
  const double f = at.du.dot(at.dv);
  const double g = at.dv.squaredNorm();
  // The metric gradient of z, times its determinant.
  const Vec2 gradient(g * at.du.z() - f * at.dv.z(), e * at.dv.z() - f * at.du.z());
  const double slope = at.du.z() * gradient[0] + at.dv.z() * gradient[1];
  return gradient * (dz / slope);
}

Vec2 rise_of(const SectionPoint& at, int fixed_axis) {
  Vec2 step = Vec2::Zero();
  if (fixed_axis >= 0) {
    step[1 - fixed_axis] = 1.0 / at.height_slope[1 - fixed_axis];
    return step;
  }
  step = Vec2(at.metric[2] * at.height_slope[0] - at.metric[1] * at.height_slope[1],
              at.metric[0] * at.height_slope[1] - at.metric[1] * at.height_slope[0]);
  return step / step.dot(at.height_slope);
}

std::optional<SectionPoint> correct(const SectionSurface& surface, const Cell& cell, Vec2 uv, double z, double sign,
                                    int fixed_axis, const CorrectLimits& limits) {
  constexpr int kMaxSteps = 12;
  double travelled = 0.0;
  double last_error = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const SurfacePoint2 at = surface.evaluate(uv, cell);
    const double dz = z - at.point.z();
    const bool stalls = i > 2 && std::abs(dz) >= 0.5 * last_error;
    if (std::abs(dz) <= limits.height || (stalls && std::abs(dz) <= 1e3 * limits.height)) {
      const SectionPoint point = section_point(at, uv, sign);
      if (!point.uv_bend.allFinite() || !std::isfinite(point.curvature)) return std::nullopt;
      return point;
    }
    last_error = std::abs(dz);
    Vec2 step = Vec2::Zero();
    if (fixed_axis < 0) {
      step = steepest_step(at, dz);
    } else {
      const int free_axis = 1 - fixed_axis;
      step[free_axis] = dz / (free_axis == 0 ? at.du.z() : at.dv.z());
    }
    travelled += (at.du * step[0] + at.dv * step[1]).norm();
    if (!(travelled <= limits.reach)) return std::nullopt;  // NaN too
    uv += step;
  }
  return std::nullopt;
}

}  // namespace lamella::span
