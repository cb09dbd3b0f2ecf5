#include "slicing/slivers.h"

#include <gtest/gtest.h>

#include "tests/slicing/combine_row.h"

namespace lamella {
namespace {

using test::faces_of_tolerance;
using test::Row;
using test::segment;

TEST(Slivers, GoToTheNeighbourOfHigherRank) {
  Row row;
  const SolidId a = row.add_solid(0, 1, 0);
  const SolidId b = row.add_solid(1, 2, 0);
  const SolidId below = row.add_solid(2, 0, 0);
  row.add_span(below, 0, 10);
  row.add_span(a, 2, 5);
  row.add_span(b, 5 + 1e-9, 10 - 1e-9);
  EXPECT_EQ(row.combine().segments, (std::vector{segment(0, 2, 2, below), segment(2, 5, 0, a), segment(5, 10, 1, b)}));
}

TEST(Slivers, MakeOneOfTheRunsOnBothSides) {
  Row row;
  const SolidId a = row.add_solid(0, 1, 0);
  const SolidId below = row.add_solid(1, 0, 0);
  row.add_span(below, 0, 10);
  row.add_span(a, 2, 5);
  row.add_span(a, 5 + 1e-9, 7);
  EXPECT_EQ(row.combine().segments,
            (std::vector{segment(0, 2, 1, below), segment(2, 7, 0, a), segment(7, 10, 1, below)}));
}

TEST(Slivers, AreKnownByTheTolerancesOfTheFacesAroundThem) {
  Row row;
  row.rules.widen_at(faces_of_tolerance(0.5));
  const SolidId a = row.add_solid(0, 1, 0);
  const SolidId below = row.add_solid(1, 0, 0);
  row.add_span(below, 0, 10);
  row.spans.push_back({2, 5, a, FaceId{}, FaceId{0}});
  row.spans.push_back({5.25, 7, a, FaceId{}, FaceId{}});
  row.spans.push_back({7.25, 8, a, FaceId{}, FaceId{}});
  EXPECT_EQ(row.combine().segments,
            (std::vector{segment(0, 2, 1, below), segment(2, 7, 0, a), segment(7, 7.25, 1, below),
                         segment(7.25, 8, 0, a), segment(8, 10, 1, below)}));
}

TEST(Slivers, AreNotBodiesThatAreThinnerThanTheTolerance) {
  Row row;
  row.rules.gap_tolerance = 0.5;
  const SolidId a = row.add_solid(0, 0, 0);
  const SolidId coat = row.add_solid(1, 0, 1);
  row.add_span(a, 0, 5);
  row.add_span(coat, 5, 5.25);
  EXPECT_EQ(row.combine().segments, (std::vector{segment(0, 5, 0, a), segment(5, 5.25, 1, coat)}));
}

/// What ends at a row's end has a neighbour on one side, and what stands alone none.
TEST(Slivers, WithVoidOnOneSideGoToTheOther) {
  Row row;
  const SolidId a = row.add_solid(0, 1, 0);
  const SolidId below = row.add_solid(1, 0, 0);
  row.add_span(below, 0, 5 + 1e-9);
  row.add_span(a, 2, 5);
  row.add_span(below, 7, 7 + 1e-9);
  EXPECT_EQ(row.combine().segments,
            (std::vector{segment(0, 2, 1, below), segment(2, 5 + 1e-9, 0, a), segment(7, 7 + 1e-9, 1, below)}));
}

}  // namespace
}  // namespace lamella
