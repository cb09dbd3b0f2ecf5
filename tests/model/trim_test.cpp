#include "model/trim.h"

#include <gtest/gtest.h>
#include <limits>

#include "core/error.h"
#include "model/evaluate.h"
#include "model/step/read_step.h"
#include "tests/model/random_geometry.h"
#include "tests/support/paths.h"
#include "tests/support/solids.h"

namespace lamella {
namespace {

using Side = TrimRegion::Side;
using test::RandomGeometry;

/// One pcurve in the sense of its loop: from parameter range.lo to range.hi, which may run backwards.
struct Trim {
  Curve2 curve;
  Interval range;
};

Trim line(const Vec2& from, const Vec2& to) { return {Line<2>{from, to - from}, {0.0, 1.0}}; }

std::vector<Trim> polygon(const std::vector<Vec2>& corners) {
  std::vector<Trim> loop;
  for (std::size_t i = 0; i < corners.size(); ++i) loop.push_back(line(corners[i], corners[(i + 1) % corners.size()]));
  return loop;
}

std::vector<Trim> rectangle(double u0, double v0, double u1, double v1) {
  return polygon({Vec2(u0, v0), Vec2(u1, v0), Vec2(u1, v1), Vec2(u0, v1)});
}

Trim circle(const Vec2& centre, double radius, bool clockwise = false) {
  const Ellipse<2> ellipse{centre, Vec2(radius, 0.0), Vec2(0.0, clockwise ? -radius : radius)};
  return {ellipse, {0.0, kTwoPi}};
}

/// A scene of one face; every second half-edge runs against its edge, so that both senses are met.
Scene scene_of_face(const Surface& surface, const std::vector<std::vector<Trim>>& loops, bool same_sense = true) {
  Scene scene;
  Face face{ShellId{0}, surface, same_sense, {}, {}, 1e-7, 17, "face", {}};
  face.loops = {LoopId{0}, static_cast<std::uint32_t>(loops.size())};
  for (const auto& trims : loops) {
    const LoopId loop{scene.loops.size()};
    scene.loops.push_back({FaceId{0}, {HalfEdgeId{scene.half_edges.size()}, static_cast<std::uint32_t>(trims.size())}});
    for (const Trim& trim : trims) {
      const bool forward = scene.half_edges.size() % 2 == 0;
      Edge edge;
      edge.step_entity = 23;
      const Interval range = forward ? trim.range : Interval{trim.range.hi, trim.range.lo};
      scene.half_edges.push_back({scene.edges.push_back(edge), loop, forward, trim.curve, range, {}});
      for (const double t : {range.lo, range.hi}) face.uv_bounds.extend(evaluate<2>(trim.curve, t).point);
    }
  }
  scene.faces.push_back(face);
  return scene;
}

TrimRegion region(const Surface& surface, const std::vector<std::vector<Trim>>& loops, bool same_sense = true) {
  return {scene_of_face(surface, loops, same_sense), FaceId{0}};
}

Cylinder unit_cylinder() { return {Frame{}, 1.0}; }

TEST(TrimRegion, KnowsHolesInHoles) {
  const TrimRegion trim =
      region(Plane{}, {rectangle(0, 0, 10, 10), {circle(Vec2(5, 5), 3.0, true)}, {circle(Vec2(5, 5), 1.0)}});
  EXPECT_EQ(trim.classify(Vec2(1, 1)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(5, 3)), Side::outside);
  EXPECT_EQ(trim.classify(Vec2(5, 5)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(11, 5)), Side::outside);
  EXPECT_EQ(trim.classify(Vec2(10, 5)), Side::on_boundary);
  EXPECT_EQ(trim.classify(Vec2(7.9995, 5), Vec2(1e-3, 0.0)), Side::on_boundary);
  EXPECT_EQ(trim.classify(Vec2(7.9995, 5), Vec2(1e-4, 1e-2)), Side::outside);
  EXPECT_EQ(trim.bounds().min(), Vec2(0, 0));
  EXPECT_EQ(trim.bounds().max(), Vec2(10, 10));
}

TEST(TrimRegion, OfAFaceOfOppositeSenseIsTheSame) {
  // The loop follows the outward normal, so on such a face it runs clockwise in (u, v).
  auto corners = std::vector<Vec2>{Vec2(0, 0), Vec2(0, 4), Vec2(4, 4), Vec2(4, 0)};
  const TrimRegion trim = region(Plane{}, {polygon(corners), {circle(Vec2(2, 2), 1.0)}}, false);
  EXPECT_EQ(trim.classify(Vec2(0.5, 0.5)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(2, 2)), Side::outside);
  double area = 0.0;
  for (const BezierCurve2& piece : trim.boundary()) {
    const Vec2 a = evaluate_point(piece, piece.t.lo);
    const Vec2 b = evaluate_point(piece, piece.t.hi);
    area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  EXPECT_GT(area, 0.0) << "the region lies left of its boundary";
}

TEST(TrimRegion, BoundaryIsClosedBitForBitAndBridgesGaps) {
  auto loop = rectangle(0, 0, 4, 4);
  loop[1] = line(Vec2(4.001, 0.002), Vec2(4, 3.9));  // misses both neighbours
  loop.erase(loop.begin() + 3);                      // and one side is missing
  const TrimRegion trim = region(Plane{}, {loop});
  const auto& pieces = trim.boundary();
  ASSERT_EQ(pieces.size(), 6u);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    const BezierCurve2& next = pieces[(i + 1) % pieces.size()];
    EXPECT_EQ(evaluate_point(pieces[i], pieces[i].t.hi), evaluate_point(next, next.t.lo));
  }
  EXPECT_EQ(trim.classify(Vec2(0.01, 2)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(-0.01, 2)), Side::outside);
}

TEST(TrimRegion, OfACylinderWithSeamHoldsEveryAngle) {
  const TrimRegion trim = region(unit_cylinder(), {rectangle(0, 0, kTwoPi, 2)});
  for (double u = -20.0; u < 20.0; u += 0.37) {
    EXPECT_EQ(trim.classify(Vec2(u, 1)), Side::inside) << u;
    EXPECT_EQ(trim.classify(Vec2(u, 2.1)), Side::outside) << u;
    const double unwrapped = trim.unwrap(Vec2(u, 1))[0];
    EXPECT_GE(unwrapped, 0.0);
    EXPECT_LE(unwrapped, kTwoPi);
    EXPECT_NEAR(std::remainder(unwrapped - u, kTwoPi), 0.0, 1e-12);
  }
  EXPECT_EQ(trim.classify(Vec2(0, 1)), Side::on_boundary);
  EXPECT_EQ(trim.unwrap(Vec2(-3, 9)), Vec2(-3, 9));
}

TEST(TrimRegion, FindsAHoleThatIsWrittenAPeriodAway) {
  const TrimRegion trim =
      region(unit_cylinder(), {rectangle(0, 0, kTwoPi, 2), {circle(Vec2(kTwoPi + 1, 1), 0.5, true)}});
  EXPECT_EQ(trim.classify(Vec2(1, 1)), Side::outside);
  EXPECT_EQ(trim.classify(Vec2(1 + kTwoPi, 1)), Side::outside);
  EXPECT_EQ(trim.classify(Vec2(1.6, 1)), Side::inside);
}

TEST(TrimRegion, MovesPcurvesOfOneLoopIntoOnePeriod) {
  auto loop = rectangle(0.5, 0, 2.5, 2);
  loop[2] = line(Vec2(2.5 - kTwoPi, 2), Vec2(0.5 - kTwoPi, 2));
  loop[3] = line(Vec2(0.5 + kTwoPi, 2), Vec2(0.5 + kTwoPi, 0));
  const TrimRegion trim = region(unit_cylinder(), {loop});
  EXPECT_EQ(trim.classify(Vec2(1, 1)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(1 - kTwoPi, 1)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(3, 1)), Side::outside);
  EXPECT_NEAR(trim.bounds().sizes()[0], 2.0, 1e-14);
}

TEST(TrimRegion, JoinsRingsOfACylinderWithoutSeam) {
  const std::vector<Trim> bottom{line(Vec2(0, 0), Vec2(kTwoPi, 0))};
  const std::vector<Trim> top{line(Vec2(kTwoPi + 0.3, 2), Vec2(0.3, 2))};
  for (const auto& loops : {std::vector{bottom, top}, std::vector{top, bottom}}) {
    const TrimRegion trim = region(unit_cylinder(), loops);
    for (double u = 0.11; u < 7.0; u += 0.5) {
      EXPECT_EQ(trim.classify(Vec2(u, 1)), Side::inside) << u;
      EXPECT_EQ(trim.classify(Vec2(u, -0.1)), Side::outside) << u;
      EXPECT_EQ(trim.classify(Vec2(u, 2.1)), Side::outside) << u;
    }
  }
}

TEST(TrimRegion, KeepsTheBandsBetweenFourRingsApart) {
  const auto ring = [](double v, bool up) {
    return std::vector<Trim>{up ? line(Vec2(0, v), Vec2(kTwoPi, v)) : line(Vec2(kTwoPi, v), Vec2(0, v))};
  };
  const TrimRegion trim = region(unit_cylinder(), {ring(0, true), ring(5, false), ring(3, true), ring(1, false)});
  EXPECT_EQ(trim.classify(Vec2(1, 0.5)), Side::inside);
  EXPECT_EQ(trim.classify(Vec2(1, 2)), Side::outside);
  EXPECT_EQ(trim.classify(Vec2(1, 4)), Side::inside);
}

TEST(TrimRegion, JoinsRingsOfATorusAcrossThePeriod) {
  const Torus torus{Frame{}, 5.0, 1.0};
  // From v = 5 over 2 pi to v = 1, along u; and the same along v, where the region left of +v is towards -u.
  const TrimRegion along_u = region(torus, {{line(Vec2(0, 5), Vec2(kTwoPi, 5))}, {line(Vec2(kTwoPi, 1), Vec2(0, 1))}});
  EXPECT_EQ(along_u.classify(Vec2(1, 0)), Side::inside);
  EXPECT_EQ(along_u.classify(Vec2(1, 6)), Side::inside);
  EXPECT_EQ(along_u.classify(Vec2(1, 3)), Side::outside);
  const TrimRegion along_v = region(torus, {{line(Vec2(2, 0), Vec2(2, kTwoPi))}, {line(Vec2(1, kTwoPi), Vec2(1, 0))}});
  EXPECT_EQ(along_v.classify(Vec2(1.5, 3)), Side::inside);
  EXPECT_EQ(along_v.classify(Vec2(0.5, 3)), Side::outside);
  EXPECT_EQ(along_v.classify(Vec2(2.5, 3)), Side::outside);
}

TEST(TrimRegion, ClosesASingleRingAtThePoleOrApex) {
  const Trim ring = line(Vec2(0, 0.5), Vec2(kTwoPi, 0.5));
  const Trim back = line(Vec2(kTwoPi, 0.5), Vec2(0, 0.5));
  const TrimRegion cap = region(Sphere{Frame{}, 1.0}, {{ring}});
  EXPECT_EQ(cap.classify(Vec2(1, 1.5)), Side::inside);
  EXPECT_EQ(cap.classify(Vec2(1, 0.4)), Side::outside);
  const TrimRegion rest = region(Sphere{Frame{}, 1.0}, {{back}});
  EXPECT_EQ(rest.classify(Vec2(1, 0.4)), Side::inside);
  EXPECT_EQ(rest.classify(Vec2(1, -1.5)), Side::inside);
  EXPECT_EQ(rest.classify(Vec2(1, 0.6)), Side::outside);
  const Cone cone{Frame{}, 1.0, -0.5};
  const double apex = 1.0 / std::sin(0.5);
  const TrimRegion tip = region(cone, {{ring}});
  EXPECT_EQ(tip.classify(Vec2(1, apex - 0.01)), Side::inside);
  EXPECT_EQ(tip.classify(Vec2(1, apex + 0.01)), Side::outside);
  EXPECT_EQ(tip.classify(Vec2(1, 0.4)), Side::outside);
}

TEST(TrimRegion, BridgesAPoleWithoutAnEdgeOfItsOwn) {
  const double pole = 0.5 * kPi;
  const std::vector<Trim> loop{line(Vec2(0, 0), Vec2(kTwoPi, 0)), line(Vec2(kTwoPi, 0), Vec2(kTwoPi, pole)),
                               line(Vec2(0, pole), Vec2(0, 0))};
  const TrimRegion trim = region(Sphere{Frame{}, 1.0}, {loop});
  for (double u = 0.1; u < kTwoPi; u += 0.5) {
    EXPECT_EQ(trim.classify(Vec2(u, 1.5)), Side::inside);
    EXPECT_EQ(trim.classify(Vec2(u, -0.1)), Side::outside);
  }
}

TEST(TrimRegion, OfAFaceWithoutUsableLoopIsItsBoundsOrTheWholeSurface) {
  const TrimRegion sphere = region(Sphere{Frame{}, 1.0}, {});
  EXPECT_EQ(sphere.classify(Vec2(1, 1)), Side::inside);
  EXPECT_EQ(sphere.classify(Vec2(1, 1.6)), Side::outside);
  // Only a seam, there and back: it encloses nothing.
  const TrimRegion seam =
      region(Torus{Frame{}, 3.0, 1.0}, {{line(Vec2(0, 0), Vec2(0, 6)), line(Vec2(0, 6), Vec2(0, 0))}});
  EXPECT_EQ(seam.classify(Vec2(1, 1)), Side::inside);
  Scene scene = scene_of_face(unit_cylinder(), {});
  EXPECT_EQ(TrimRegion(scene, FaceId{0}).classify(Vec2(1, 1)), Side::outside);
  scene.faces[FaceId{0}].uv_bounds = Box2(Vec2(0, 0), Vec2(2, 3));
  EXPECT_EQ(TrimRegion(scene, FaceId{0}).classify(Vec2(1, 1)), Side::inside);
  EXPECT_EQ(TrimRegion(scene, FaceId{0}).classify(Vec2(1, 4)), Side::outside);
}

TEST(TrimRegion, FollowsAHelicalStripOverManyTurns) {
  const double turns = 10.0 * kTwoPi;
  const std::vector<Trim> loop = polygon({Vec2(0, 0), Vec2(turns, 10.0), Vec2(turns, 10.5), Vec2(0, 0.5)});
  const TrimRegion trim = region(unit_cylinder(), {loop});
  for (double u = 0.05; u < kTwoPi; u += 0.3) {
    for (int turn = 0; turn < 10; ++turn) {
      const double foot = (u + turn * kTwoPi) / kTwoPi;
      EXPECT_EQ(trim.classify(Vec2(u, foot + 0.25)), Side::inside);
      EXPECT_EQ(trim.classify(Vec2(u, foot + 0.75)), Side::outside);
      EXPECT_NEAR(trim.unwrap(Vec2(u, foot + 0.25))[0], u + turn * kTwoPi, 1e-12);
    }
  }
}

/// Samples of a loop's pcurves, end to begin, closed; coordinates in parts of the face's bounds.
std::vector<Vec2> sample(const Scene& scene, LoopId loop, const Vec2& scale, int count) {
  std::vector<Vec2> points;
  for (const HalfEdgeId id : scene.loops[loop].half_edges) {
    const HalfEdge& half = scene.half_edges[id];
    for (int i = 0; i <= count; ++i) {
      const double s = static_cast<double>(half.forward ? i : count - i) / count;
      const double t = half.prange.lo + s * half.prange.length();
      points.push_back(evaluate<2>(half.pcurve, t).point.cwiseProduct(scale));
    }
  }
  if (!points.empty()) points.push_back(points.front());
  return points;
}

/// Where a point lies by the angles under which densely sampled pcurves are seen, summed over three periods either way;
/// nothing for points that come within `margin` (in parts of the face's bounds) of a sample.
class Sampled {
 public:
  Sampled(const Scene& scene, FaceId face, double margin)
      : scale_(scene.faces[face].uv_bounds.sizes().cwiseInverse()),
        period_(periods(scene.faces[face].surface).cwiseProduct(scale_)),
        margin_(margin) {
    for (const LoopId loop : scene.faces[face].loops) loops_.push_back(sample(scene, loop, scale_, 200));
  }

