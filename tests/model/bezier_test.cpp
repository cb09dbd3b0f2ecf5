#include "model/bezier.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "model/evaluate.h"
#include "tests/model/random_geometry.h"

namespace lamella {
namespace {

using test::RandomGeometry;

Vec2 random_in(RandomGeometry& random, const BezierPatch& patch) {
  return {random.real(patch.u.lo, patch.u.hi), random.real(patch.v.lo, patch.v.hi)};
}

Vec3 corner(const BezierPatch& patch, double s, double t) {
  return evaluate_point(patch, patch.u.lo + s * patch.u.length(), patch.v.lo + t * patch.v.length());
}

TEST(SplitToBezier, TilesTheDomainWithoutGap) {
  RandomGeometry random(21);
  const BSplineSurface surface = random.surface(3, 2, 5, true);
  const auto patches = split_to_bezier(surface);
  ASSERT_FALSE(patches.empty());
  double area = 0.0;
  Interval u = surface.domain_u();
  double v = surface.domain_v().lo;
  for (const BezierPatch& patch : patches) {
    EXPECT_GT(patch.u.length(), 0.0);
    EXPECT_GT(patch.v.length(), 0.0);
    EXPECT_EQ(patch.v.lo, v) << "u-major, one column of patches after the other";
    v = patch.v.hi == surface.domain_v().hi ? surface.domain_v().lo : patch.v.hi;
    if (patch.v.lo == surface.domain_v().lo) {
      EXPECT_EQ(patch.u.lo, u.lo);
      u.lo = patch.u.hi;
    }
    area += patch.u.length() * patch.v.length();
  }
  EXPECT_EQ(u.lo, u.hi);
  EXPECT_NEAR(area, surface.domain_u().length() * surface.domain_v().length(), 1e-12);
}

TEST(SplitToBezier, EqualsTheSurfaceAtAllDegrees) {
  RandomGeometry random(22);
  for (int round = 0; round < 26; ++round) {
    const BSplineSurface surface = random.surface(1 + round % 13, 1 + (round * 7) % 13, 3, round % 2 == 1);
    for (const BezierPatch& patch : split_to_bezier(surface)) {
      for (int i = 0; i < 5; ++i) {
        const Vec2 uv = random_in(random, patch);
        EXPECT_LT((evaluate_point(patch, uv[0], uv[1]) - evaluate_point(surface, uv)).norm(), 1e-12);
      }
    }
  }
}

TEST(SplitToBezier, NeighboursShareTheirBorderBitForBit) {
  RandomGeometry random(23);
  const BSplineSurface surface = random.surface(4, 3, 4, true);
  const auto patches = split_to_bezier(surface);
  for (std::size_t k = 1; k < patches.size(); ++k) {
    const BezierPatch& a = patches[k - 1];
    const BezierPatch& b = patches[k];
    if (a.v.hi != b.v.lo) continue;
    for (int i = 0; i <= 4; ++i) EXPECT_EQ(a.net[i * 4 + 3], b.net[i * 4]);
  }
}

TEST(SplitToBezier, TakesSurfacesThatBreakAtAKnot) {
  // The inner knot comes degree + 1 times: two patches that don't meet.
  BSplineSurface surface;
  surface.degree_u = surface.degree_v = 1;
  surface.count_u = 4;
  surface.count_v = 2;
  surface.knots_u = {0, 0, 1, 1, 2, 2};
  surface.knots_v = {0, 0, 1, 1};
  for (const double x : {0.0, 1.0, 5.0, 6.0}) {
    surface.poles.emplace_back(x, 0, 0);
    surface.poles.emplace_back(x, 1, 0);
  }
  const auto patches = split_to_bezier(surface);
  ASSERT_EQ(patches.size(), 2u);
  EXPECT_EQ(corner(patches[0], 1, 0), Vec3(1, 0, 0));
  EXPECT_EQ(corner(patches[1], 0, 0), Vec3(5, 0, 0));
}

TEST(SplitToBezier, RefusesNetsBeyondMemory) {
  RandomGeometry random(24);
  BSplineSurface surface;
  surface.degree_u = surface.degree_v = kMaxDegree;
  for (std::vector<double>* knots : {&surface.knots_u, &surface.knots_v}) {
    knots->assign(kMaxDegree + 1, 0.0);
    for (int i = 1; i < 200; ++i) knots->push_back(i);
    knots->insert(knots->end(), kMaxDegree + 1, 200.0);
  }
  surface.count_u = surface.count_v = static_cast<int>(surface.knots_u.size()) - kMaxDegree - 1;
  surface.poles.assign(static_cast<std::size_t>(surface.count_u) * surface.count_v, Vec3::Zero());
  EXPECT_THROW((void)split_to_bezier(surface), GeometryError);
}

BezierPatch random_patch(RandomGeometry& random, int p, int q, bool rational) {
  return split_to_bezier(random.surface(p, q, 1, rational)).front();
}

TEST(BezierPatch, HalvesAndPartsEqualTheWhole) {
  RandomGeometry random(25);
  for (int round = 0; round < 20; ++round) {
    const BezierPatch patch = random_patch(random, 1 + round % 7, 1 + (round * 3) % 7, round % 2 == 0);
    const Vec2 at = random_in(random, patch);
    const auto [low_u, high_u] = split_u(patch, at[0]);
    const auto [low_v, high_v] = split_v(patch, at[1]);
    const BezierPatch part = restrict_to(patch, {patch.u.lo, at[0]}, {at[1], patch.v.hi});
    EXPECT_EQ(part.u.hi, at[0]);
    EXPECT_EQ(part.v.lo, at[1]);
    for (const BezierPatch* piece : {&low_u, &high_u, &low_v, &high_v, &part}) {
      const Vec2 uv = random_in(random, *piece);
      const Vec3 expected = evaluate_point(patch, uv[0], uv[1]);
      EXPECT_LT((evaluate_point(*piece, uv[0], uv[1]) - expected).norm(), 1e-12);
    }
  }
}

TEST(BezierPatch, RestrictingToMoreThanItselfChangesNothing) {
  RandomGeometry random(26);
  const BezierPatch patch = random_patch(random, 3, 3, true);
  const BezierPatch part = restrict_to(patch, {-100.0, 100.0}, {-100.0, 100.0});
  EXPECT_EQ(part.net, patch.net);
  EXPECT_EQ(part.u.lo, patch.u.lo);
  EXPECT_EQ(part.v.hi, patch.v.hi);
}

TEST(BezierPatch, HomogeneousDerivativesEqualTheSurfaces) {
  RandomGeometry random(27);
  for (const bool rational : {false, true}) {
    const BSplineSurface surface = random.surface(4, 3, 1, rational);
    const BezierPatch patch = split_to_bezier(surface).front();
    const Vec2 uv = random_in(random, patch);
    const HomogeneousPoint h = evaluate_homogeneous(patch, uv[0], uv[1]);
    const SurfacePoint expected = evaluate(surface, uv);
    const Vec3 point = h.value.head<3>() / h.value[3];
    EXPECT_LT((point - expected.point).norm(), 1e-13 * 10.0);
    const double scale = 1.0 + expected.du.norm() + expected.dv.norm();
    EXPECT_LT(((h.du.head<3>() - h.du[3] * point) / h.value[3] - expected.du).norm(), 1e-12 * scale);
    EXPECT_LT(((h.dv.head<3>() - h.dv[3] * point) / h.value[3] - expected.dv).norm(), 1e-12 * scale);
  }
}

TEST(ControlBox, HoldsThePatch) {
  RandomGeometry random(28);
  for (int round = 0; round < 20; ++round) {
    const BezierPatch patch = random_patch(random, 1 + round % 9, 3, round % 2 == 0);
    Box3 box = control_box(patch);
    box.min().array() -= 1e-13;
    box.max().array() += 1e-13;
    for (int i = 0; i < 200; ++i) {
      const Vec2 uv = random_in(random, patch);
      EXPECT_TRUE(box.contains(evaluate_point(patch, uv[0], uv[1])));
    }
  }
}

/// Distance of `p` from the bilinear patch of the corners, by sampling and refinement.
double distance_to_bilinear(const BezierPatch& patch, const Vec3& p) {
  const Vec3 a = corner(patch, 0, 0), b = corner(patch, 1, 0), c = corner(patch, 0, 1), d = corner(patch, 1, 1);
  double best = 1e300;
  Vec2 centre(0.5, 0.5);
  for (double width = 0.5; width > 1e-7; width *= 0.4) {
    const Vec2 middle = centre;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const Vec2 st = (middle + Vec2(i, j) * (width / 4.0)).cwiseMax(0.0).cwiseMin(1.0);
        const Vec3 low = a + st[0] * (b - a);
        const Vec3 high = c + st[0] * (d - c);
        const double distance = (low + st[1] * (high - low) - p).norm();
        if (distance < best) {
          best = distance;
          centre = st;
        }
      }
    }
  }
  return best;
}

