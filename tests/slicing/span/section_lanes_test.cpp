/// Points and pieces worked on side by side against the same one by one; and arcs that are carried from layer to layer
/// against the surface.

#include "slicing/span/section_lanes.h"

#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "slicing/span/propagate.h"
#include "slicing/span/tracer.h"

namespace lamella::span {
namespace {

std::vector<double> uniform_knots(int degree, int count) {
  std::vector<double> knots(static_cast<std::size_t>(degree), 0.0);
  for (int i = 0; i <= count - degree; ++i) knots.push_back(static_cast<double>(i) / (count - degree));
  knots.insert(knots.end(), static_cast<std::size_t>(degree), 1.0);
  return knots;
}

/// A leaning wall over (u, v), 10 mm along u and `height` along v, bent by `bulge(u, v)`.
BSplineSurface wall(int degree_u, int degree_v, int count, double height,
                    const std::function<double(double, double)>& bulge) {
  BSplineSurface surface;
  surface.degree_u = degree_u;
  surface.degree_v = degree_v;
  surface.count_u = surface.count_v = count;
  surface.knots_u = uniform_knots(degree_u, count);
  surface.knots_v = uniform_knots(degree_v, count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j < count; ++j) {
      const double u = static_cast<double>(i) / (count - 1);
      const double v = static_cast<double>(j) / (count - 1);
      surface.poles.emplace_back(10.0 * u, 2.0 * v + bulge(u, v), height * v + 0.3 * std::sin(3.0 * u));
    }
  }
  return surface;
}

double gentle(double u, double v) { return std::sin(4.0 * u) + 0.5 * std::cos(3.0 * v + 2.0 * u); }

std::vector<Surface> surfaces() {
  std::vector<Surface> all;
  all.emplace_back(wall(3, 3, 9, 8.0, gentle));
  all.emplace_back(wall(5, 3, 11, 8.0, gentle));
  all.emplace_back(wall(2, 4, 8, 8.0, gentle));
  BSplineSurface rational = wall(3, 2, 7, 8.0, gentle);
  for (std::size_t i = 0; i < rational.poles.size(); ++i) {
    rational.weights.push_back(1.0 + 0.3 * std::sin(static_cast<double>(i)));
  }
  all.emplace_back(rational);
  // A crease: a knot as often as the degree.
  BSplineSurface creased = wall(3, 3, 10, 8.0, gentle);
  creased.knots_u = {0, 0, 0, 0, 0.3, 0.5, 0.5, 0.5, 0.8, 0.9, 1, 1, 1, 1};
  all.emplace_back(creased);
  Torus torus{};
  torus.major_radius = 7.0;
  torus.minor_radius = 2.0;
  all.emplace_back(torus);
  return all;
}

std::vector<CellPlace> places_on(const SectionSurface& surface, const Surface& of, std::mt19937_64& random) {
  const bool is_torus = std::holds_alternative<Torus>(of);
  std::uniform_real_distribution<double> unit(0.05, is_torus ? 6.2 : 0.95);
  std::vector<CellPlace> places;
  for (int i = 0; i < kLanes; ++i) {
    const Vec2 uv(unit(random), unit(random));
    places.push_back({uv, surface.find_cell(uv, Vec2::Zero())});
  }
  return places;
}

void expect_near(const Vec3& a, const Vec3& b, double scale = 1.0) { EXPECT_LE((a - b).norm(), 1e-11 * scale); }

TEST(SectionLanes, EvaluateAsOneByOne) {
  std::mt19937_64 random(3);
  for (const Surface& of : surfaces()) {
    const SectionSurface surface(of);
    for (std::size_t count = 1; count <= kLanes; ++count) {
      const std::vector<CellPlace> places = places_on(surface, of, random);
      JetLanes jets;
      surface.evaluate_lanes({places.data(), count}, true, jets);
      for (std::size_t i = 0; i < count; ++i) {
        const SurfacePoint2 at = surface.evaluate(places[i].uv, places[i].cell);
        const auto value = [&](int order) {
          return Vec3(jets.value[3 * order][i], jets.value[3 * order + 1][i], jets.value[3 * order + 2][i]);
        };
        expect_near(value(0), at.point, 10.0);
        expect_near(value(1), at.du, 100.0);
        expect_near(value(2), at.dv, 100.0);
        expect_near(value(3), at.duu, 1e4);
        expect_near(value(4), at.duv, 1e4);
        expect_near(value(5), at.dvv, 1e4);
      }
    }
  }
}

/// Points of the section through the surface's middle, each brought there from a start beside it.
struct Moved {
  std::vector<MovingPoint> moving;
  std::vector<SectionPoint> points;
};

Moved moved_points(const SectionSurface& surface, const std::vector<CellPlace>& starts, double z, int line) {
  Moved moved;
  moved.points.resize(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    MovingPoint& point = moved.moving.emplace_back();
    point.at = starts[i];
    point.scale = 1.0;
    if (line >= 0) point.way[1 - line] = 1.0;
    point.point = &moved.points[i];
  }
  move_points(surface, 1.0, z, {0.0, 1e3, 8}, moved.moving);
  return moved;
}

TEST(SectionLanes, MoveAsCorrectDoes) {
  std::mt19937_64 random(4);
  int found = 0;
  for (const Surface& of : surfaces()) {
    const SectionSurface surface(of);
    for (int round = 0; round < 5; ++round) {
      const std::vector<CellPlace> starts = places_on(surface, of, random);
      const double z = surface.evaluate(starts[0].uv, starts[0].cell).point.z() + 0.01;
      for (const int line : {-1, 0, 1}) {
        const Moved moved = moved_points(surface, {starts[0]}, z, line);
        const auto expected = correct(surface, starts[0].cell, starts[0].uv, z, 1.0, line, {1.0});
        if (!expected || !moved.moving[0].found) continue;
        ++found;
        const SectionPoint& point = moved.points[0];
        // The last step, 1e-4 mm at most, is Newton's: its square is left, times half the bend along the way.
        EXPECT_NEAR(surface.evaluate(point.uv, starts[0].cell).point.z(), z, 2e-8);
        EXPECT_LE((point.uv - expected->uv).norm(), 2e-8);
        EXPECT_LE((point.xy - expected->xy).norm(), 2e-8);
        EXPECT_LE((point.tangent - expected->tangent).norm(), 1e-6);
        EXPECT_NEAR(point.curvature, expected->curvature, 1e-4 * (1.0 + std::abs(expected->curvature)));
        EXPECT_LE((moved.moving[0].velocity - rise_of(point, line)).norm(), 1e-6 * (1.0 + rise_of(point, line).norm()));
      }
    }
  }
  EXPECT_GE(found, 60);
}

TEST(SectionLanes, FitAsOneByOne) {
  for (const Surface& of : surfaces()) {
    const SectionSurface surface(of);
    const Vec2 start(0.12, 0.41);
    const Cell cell = surface.find_cell(start, Vec2::Zero());
    const double z = surface.evaluate(start, cell).point.z();
    std::vector<SectionPoint> points;
    std::optional<SectionPoint> at = correct(surface, cell, start, z, 1.0, -1, {1.0});
    for (int i = 0; i < kLanes && at && surface.holds(cell, at->uv, -1); ++i) {
      points.push_back(*at);
      points.back().z = z;
      at = correct(surface, cell, at->uv + 0.02 * (1 + i) * at->uv_slope, z, 1.0, -1, {1.0});
    }
    ASSERT_GE(points.size(), 3U);
    PointRun run(surface, 1.0, points[0]);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) run.add(cell, points[i + 1], cell);
    PieceFits fits;
    fit_run(run, {1.0, 0.0}, fits);
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const PieceFit one = fit_piece(surface, cell, points[i], points[i + 1]);
      ASSERT_TRUE(std::isfinite(one.error));
      EXPECT_NEAR(fits.errors[i], one.error, 1e-13 + 1e-5 * one.error);
      for (std::size_t k = 0; k < 6; ++k) {
        EXPECT_NEAR(fits.pieces[i].x[k], one.piece.x[k], 1e-11);
        EXPECT_NEAR(fits.pieces[i].y[k], one.piece.y[k], 1e-11);
      }
    }
  }
}