  [[nodiscard]] std::optional<bool> inside(const Vec2& uv) const {
    const int shifts_u = period_[0] > 0.0 ? 3 : 0;
    const int shifts_v = period_[1] > 0.0 ? 3 : 0;
    double angle = 0.0;
    for (int i = -shifts_u; i <= shifts_u; ++i) {
      for (int j = -shifts_v; j <= shifts_v; ++j) {
        const auto seen = angle_seen(uv.cwiseProduct(scale_) + Vec2(i * period_[0], j * period_[1]));
        if (!seen) return std::nullopt;
        angle += *seen;
      }
    }
    return std::lround(angle / kTwoPi) != 0;
  }

 private:
  [[nodiscard]] std::optional<double> angle_seen(const Vec2& point) const {
    double angle = 0.0;
    for (const auto& loop : loops_) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        if ((loop[i] - point).norm() < margin_) return std::nullopt;
        if (i == 0) continue;
        const Vec2 a = loop[i - 1] - point;
        const Vec2 b = loop[i] - point;
        angle += std::atan2(a[0] * b[1] - a[1] * b[0], a.dot(b));
      }
    }
    return angle;
  }

  Vec2 scale_;
  Vec2 period_;
  double margin_;
  std::vector<std::vector<Vec2>> loops_;
};