TEST(Flatness, BoundsTheDistanceToTheBilinearPatch) {
  RandomGeometry random(29);
  for (int round = 0; round < 30; ++round) {
    const BezierPatch patch = random_patch(random, 1 + round % 4, 1 + (round / 2) % 4, round % 2 == 0);
    const double bound = flatness(patch);
    for (int i = 0; i < 60; ++i) {
      const Vec2 uv = random_in(random, patch);
      EXPECT_LE(distance_to_bilinear(patch, evaluate_point(patch, uv[0], uv[1])), bound + 1e-5);
    }
  }
}

TEST(Flatness, IsZeroForBilinearPatchesAndFallsByFourWithEachHalving) {
  RandomGeometry random(30);
  BezierPatch flat = random_patch(random, 1, 1, false);
  EXPECT_LT(flatness(flat), 1e-14);
  BezierPatch patch = random_patch(random, 3, 3, true);
  double before = flatness(patch);
  for (int i = 0; i < 12; ++i) {
    patch = split_v(split_u(patch, patch.u.middle()).first, patch.v.middle()).first;
    const double after = flatness(patch);
    EXPECT_LT(after, before);
    if (i > 8) {
      EXPECT_NEAR(before / after, 4.0, 0.2);
    }
    before = after;
  }
}

TEST(Flatness, SeesWhatUnequalWeightsDoToATwistedPatch) {
  // All control points lie on the bilinear patch; one heavy corner leaves it only along the patch, and the bound
  // must still allow for the twist.
  BezierPatch patch{2, 2, {0, 1}, {0, 1}, {}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const double s = 0.5 * i, t = 0.5 * j, w = i == 1 && j == 1 ? 100.0 : 1.0;
      patch.net.emplace_back(w * s, w * t, w * s * t, w);
    }
  }
  double largest = 0.0;
  for (int i = 0; i <= 20; ++i) {
    for (int j = 0; j <= 20; ++j) {
      largest = std::max(largest, distance_to_bilinear(patch, evaluate_point(patch, i / 20.0, j / 20.0)));
    }
  }
  EXPECT_GT(largest, 1e-3) << "the case must show something";
  EXPECT_GE(flatness(patch), largest);
}

TEST(BezierCurve2, SplitsReversesAndBounds) {
  RandomGeometry random(31);
  BezierCurve2 curve{{2.0, 5.0}, {}};
  for (int i = 0; i < 5; ++i) {
    const Vec2 p = random.point<2>();
    const double w = random.real(0.5, 2.0);
    curve.net.emplace_back(w * p[0], w * p[1], w);
  }
  const auto [low, high] = split(curve, 3.0);
  EXPECT_EQ(low.net.back(), high.net.front());
  Box2 box = control_box(curve);
  box.min().array() -= 1e-13;
  box.max().array() += 1e-13;
  for (double t = 2.0; t <= 5.0; t += 0.125) {
    const Vec2 expected = evaluate_point(curve, t);
    EXPECT_TRUE(box.contains(expected));
    EXPECT_LT((evaluate_point(t <= 3.0 ? low : high, t) - expected).norm(), 1e-13 * 10.0);
    EXPECT_LT((evaluate_point(reversed(curve), t) - expected).norm(), 1e-13 * 10.0);
  }
}

}  // namespace
}  // namespace lamella