template <class Lanes>
void fill(Lanes& lanes, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0.1, 1.0);
  double numbers[sizeof(Lanes) / sizeof(double)];
  for (double& number : numbers) number = unit(random);
  std::memcpy(&lanes, numbers, sizeof(Lanes));
}

template <class Lanes>
bool same_bytes(const Lanes& a, const Lanes& b) {
  return std::memcmp(&a, &b, sizeof(Lanes)) == 0;
}

TEST(LaneKernel, GivesEqualBytesOnEveryLevel) {
  std::mt19937_64 random(8);
  JetLanes jets;
  fill(jets, random);
  RunLanes run;
  fill(run, random);
  MoveLanes move_in;
  fill(move_in, random);
  MeasureLanes measure_in;
  fill(measure_in, random);
  std::vector<double> net(4 * 6 * 4);
  std::uniform_real_distribution<double> unit(0.5, 1.5);
  for (double& number : net) number = unit(random);
  NetLanes nets;
  fill(nets.place_u, random);
  fill(nets.scale_u, random);
  fill(nets.place_v, random);
  fill(nets.scale_v, random);
  for (const double*& one : nets.net) one = net.data();
  NetShape shape{3, 5, true, {1.0, -2.0, 0.5}};

  struct Results {
    JetLanes jets;
    MoveLanes move;
    PointLanes points;
    PieceLanes pieces;
    MeasureLanes measured;
    MeasureLanes distance;
  };
  std::vector<Results> results;
  for (const LaneKernel& kernel : lane_kernels()) {
    Results& result = results.emplace_back();
    std::memset(static_cast<void*>(&result), 0, sizeof(Results));
    result.move = move_in;
    result.measured = result.distance = measure_in;
    kernel.jets(shape, nets, kLanes, true, result.jets);
    kernel.move(jets, kLanes, result.move, result.points);
    kernel.join(run, kLanes, result.pieces);
    kernel.measure(jets, kLanes, result.measured);
    kernel.distance(jets, kLanes, result.distance);
    EXPECT_TRUE(same_bytes(result.jets, results[0].jets));
    EXPECT_TRUE(same_bytes(result.move, results[0].move));
    EXPECT_TRUE(same_bytes(result.points, results[0].points));
    EXPECT_TRUE(same_bytes(result.pieces, results[0].pieces));
    EXPECT_TRUE(same_bytes(result.measured, results[0].measured));
    EXPECT_TRUE(same_bytes(result.distance, results[0].distance));
  }
  EXPECT_FALSE(results.empty());
}