TEST(TrimRegion, EqualsDenseSamplingOnRandomSplineLoopsWithHoles) {
  RandomGeometry random(61);
  int compared = 0;
  int inside = 0;
  for (int round = 0; round < 30; ++round) {
    auto outer = random.curve<2>(random.integer(2, 5), random.integer(2, 6), round % 2 == 0);
    outer.poles.back() = outer.poles.front();
    const Interval range{outer.knots.front(), outer.knots.back()};
    const Vec2 centre = evaluate<2>(Curve2(outer), range.middle()).point;
    const Surface surface = round % 3 == 0 ? Surface(unit_cylinder()) : Surface(Plane{});
    Scene scene = scene_of_face(surface, {{{outer, range}}, {circle(centre, 1.0, true)}});
    scene.faces[FaceId{0}].uv_bounds = Box2(Vec2(-10, -10), Vec2(10, 10));
    const TrimRegion trim(scene, FaceId{0});
    const Sampled sampled(scene, FaceId{0}, 0.015);
    for (int i = 0; i < 30; ++i) {
      const Vec2 point = random.point<2>(10.0);
      const auto expected = sampled.inside(point);
      if (!expected) continue;
      EXPECT_EQ(trim.classify(point), *expected ? Side::inside : Side::outside) << round << ": " << point.transpose();
      ++compared;
      inside += *expected;
    }
  }
  EXPECT_GT(compared, 400);
  EXPECT_GT(inside, 80);
}

