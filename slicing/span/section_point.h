#pragma once

#include <cmath>
#include <optional>

#include "core/geometry.h"
#include "slicing/span/section_surface.h"

namespace lamella::span {

/// A point of a section z = const of one face, with what the section does there. The section runs along z x n, n the
/// solid's outward normal, so that material lies to its left.
struct SectionPoint {
  Vec2 uv = Vec2::Zero();
  Vec2 xy = Vec2::Zero();
  double z = 0.0;
  Vec2 tangent = Vec2::Zero();         ///< unit length, along the run
  double curvature = 0.0;              ///< 1/mm, positive where the section turns left
  Vec2 height_slope = Vec2::Zero();    ///< S_u.z, S_v.z
  Vec2 uv_slope = Vec2::Zero();        ///< d(u, v) / ds, s the arc length
  Vec2 uv_bend = Vec2::Zero();         ///< its derivative by s
  double metric[3] = {0.0, 0.0, 0.0};  ///< S_u.S_u, S_u.S_v, S_v.S_v
  double steepness = 0.0;              ///< sine of the angle between the face and the horizontal: |n_h| / |n|
};

/// `sign` is +1 where the outward normal is S_u x S_v, else -1. Not finite where the face is horizontal or has no
/// normal.
[[nodiscard]] SectionPoint section_point(const SurfacePoint2& at, const Vec2& uv, double sign);

/// A step in (u, v) that changes z by `dz` and is the shortest such on the surface.
[[nodiscard]] Vec2 steepest_step(const SurfacePoint& at, double dz);

/// The same from a point that has been evaluated, for dz = 1; along the line u = const (axis 0) or v = const (1) if the
/// point is fixed to one.
[[nodiscard]] Vec2 rise_of(const SectionPoint& at, int fixed_axis);

/// Length on the surface of a step in (u, v).
[[nodiscard]] inline double length_of(const SectionPoint& at, const Vec2& step) {
  const double square =
      at.metric[0] * step[0] * step[0] + 2.0 * at.metric[1] * step[0] * step[1] + at.metric[2] * step[1] * step[1];
  return std::sqrt(square > 0.0 ? square : 0.0);
}

/// Moves a point of the surface by a step in (u, v) as its second derivatives say: position to second order, first
/// derivatives to first.
void shift(SurfacePoint2& at, const Vec2& step);

/// Where to stop a correction.
struct CorrectLimits {
  double reach = 0.0;  ///< mm on the surface: largest distance from the start of the correction
};

/// The point of the section at height z near `uv`, by Newton's iteration along the steepest way, or along the line
/// u = const (fixed_axis 0) or v = const (1). Nothing if it strays beyond the reach or doesn't converge. `known` is the
/// surface at the start, if it has been evaluated: what lies there already needs no more.
[[nodiscard]] std::optional<SectionPoint> correct(const SectionSurface& surface, const Cell& cell, Vec2 uv, double z,
                                                  double sign, int fixed_axis, const CorrectLimits& limits,
                                                  const SurfacePoint2* known = nullptr);

}  // namespace lamella::span
