#pragma once

#include <array>

#include "core/geometry.h"
#include "slicing/span/section_point.h"

namespace lamella::span {

/// A stretch of a section arc, x(t) and y(t) as polynomials of degree 5 over t in [0, 1], coefficients ascending.
struct ArcPiece {
  std::array<double, 6> x{};
  std::array<double, 6> y{};

  [[nodiscard]] Vec2 at(double t) const {
    return {x[0] + t * (x[1] + t * (x[2] + t * (x[3] + t * (x[4] + t * x[5])))),
            y[0] + t * (y[1] + t * (y[2] + t * (y[3] + t * (y[4] + t * y[5]))))};
  }
  /// Derivative by t.
  [[nodiscard]] Vec2 slope(double t) const;
  /// Second derivative by t.
  [[nodiscard]] Vec2 bend(double t) const;
};

/// The chord from `a` to `b`.
[[nodiscard]] ArcPiece straight_piece(const Vec2& a, const Vec2& b);

/// The same stretch run through the other way.
[[nodiscard]] ArcPiece reversed(const ArcPiece& piece);

/// How a piece was fitted between two points of a section.
struct PieceFit {
  ArcPiece piece;
  Vec2 weight = Vec2::Zero();  ///< t is proportional to weight . (u, v)
  double error = 0.0;          ///< mm: distance from the exact section in the middle; infinite if the fit is unusable

  /// Where `uv` projects to, 0 at `a` and 1 at `b`.
  [[nodiscard]] double parameter(const Vec2& from, const Vec2& to, const Vec2& uv) const {
    return weight.dot(uv - from) / weight.dot(to - from);
  }
};

/// Joins two neighbouring points of one section, both in `cell`, by the quintic that has their positions, tangents and
/// curvatures: Hermite interpolation by a parameter that is linear in (u, v), so that its derivatives at both ends are
/// exact. The error term is of order six in the step and largest in the middle, where it is measured; a piece across a
/// knot is measured at its quarters as well.
[[nodiscard]] PieceFit fit_piece(const SectionSurface& surface, const Cell& cell, const SectionPoint& a,
                                 const SectionPoint& b);

/// The same without the measurement: the piece in the plane and that in (u, v); false when the two points can't be
/// joined by one piece.
[[nodiscard]] bool join_points(const SectionPoint& a, const SectionPoint& b, ArcPiece& piece, ArcPiece& uv);

/// Whether a piece in (u, v) stays within its cell; on its outer sides the surface's last cells have room.
[[nodiscard]] bool stays_in_cell(const SectionSurface& surface, const Cell& cell, const ArcPiece& uv);

/// Parameters at which a piece is measured: where a smooth arc's error is largest, and on both sides of it where a knot
/// may lie within the piece.
inline constexpr std::array<double, 3> kMeasured{0.5, 0.25, 0.75};

/// (u, v) at parameter t of a fitted piece.
[[nodiscard]] Vec2 uv_at(const PieceFit& fit, const SectionPoint& a, const SectionPoint& b, double t);

}  // namespace lamella::span
