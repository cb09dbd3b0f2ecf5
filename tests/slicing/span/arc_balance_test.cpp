/// The check of arcs against the normals of their faces: right arcs pass, wrong ones don't, at any angle of the rows.

#include "slicing/span/arc_balance.h"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/support/cut_scene.h"

namespace lamella::span {
namespace {

constexpr double kTolerance = 1e-6;

/// A section of one arc, with the normals that belong to its direction: n = (T_y, -T_x).
Section with_normals(Section section, const Vec2& begin_tangent, const Vec2& end_tangent) {
  SectionArc& arc = section.arcs.front();
  arc.begin_normal = Vec2(begin_tangent.y(), -begin_tangent.x());
  arc.end_normal = Vec2(end_tangent.y(), -end_tangent.x());
  return section;
}

Section chord(const Vec2& from, const Vec2& to) {
  Section section;
  SectionArc arc;
  arc.begin = from;
  arc.end = to;
  arc.piece_count = 1;
  arc.straight = true;
  section.arcs.push_back(arc);
  section.pieces.push_back(straight_piece(from, to));
  return with_normals(section, to - from, to - from);
}

/// y = t^2, x = t: over t from -0.5 to 0.5 as one piece.
Section parabola() {
  Section section;
  ArcPiece piece;
  piece.x = {-0.5, 1.0};
  piece.y = {0.25, -1.0, 1.0};
  SectionArc arc;
  arc.begin = piece.at(0.0);
  arc.end = piece.at(1.0);
  arc.piece_count = 1;
  section.arcs.push_back(arc);
  section.pieces.push_back(piece);
  return with_normals(section, {1.0, -1.0}, {1.0, 1.0});
}

/// A quarter of a circle with radius 2, from +x, or backward.
Section quarter(double sense) {
  Section section;
  EllipseArc part;
  part.ellipse.cosine = Vec2(2.0, 0.0);
  part.ellipse.sine = Vec2(0.0, 2.0);
  part.sweep = sense * 0.5 * kPi;
  SectionArc arc;
  arc.begin = Vec2(2.0, 0.0);
  arc.end = Vec2(0.0, sense * 2.0);
  arc.ellipse = 0;
  section.arcs.push_back(arc);
  section.ellipses.push_back(part);
  return with_normals(section, {0.0, sense}, {-1.0, 0.0});
}

bool is_kept(const Section& section, double angle) {
  return keeps_balance(section.arcs.front(), section, test::make_lattice(angle, 0.0, 1.0, 10), kTolerance);
}

class ArcBalance : public testing::TestWithParam<double> {};

TEST_P(ArcBalance, HoldsForArcsAlongTheirFace) {
  for (const Section& section : {chord({0.0, 0.0}, {3.0, 1.0}), parabola(), quarter(1.0), quarter(-1.0)}) {
    EXPECT_TRUE(is_kept(section, GetParam()));
  }
}

TEST_P(ArcBalance, FailsWhereAnEndRunsAgainstItsFace) {
  for (Section section : {chord({0.0, 0.0}, {3.0, 1.0}), parabola(), quarter(1.0), quarter(-1.0)}) {
    SectionArc& arc = section.arcs.front();
    const Vec2 begin = arc.begin_normal;
    arc.begin_normal = -begin;
    EXPECT_FALSE(is_kept(section, GetParam()));
    if (arc.straight) continue;
    arc.begin_normal = begin;
    arc.end_normal *= -1.0;
    EXPECT_FALSE(is_kept(section, GetParam()));
  }
}

INSTANTIATE_TEST_SUITE_P(AtAngles, ArcBalance, testing::Values(0.1, 0.9, 2.0, 3.5, 4.6));

TEST(ArcBalance, SaysNothingOfNodesThatAreTurningPoints) {
  Section section = quarter(1.0);
  section.arcs.front().end_normal = Vec2(1e-6, -1.0);  // The end of the quarter is its top.
  EXPECT_TRUE(is_kept(section, 0.0));
}

TEST(ArcBalance, AllowsChordsToRunBackwardWithinTheTolerance) {
  Section section = chord({0.0, 0.0}, {5e-7, 5e-7});
  section.arcs.front().begin_normal *= -1.0;
  EXPECT_TRUE(is_kept(section, 0.3));
}

TEST(ArcBalance, NeedsNormalsToCompareWith) {
  Section section = parabola();
  section.arcs.front().begin_normal = section.arcs.front().end_normal = Vec2::Zero();
  section.pieces.front() = reversed(section.pieces.front());
  EXPECT_TRUE(is_kept(section, 0.3));
}

}  // namespace
}  // namespace lamella::span