TEST(TrimRegion, OfHandBuiltSolidsHoldsTheMiddleOfEachFaceAndNothingBeyond) {
  Scene scene;
  test::add_box(scene, Vec3(0, 0, 0), Vec3(1, 2, 3));
  test::add_cylinder(scene, 2.0, 5.0);
  test::add_cone(scene, 2.0, 5.0);
  test::add_sphere(scene, 2.0);
  test::add_torus(scene, 4.0, 1.0);
  test::add_dome(scene, 2.0, 3.0, 1.0, 0.5);
  for (const FaceId face : scene.faces.ids()) {
    const TrimRegion trim(scene, face);
    const Box2& box = scene.faces[face].uv_bounds;
    EXPECT_EQ(trim.classify(box.center() + 0.01 * box.sizes()), Side::inside);
    const Vec2 period = periods(scene.faces[face].surface);
    for (int axis = 0; axis < 2; ++axis) {
      if (period[axis] > 0.0) continue;
      Vec2 beyond = box.center();
      beyond[axis] = box.max()[axis] + 0.01 * box.sizes()[axis];
      EXPECT_EQ(trim.classify(beyond), Side::outside);
    }
  }
}

TEST(TrimRegion, EqualsDenseSamplingOnRealFaces) {
  LAMELLA_NEEDS_CORPUS();
  RandomGeometry random(62);
  int compared = 0;
  int outside = 0;
  for (const char* name : {"asm_occt_as1_oc_214_mat.stp", "free_geouned_torus.stp", "free_geouned_doblecodo.stp",
                           "mech_b123d_m6_1x12_countersunk_screw.step", "free_occt_bug32596_abc_0_13.step"}) {
    const std::filesystem::path path = test::corpus_dir() / name;
    const Scene scene = read_step(std::span(&path, 1));
    for (const FaceId face : scene.faces.ids()) {
      const TrimRegion trim(scene, face);
      const Sampled sampled(scene, face, 0.02);
      const Box2& box = scene.faces[face].uv_bounds;
      for (int i = 0; i < 8; ++i) {
        const Vec2 uv = box.min() + box.sizes().cwiseProduct(Vec2(random.real(0, 1), random.real(0, 1)));
        const auto expected = sampled.inside(uv);
        if (!expected) continue;
        EXPECT_EQ(trim.classify(uv), *expected ? Side::inside : Side::outside) << name << " face " << face.value();
        ++compared;
        outside += !*expected;
      }
    }
  }
  EXPECT_GT(compared, 1000);
  EXPECT_GT(outside, 50);
}

