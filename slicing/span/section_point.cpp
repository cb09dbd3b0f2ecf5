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

namespace {

Vec2 step_to(const SurfacePoint& at, double dz, int fixed_axis) {
  if (fixed_axis < 0) return steepest_step(at, dz);
  Vec2 step = Vec2::Zero();
  step[1 - fixed_axis] = dz / (fixed_axis == 0 ? at.dv.z() : at.du.z());
  return step;
}

}  // namespace

void shift(SurfacePoint2& at, const Vec2& step) {
  const double u = step[0];
  const double v = step[1];
  at.point += at.du * u + at.dv * v + at.duu * (0.5 * u * u) + at.duv * (u * v) + at.dvv * (0.5 * v * v);
  const Vec3 du = at.duu * u + at.duv * v;
  const Vec3 dv = at.duv * u + at.dvv * v;
  at.du += du;
  at.dv += dv;
}

std::optional<SectionPoint> correct(const SectionSurface& surface, const Cell& cell, Vec2 uv, double z, double sign,
                                    int fixed_axis, const CorrectLimits& limits, const SurfacePoint2* known) {
  constexpr int kMaxSteps = 12;
  // Steps this short are taken from the second derivatives: what they leave out is of third order.
  const double exact = 1e-4 * limits.reach;
  double travelled = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    // From elsewhere the first step is hardly ever the last.
    const bool is_far = i == 0 && known == nullptr;
    SurfacePoint2 at;
    if (i == 0 && known != nullptr) {
      at = *known;
    } else if (is_far) {
      static_cast<SurfacePoint&>(at) = surface.evaluate_slopes(uv, cell);
    } else {
      at = surface.evaluate(uv, cell);
    }
    const Vec2 step = step_to(at, z - at.point.z(), fixed_axis);
    const double length = (at.du * step[0] + at.dv * step[1]).norm();
    travelled += length;
    if (!(travelled <= limits.reach)) return std::nullopt;  // NaN too
    uv += step;
    if (is_far || length > exact) continue;
    shift(at, step);
    SectionPoint point = section_point(at, uv, sign);
    if (!point.uv_bend.allFinite() || !std::isfinite(point.curvature)) return std::nullopt;
    return point;
  }
  return std::nullopt;
}

}  // namespace lamella::span
