#include "slicing/span/section_lanes.h"

#include <cmath>
#include <limits>

namespace lamella::span {

namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// Corrections up to this share of a piece are taken from the second derivatives.
constexpr double kExactShift = 1e-4;

void put_point(const PointLanes& lanes, int i, double z, SectionPoint& point) {
  point.uv = {lanes.u[i], lanes.v[i]};
  point.xy = {lanes.x[i], lanes.y[i]};
  point.z = z;
  point.tangent = {lanes.tangent_x[i], lanes.tangent_y[i]};
  point.curvature = lanes.curvature[i];
  point.height_slope = {lanes.height_u[i], lanes.height_v[i]};
  point.uv_slope = {lanes.slope_u[i], lanes.slope_v[i]};
  point.uv_bend = {lanes.bend_u[i], lanes.bend_v[i]};
  point.metric[0] = lanes.metric_e[i];
  point.metric[1] = lanes.metric_f[i];
  point.metric[2] = lanes.metric_g[i];
  point.steepness = lanes.steepness[i];
}

void set_point(const SectionPoint& point, int i, RunLanes& lanes) {
  lanes.u[i] = point.uv[0];
  lanes.v[i] = point.uv[1];
  lanes.x[i] = point.xy[0];
  lanes.y[i] = point.xy[1];
  lanes.tangent_x[i] = point.tangent[0];
  lanes.tangent_y[i] = point.tangent[1];
  lanes.curvature[i] = point.curvature;
  lanes.slope_u[i] = point.uv_slope[0];
  lanes.slope_v[i] = point.uv_slope[1];
  lanes.bend_u[i] = point.uv_bend[0];
  lanes.bend_v[i] = point.uv_bend[1];
  lanes.metric_e[i] = point.metric[0];
  lanes.metric_f[i] = point.metric[1];
  lanes.metric_g[i] = point.metric[2];
}

/// Points under way, those not yet found in the first lanes.
class Movers {
 public:
  Movers(const SectionSurface& surface, double sign, double z, const MoveLimits& limits, std::span<MovingPoint> points)
      : surface_(surface), limits_(limits), points_(points) {
    lanes_.z = z;
    lanes_.sign = sign;
    for (std::size_t i = 0; i < points.size(); ++i) pending_[i] = static_cast<int>(i);
    count_ = static_cast<int>(points.size());
  }

  void run() {
    for (int round = 0; round < limits_.rounds && count_ > 0; ++round) {
      evaluate();
      const int evaluated = count_;
      count_ = 0;
      for (int lane = 0; lane < evaluated; ++lane) settle(lane, round);
    }
  }

 private:
  void evaluate() {
    std::array<CellPlace, kLanes> places;
    for (int lane = 0; lane < count_; ++lane) {
      const MovingPoint& point = points_[static_cast<std::size_t>(pending_[lane])];
      places[static_cast<std::size_t>(lane)] = point.at;
      lanes_.u[lane] = point.at.uv[0];
      lanes_.v[lane] = point.at.uv[1];
      lanes_.step_u[lane] = point.step[0];
      lanes_.step_v[lane] = point.step[1];
      lanes_.way_u[lane] = point.way[0];
      lanes_.way_v[lane] = point.way[1];
    }
    JetLanes jets;
    surface_.evaluate_lanes({places.data(), static_cast<std::size_t>(count_)}, true, jets);
    lane_kernel().move(jets, count_, lanes_, found_);
  }

  /// Keeps what was found in a lane, or has it evaluated again.
  void settle(int lane, int round) {
    const int number = pending_[lane];
    MovingPoint& point = points_[static_cast<std::size_t>(number)];
    const double off = lanes_.correction[lane];
    // Written so that NaN fails.
    if (!(off <= limits_.reach * point.scale)) return;
    if (round == 0 && limits_.share > 0.0 && !(off <= limits_.share * lanes_.moved[lane])) return;
    point.at.uv = {found_.u[lane], found_.v[lane]};
    if (off > kExactShift * point.scale) {
      pending_[count_++] = number;
      return;
    }
    put_point(found_, lane, lanes_.z, *point.point);
    point.velocity = {lanes_.velocity_u[lane], lanes_.velocity_v[lane]};
    point.found = point.point->uv_bend.allFinite();
  }

  const SectionSurface& surface_;
  const MoveLimits& limits_;
  std::span<MovingPoint> points_;
  std::array<int, kLanes> pending_{};
  int count_ = 0;
  MoveLanes lanes_;
  PointLanes found_;
};

/// Pieces being measured, as many as there are lanes at a time.
class Measurer {
 public:
  Measurer(const SectionSurface& surface, const PieceLanes& pieces, double z, std::array<double, kLanes>& errors)
      : surface_(surface), pieces_(pieces), errors_(errors) {
    lanes_.z = z;
  }

  void add_middle(int piece, const Cell& cell) {
    add(piece, {{pieces_.middle_u[piece], pieces_.middle_v[piece]}, cell},
        {pieces_.middle_x[piece], pieces_.middle_y[piece]});
  }