/// The section of a wall from one side (u = 0) to the other, layer by layer.
class Wall {
 public:
  explicit Wall(BSplineSurface of) : of_(std::move(of)), surface_(of_) {}

  /// The section's end on a side.
  [[nodiscard]] SectionPoint side(double u, double z) const {
    const Vec2 start(u, 0.5);
    const Cell cell = surface_.find_cell(start, Vec2::Zero());
    auto point = correct(surface_, cell, start, z, sign_, 0, {100.0});
    // What is left of a way is taken from the second derivatives, and the shorter the way may be the less it is.
    if (point) point = correct(surface_, cell, point->uv, z, sign_, 0, {1e-2});
    EXPECT_TRUE(point);
    SectionPoint result = point.value_or(SectionPoint{});
    result.z = z;
    return result;
  }

  /// Traces at the first height and carries to the others; returns the largest distance of an arc from the surface.
  double follow(double from, double step, int layers, std::size_t& most_pieces) {
    CarriedArc& carried = carried_;
    CarryWork work;
    carried = {};
    // z x n leads from u = 1 to u = 0 or back: whichever it is.
    if (side(0.0, from).uv_slope[0] < 0.0) sign_ = -1.0;
    const SectionPoint end = side(1.0, from);
    EXPECT_TRUE(trace(surface_, sign_, side(0.0, from), {&end, 1}, limits_, carried.arc));
    carried.start(from);
    most_pieces = carried.arc.pieces.size();
    double largest = distance(carried.arc, from);
    for (int layer = 1; layer < layers; ++layer) {
      const double z = from + layer * step;
      if (!carry(surface_, sign_, side(0.0, z), side(1.0, z), z, limits_, true, work, carried)) {
        ADD_FAILURE() << "not carried to layer " << layer;
        return largest;
      }
      EXPECT_EQ(carried.z, z);
      EXPECT_EQ(carried.arc.points.size(), carried.arc.pieces.size() + 1);
      EXPECT_EQ(carried.motions.size(), carried.arc.points.size());
      EXPECT_EQ(carried.lines.size(), carried.arc.points.size());
      largest = std::max(largest, distance(carried.arc, z));
      most_pieces = std::max(most_pieces, carried.arc.pieces.size());
    }
    return largest;
  }

