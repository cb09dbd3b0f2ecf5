#pragma once

#include <cstddef>
#include <span>

namespace lamella::span {

/// How many points or pieces are worked on side by side, one a lane: whole vectors of any width.
inline constexpr int kLanes = 8;

/// One quantity in every lane.
using Lane = double[kLanes];

/// What the nets of one surface have in common.
struct NetShape {
  int degree_u = 0;
  int degree_v = 0;
  bool rational = false;
  double origin[3] = {0.0, 0.0, 0.0};
};

/// Where every lane's net is evaluated, as NetPlace has it.
struct NetLanes {
  const double* net[kLanes] = {};
  Lane place_u;
  Lane scale_u;
  Lane place_v;
  Lane scale_v;
};

/// Points of a surface with derivatives: S, S_u, S_v, S_uu, S_uv, S_vv, coordinates x, y, z of each in turn.
struct JetLanes {
  Lane value[18];
};

/// Points of sections, as SectionPoint has them.
struct PointLanes {
  Lane u, v;
  Lane x, y;
  Lane tangent_x, tangent_y;
  Lane curvature;
  Lane height_u, height_v;
  Lane slope_u, slope_v;  ///< of (u, v) by arc length
  Lane bend_u, bend_v;
  Lane metric_e, metric_f, metric_g;
  Lane steepness;
};

/// Points on their way to the height z.
struct MoveLanes {
  double z = 0.0;
  double sign = 1.0;  ///< of the outward normal: +1 for S_u x S_v
  Lane u, v;          ///< where the surface was evaluated
  Lane step_u, step_v;
  Lane way_u, way_v;  ///< direction of the straight way that a point keeps to, in (u, v); zero for the steepest one
  // Found:
  Lane moved;                   ///< length of the step on the surface, mm
  Lane correction;              ///< the same of the way left to the height
  Lane velocity_u, velocity_v;  ///< d(u, v) / dz there
};

/// Neighbouring points of one section: lane i is joined to lane i + 1, the last to the point behind them.
struct RunLanes {
  using Points = double[kLanes + 1];

  Points u, v;
  Points x, y;
  Points tangent_x, tangent_y;
  Points curvature;
  Points slope_u, slope_v;
  Points bend_u, bend_v;
  Points metric_e, metric_f, metric_g;
};

/// Pieces between neighbouring points, coefficients of the quintics ascending.
struct PieceLanes {
  Lane x[6];
  Lane y[6];
  Lane u[6];
  Lane v[6];
  Lane weight_u, weight_v;  ///< t is proportional to weight . (u, v)
  Lane chord;               ///< mm
  Lane turn;                ///< cosine of the angle between the end tangents
  Lane is_even;             ///< 1 where the parameter runs forward at an even rate, else 0
  Lane middle_u, middle_v;  ///< (u, v) at t = 1/2
  Lane middle_x, middle_y;
};

/// Places of pieces at which they are measured.
struct MeasureLanes {
  double z = 0.0;
  Lane x, y;              ///< by the piece
  Lane aside_u, aside_v;  ///< direction in (u, v) in which the surface's point is moved to the height
  Lane error;             ///< found: distance from the section, mm
};

/// Carrying, joining and measuring the points of a section in the first `count` lanes; what the others hold then has no
/// meaning. Compiled for three levels of the x86-64
/// architecture, equal bytes on each (depth_kernel.h).
struct LaneKernel {
  /// Points of nets; without second derivatives unless `bends`.
  void (*jets)(const NetShape& shape, const NetLanes& nets, int count, bool bends, JetLanes& out) = nullptr;
  /// Brings points onto the height along the steepest way or a given one: what is left to go is taken from the second
  /// derivatives. The points are sections' where the corrections were short.
  void (*move)(const JetLanes& jets, int count, MoveLanes& move, PointLanes& out) = nullptr;
  /// Joins points to pieces, without a measurement.
  void (*join)(const RunLanes& points, int count, PieceLanes& out) = nullptr;
  /// Measures pieces against points of the surface at their (u, v).
  void (*measure)(const JetLanes& jets, int count, MeasureLanes& lanes) = nullptr;
  /// The same by the tangent plane, across the section: needs no direction.
  void (*distance)(const JetLanes& jets, int count, MeasureLanes& lanes) = nullptr;
};

/// The best kernel that this machine runs.
[[nodiscard]] const LaneKernel& lane_kernel();
/// All kernels that this machine runs, lowest level first, for tests.
[[nodiscard]] std::span<const LaneKernel> lane_kernels();

}  // namespace lamella::span