TEST(TrimRegion, SurvivesHostileQueries) {
  const TrimRegion trim = region(unit_cylinder(), {rectangle(0, 0, kTwoPi, 2)});
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {inf, -inf, std::nan(""), 1e300, -1e18}) {
    EXPECT_EQ(trim.classify(Vec2(bad, 1)), Side::outside);
    EXPECT_EQ(trim.classify(Vec2(1, bad)), Side::outside);
  }
}

TEST(TrimRegion, RefusesInfinitePcurvesAndNamesFaceAndEdge) {
  const double inf = std::numeric_limits<double>::infinity();
  const Trim endless{Line<2>{Vec2(0, 0), Vec2(1, 0)}, {0.0, inf}};
  try {
    (void)region(Plane{}, {{endless}});
    FAIL() << "no error";
  } catch (const GeometryError& error) {
    EXPECT_EQ(error.where(), "face #17, edge #23");
  }
  const Trim broken{Line<2>{Vec2(0, std::nan("")), Vec2(1, 0)}, {0.0, 1.0}};
  EXPECT_THROW((void)region(Plane{}, {{broken}}), GeometryError);
  EXPECT_THROW((void)region(unit_cylinder(), {rectangle(0, 0, 1e6, 2)}), GeometryError);
}

}  // namespace
}  // namespace lamella