  /// How many pieces the arc has where it was carried to, and how many it takes there.
  [[nodiscard]] std::pair<std::size_t, std::size_t> pieces_at_end() const {
    TracedArc fresh;
    const SectionPoint end = side(1.0, carried_.z);
    EXPECT_TRUE(trace(surface_, sign_, side(0.0, carried_.z), {&end, 1}, limits_, fresh));
    return {carried_.arc.pieces.size(), fresh.pieces.size()};
  }

 private:
  /// Of places all over the pieces from the section at z, by Newton's iteration on the surface.
  [[nodiscard]] double distance(const TracedArc& arc, double z) const {
    double largest = 0.0;
    for (std::size_t i = 0; i < arc.pieces.size(); ++i) {
      // Pieces hang together.
      if (i > 0) largest = std::max(largest, (arc.pieces[i].at(0.0) - arc.pieces[i - 1].at(1.0)).norm());
      for (const double t : {0.0, 0.2, 0.4, 0.5, 0.7, 0.9}) {
        Vec2 uv = (1.0 - t) * arc.points[i].uv + t * arc.points[i + 1].uv;
        const Vec2 xy = arc.pieces[i].at(t);
        for (int k = 0; k < 20; ++k) {
          const SurfacePoint at = surface_.evaluate_slopes(uv, surface_.find_cell(uv, Vec2::Zero()));
          Eigen::Matrix<double, 3, 2> slopes;
          slopes << at.du, at.dv;
          uv += slopes.colPivHouseholderQr().solve(Vec3(xy.x(), xy.y(), z) - at.point);
        }
        const SurfacePoint at = surface_.evaluate_slopes(uv, surface_.find_cell(uv, Vec2::Zero()));
        largest = std::max(largest, (at.point - Vec3(xy.x(), xy.y(), z)).norm());
      }
    }
    return largest;
  }

  Surface of_;
  SectionSurface surface_;
  double sign_ = 1.0;
  TraceLimits limits_{1e-7, 5.0};
  CarriedArc carried_;
};

TEST(Carry, KeepsArcsOnTheSurface) {
  for (const auto& [degree_u, degree_v] : {std::pair{3, 3}, std::pair{5, 3}, std::pair{3, 5}}) {
    Wall of(wall(degree_u, degree_v, 12, 8.0, gentle));
    std::size_t pieces = 0;
    // Two tolerances in the places that are measured, and hardly more beside them.
    EXPECT_LE(of.follow(2.0, 0.05, 80, pieces), 3e-7);
    EXPECT_LE(pieces, 60U);
  }
}

/// A ridge a tenth of a millimetre wide, that moves along the section by several times its width a layer.
TEST(Carry, FollowsARidgeThatMovesSideways) {
  const auto ridge = [](double u, double v) {
    const double off = 40.0 * (u - 0.3 - 0.4 * v);
    return 1.5 / (1.0 + off * off);
  };
  BSplineSurface surface = wall(3, 3, 80, 8.0, ridge);
  Wall of(surface);
  std::size_t pieces = 0;
  EXPECT_LE(of.follow(2.0, 0.2, 20, pieces), 3e-7);
  EXPECT_LE(pieces, 400U);
}

/// Waves that die out upward leave more points behind than the arc takes there.
TEST(Carry, LeavesOutPointsThatAreNotNeeded) {
  const auto dying = [](double u, double v) { return 0.5 * std::sin(30.0 * u) * std::pow(1.0 - v, 8.0); };
  Wall of(wall(5, 5, 24, 8.0, dying));
  std::size_t most = 0;
  EXPECT_LE(of.follow(0.7, 0.05, 120, most), 3e-7);
  const auto [carried, needed] = of.pieces_at_end();
  EXPECT_LE(carried, needed + needed / 4) << most;
  EXPECT_GE(most, needed + needed / 2);
}

/// On a crease a point stays on it, and no piece reaches over it.
TEST(Carry, StaysInItsCells) {
  BSplineSurface creased = wall(3, 3, 10, 8.0, gentle);
  creased.knots_u = {0, 0, 0, 0, 0.3, 0.5, 0.5, 0.5, 0.8, 0.9, 1, 1, 1, 1};
  Wall of(creased);
  std::size_t pieces = 0;
  EXPECT_LE(of.follow(2.0, 0.05, 80, pieces), 3e-7);
}