  void add(int piece, const CellPlace& place, const Vec2& xy) {
    places_[static_cast<std::size_t>(count_)] = place;
    numbers_[static_cast<std::size_t>(count_)] = piece;
    lanes_.x[count_] = xy[0];
    lanes_.y[count_] = xy[1];
    lanes_.aside_u[count_] = -pieces_.weight_v[piece];
    lanes_.aside_v[count_] = pieces_.weight_u[piece];
    if (++count_ == kLanes) flush();
  }

  void flush() {
    if (count_ == 0) return;
    const auto count = static_cast<std::size_t>(count_);
    JetLanes jets;
    surface_.evaluate_lanes({places_.data(), count}, false, jets);
    lane_kernel().measure(jets, count_, lanes_);
    for (std::size_t i = 0; i < count; ++i) {
      double& error = errors_[static_cast<std::size_t>(numbers_[i])];
      if (!(lanes_.error[i] <= error)) error = lanes_.error[i];  // keeps NaN
    }
    count_ = 0;
  }

 private:
  const SectionSurface& surface_;
  const PieceLanes& pieces_;
  std::array<double, kLanes>& errors_;
  int count_ = 0;
  std::array<CellPlace, kLanes> places_;
  std::array<int, kLanes> numbers_{};
  MeasureLanes lanes_;
};

ArcPiece piece_of(const Lane (&first)[6], const Lane (&second)[6], std::size_t i) {
  ArcPiece piece;
  for (std::size_t k = 0; k < 6; ++k) {
    piece.x[k] = first[k][i];
    piece.y[k] = second[k][i];
  }
  return piece;
}

void join_lanes(const PointRun& run, double largest_turn, PieceLanes& lanes, PieceFits& fits) {
  RunLanes points;
  const auto pieces = static_cast<int>(run.pieces());
  for (int i = 0; i <= pieces; ++i) set_point(run.point(static_cast<std::size_t>(i)), i, points);
  lane_kernel().join(points, pieces, lanes);
  const double least = std::cos(largest_turn);
  for (std::size_t i = 0; i < run.pieces(); ++i) {
    fits.pieces[i] = piece_of(lanes.x, lanes.y, i);
    fits.errors[i] = lanes.turn[i] > least && lanes.is_even[i] == 1.0 ? 0.0 : kInfinite;
  }
}

}  // namespace

void move_points(const SectionSurface& surface, double sign, double z, const MoveLimits& limits,
                 std::span<MovingPoint> points) {
  Movers(surface, sign, z, limits, points).run();
}

bool PointRun::add(const Cell& cell, const SectionPoint& next, const Cell& next_cell) {
  cells_[count_] = cell;
  points_[++count_] = &next;
  if (next_cell == cell) return count_ < kLanes;
  last_ = section_point(surface_->evaluate(next.uv, cell), next.uv, sign_);
  last_.z = next.z;
  points_[count_] = &last_;
  return false;
}

void join_run(const PointRun& run, double largest_turn, PieceFits& fits) {
  PieceLanes lanes;
  join_lanes(run, largest_turn, lanes, fits);
  for (std::size_t i = 0; i < run.pieces(); ++i) fits.uv[i] = piece_of(lanes.u, lanes.v, i);
}

void fit_run(const PointRun& run, const FitLimits& limits, PieceFits& fits) {
  PieceLanes lanes;
  join_lanes(run, limits.turn, lanes, fits);
  const SectionSurface& surface = run.surface();
  Measurer measurer(surface, lanes, run.point(0).z, fits.errors);
  for (std::size_t i = 0; i < run.pieces(); ++i) {
    if (fits.errors[i] != 0.0) continue;
    const Cell& cell = run.cell(i);
    const bool crosses = surface.crosses_knot(run.point(i).uv, run.point(i + 1).uv, cell);
    if (crosses || surface.is_divided()) {
      const ArcPiece uv = piece_of(lanes.u, lanes.v, i);
      if (!stays_in_cell(surface, cell, uv)) {
        fits.errors[i] = kInfinite;
        continue;
      }
      for (std::size_t m = 1; crosses && m < kMeasured.size(); ++m) {
        measurer.add(static_cast<int>(i), {uv.at(kMeasured[m]), cell}, fits.pieces[i].at(kMeasured[m]));
      }
    }
    measurer.add_middle(static_cast<int>(i), cell);
  }
  measurer.flush();
  for (std::size_t i = 0; i < run.pieces(); ++i) {
    if (!(fits.errors[i] <= 0.1 * lanes.chord[i])) fits.errors[i] = kInfinite;  // NaN too
    if (fits.errors[i] > limits.accepted) fits.uv[i] = piece_of(lanes.u, lanes.v, i);
  }
}

void DistanceMeter::add(const CellPlace& place, const Vec2& xy) {
  places_[count_] = place;
  lanes_.x[count_] = xy[0];
  lanes_.y[count_] = xy[1];
  if (++count_ == kLanes) flush();
}

double DistanceMeter::largest() {
  if (count_ > 0) flush();
  return largest_;
}

void DistanceMeter::flush() {
  JetLanes jets;
  surface_->evaluate_lanes({places_.data(), count_}, false, jets);
  lane_kernel().distance(jets, static_cast<int>(count_), lanes_);
  for (std::size_t i = 0; i < count_; ++i) {
    if (!(lanes_.error[i] <= largest_)) largest_ = lanes_.error[i];  // keeps NaN
  }
  count_ = 0;
}

}  // namespace lamella::span