/// The section of a leaning ring just below its highest point: a loop, a crescent if it leans by little, that shrinks
/// towards the top. Seeded where it crosses a line v = const.
class Cap {
 public:
  explicit Cap(double angle) {
    Torus torus{};
    torus.major_radius = 7.0;
    torus.minor_radius = 2.5;
    torus.frame.x = Vec3(std::cos(angle), 0.0, std::sin(angle));
    torus.frame.z = Vec3(-std::sin(angle), 0.0, std::cos(angle));
    of_ = torus;
    surface_.emplace(of_);
    // The highest point: u = 0, and the normal upright.
    top_ = Vec2(0.0, 0.5 * kPi - angle);
    height_ = surface_->evaluate(top_, Cell{}).point.z();
  }

  [[nodiscard]] double height() const { return height_; }

  /// Where the section at z crosses the line `aside` of the top, on the side of growing u.
  [[nodiscard]] std::optional<SectionPoint> seed(double z, double aside) const {
    std::optional<SectionPoint> point = correct(*surface_, Cell{}, top_ + Vec2(0.4, aside), z, 1.0, 1, {20.0});
    if (point) point = correct(*surface_, Cell{}, point->uv, z, 1.0, 1, {1e-2});
    if (point) point->z = z;
    return point;
  }

  [[nodiscard]] bool trace_from(const SectionPoint& seed, TracedArc& arc) const {
    return trace(*surface_, 1.0, seed, {&seed, 1}, limits_, arc);
  }
  bool carry_to(const SectionPoint& seed, double z, CarriedArc& carried) {
    return carry(*surface_, 1.0, seed, seed, z, limits_, true, work_, carried);
  }

 private:
  Surface of_;
  std::optional<SectionSurface> surface_;
  Vec2 top_ = Vec2::Zero();
  double height_ = 0.0;
  TraceLimits limits_{1e-7, 5.0};
  CarryWork work_;
};

double turn_of(const TracedArc& arc) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < arc.points.size(); ++i) {
    const Vec2& a = arc.points[i].tangent;
    const Vec2& b = arc.points[i + 1].tangent;
    sum += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
  }
  return sum;
}

/// A seed near the tip of its loop overtakes the points beside it, and what is left beyond it must not go round again.
TEST(Carry, RunsThroughALoopOnce) {
  int layers = 0;
  for (const double angle : {0.1, 0.2, 0.324}) {
    Cap cap(angle);
    for (int phase = 0; phase < 60; ++phase) {
      const double step = 0.223 * (angle / 0.324);
      double below = step * (7.0 + phase / 60.0);
      auto seed = cap.seed(cap.height() - below, 0.0);
      CarriedArc carried;
      if (!seed || !cap.trace_from(*seed, carried.arc)) continue;
      carried.start(seed->z);
      while ((below -= step) > 0.0 && (seed = cap.seed(cap.height() - below, 0.0)) &&
             cap.carry_to(*seed, seed->z, carried)) {
        ++layers;
        ASSERT_NEAR(turn_of(carried.arc), kTwoPi, 1e-6)
            << "leaning by " << angle << ", " << below << " mm below the top";
      }
    }
  }
  EXPECT_GE(layers, 300);
}

TEST(CarriedArc, SpeedIsInLengthsOfPieces) {
  CarriedArc arc;
  // A plane leaning by 45 degrees: points go as far sideways as up, in its own chart by sqrt(2).
  for (int i = 0; i < 4; ++i) {
    SectionPoint point;
    point.xy = Vec2(0.25 * i * i, 0.0);
    point.metric[0] = 1.0;
    point.metric[2] = 2.0;
    arc.arc.points.push_back(point);
    arc.motions.push_back(Motion{Vec2(0.0, 1.0)});
  }
  arc.arc.pieces.resize(3);
  // The inner points are at 0.25 and 1; the shortest piece beside one is the first, 0.25 mm.
  EXPECT_NEAR(arc.speed(), std::sqrt(2.0) / 0.25, 1e-12);
}

}  // namespace
}  // namespace lamella::span
