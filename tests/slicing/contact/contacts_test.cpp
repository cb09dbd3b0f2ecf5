#include "slicing/contact/contacts.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

#include "slicing/combine.h"
#include "slicing/contact/alike_pairs.h"
#include "tests/slicing/contact/touching_solids.h"

namespace lamella {
namespace {

using test::Placement;

std::vector<Contact> contacts_of(const Scene& scene, double reach, std::optional<double> tolerance = {}) {
  const auto measures = measure_solids(scene);
  const auto rank = rank_solids(scene, test::one_material_each(scene), measures);
  std::vector<SolidId> solids;
  for (const SolidId solid : scene.solids.ids()) solids.push_back(solid);
  const SolidDistances distances(scene);
  return find_contacts(distances, measures, rank, solids, {tolerance, reach, 2});
}

TEST(Contacts, CoveredFacesAreMeasuredExactly) {
  for (const double angle : {0.0, 0.3, kPi / 6}) {
    Scene scene;
    test::SolidOptions options;
    options.placement = Placement::turned(Vec3(1, 1, 0).normalized(), angle);
    test::add_box(scene, {0, 0, 0}, {3, 3, 1}, options);
    test::add_box(scene, {1, 1, 1}, {2, 2.5, 2}, options);
    const auto contacts = contacts_of(scene, 0.1);
    ASSERT_EQ(contacts.size(), 1U);
    EXPECT_NEAR(contacts[0].touching_area, 1.5, 1e-9);
    EXPECT_LT(contacts[0].largest_gap, 1e-12);
    EXPECT_EQ(contacts[0].gap_area, 0.0);
  }
}

TEST(Contacts, PartlyCoveredFacesAreMeasuredToTheResolution) {
  Scene scene;
  test::add_box(scene, {0, 0, 0}, {2, 1, 1});
  test::add_box(scene, {0.77, 0.31, 1}, {3, 2, 2});
  const auto contacts = contacts_of(scene, 0.01);
  ASSERT_EQ(contacts.size(), 1U);
  const double exact = (2.0 - 0.77) * (1.0 - 0.31);
  EXPECT_NEAR(contacts[0].touching_area, exact, 0.1 * exact);
}

TEST(Contacts, RoundAndTrimmedFaces) {
  Scene scene;
  test::add_box_with_hole(scene, {-2, -2, 0}, {2, 2, 1}, 0.5);
  test::SolidOptions pin;
  pin.name = "pin";
  test::add_cylinder(scene, 0.5, 1.0, pin);
  const auto contacts = contacts_of(scene, 0.05);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_NEAR(contacts[0].touching_area, kPi, 1e-6);
}

TEST(Contacts, EdgesAndCornersAreNoContact) {
  Scene scene;
  test::add_box(scene, {0, 0, 0}, {1, 1, 1});
  test::add_box(scene, {1, 1, 0}, {2, 2, 1});
  test::add_box(scene, {1, 1, 1}, {2, 2, 2}, {Placement::at({0, 0, 1}), "corner", "", {}});
  EXPECT_TRUE(contacts_of(scene, 0.05).empty());
}

/// Flush tops of an insert and its matrix lie in one plane, not along one another.
TEST(Contacts, FlushFacesAreNoContact) {
  Scene scene;
  test::add_box_with_hole(scene, {-2, -2, 0}, {2, 2, 1}, 0.5);
  test::SolidOptions pin;
  pin.name = "pin";
  test::add_cylinder(scene, 0.45, 1.0, pin);
  const auto contacts = contacts_of(scene, 0.1);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].touching_area, 0.0);
  EXPECT_NEAR(contacts[0].least_gap, 0.05, 1e-12);
  EXPECT_NEAR(contacts[0].widest_gap, 0.05, 1e-12);
  EXPECT_NEAR(contacts[0].gap_volume, 0.05 * contacts[0].gap_area, 1e-12);
  // The gap's area is that of the pin's side, of which the hole's is larger.
  EXPECT_NEAR(contacts[0].gap_area, 2.0 * kPi * 0.45, 1e-6);
}

/// A block turned into another: the gap is a strip that begins in the middle of a face and is as wide as two pieces.
TEST(Contacts, AGapThatNarrowsToNothingIsMeasuredFinerThanAFace) {
  constexpr double kReach = 0.05;
  for (const double angle : {0.05, 0.1, 0.2}) {
    Scene scene;
    test::add_box(scene, {0, 0, 0}, {4, 4, 1});
    test::SolidOptions options;
    options.placement = Placement::turned(Vec3::UnitY(), angle);
    options.placement.translation = Vec3(2, 0, 1);
    test::add_box(scene, {-1.8, 0.5, 0}, {1.8, 3.5, 1}, options);
    const auto contacts = contacts_of(scene, kReach);
    ASSERT_EQ(contacts.size(), 1U);
    const double exact = 3.0 * kReach / std::sin(angle);
    constexpr double kPiece = 0.04;  // half a sixty-fourth of the face
    EXPECT_NEAR(contacts[0].gap_area, exact, 3.0 * kPiece) << angle;
    EXPECT_NEAR(contacts[0].gap_volume, 0.5 * kReach * exact, 3.0 * kPiece * kReach) << angle;
  }
}

/// Two balls: what touches is the cap of one whose points are within the tolerance of the other.
TEST(Contacts, AnInterfaceThatEndsInsideAFaceIsMeasuredWithoutBias) {
  constexpr double kApart = 2.1;
  Scene scene;
  test::add_sphere(scene, 1.0);
  test::add_sphere(scene, 1.0, {Placement::at(Vec3(0.0, 0.0, kApart)), "second"});
  double sum = 0.0;
  double exact_sum = 0.0;
  for (const double tolerance : {0.15, 0.17, 0.19, 0.21, 0.23}) {
    const auto contacts = contacts_of(scene, 0.5, tolerance);
    ASSERT_EQ(contacts.size(), 1U);
    const double cosine = (1.0 + kApart * kApart - (1.0 + tolerance) * (1.0 + tolerance)) / (2.0 * kApart);
    const double exact = 2.0 * kPi * (1.0 - cosine);
    const double half_a_piece = 0.5 * 2.0 * std::sqrt(3.0) / 64.0;
    EXPECT_NEAR(contacts[0].touching_area, exact, 2.0 * kPi * std::sqrt(1.0 - cosine * cosine) * half_a_piece);
    sum += contacts[0].touching_area;
    exact_sum += exact;
  }
  EXPECT_NEAR(sum, exact_sum, 0.04 * exact_sum);
}

TEST(Contacts, AThirdSolidInTheGapClosesIt) {
  Scene scene;
  test::add_box(scene, {0, 0, 0}, {1, 1, 1});
  test::add_box(scene, {0, 0, 1.02}, {1, 1, 2});
  EXPECT_EQ(contacts_of(scene, 0.05).size(), 1U);
  test::add_box(scene, {0, 0, 1}, {1, 1, 1.02});
  for (const Contact& contact : contacts_of(scene, 0.05)) {
    EXPECT_EQ(contact.gap_area, 0.0) << contact.first.value() << " " << contact.second.value();
  }
}

/// A block of 2 x 1 x 1 mm as an instance of one body.
SolidId add_copy(Scene& scene, const Placement& place, std::size_t body = 0) {
  const std::size_t first = scene.faces.size();
  test::SolidOptions options;
  options.placement = place;
  options.name = "copy " + std::to_string(scene.solids.size());
  const SolidId id = body == 0 ? test::add_box(scene, {0, 0, 0}, {2, 1, 1}, options).id
                               : test::add_cylinder(scene, 0.4, 1.0, options).id;
  scene.solids[id].info.instance = Instance{body, place.linear, place.translation};
  for (std::size_t f = first; f < scene.faces.size(); ++f) {
    scene.faces[FaceId{f}].step_entity = static_cast<int>(100 * body + 1 + f - first);
  }
  return id;
}

TEST(Contacts, OpenGapsBetweenCopiesAreFound) {
  Scene scene;
  add_copy(scene, {});
  add_copy(scene, Placement::at({0, 1.03, 0}));
  const auto contacts = contacts_of(scene, 0.05);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].touching_area, 0.0);
  EXPECT_NEAR(contacts[0].gap_area, 2.0, 1e-9);
  EXPECT_NEAR(contacts[0].gap_volume, 0.03 * 2.0, 1e-9);
  EXPECT_NEAR(contacts[0].least_gap, 0.03, 1e-12);
  EXPECT_NEAR(contacts[0].widest_gap, 0.03, 1e-12);
  Scene aside;
  add_copy(aside, {});
  add_copy(aside, Placement::at({0.3, 1.03, 0}));
  const auto partly = contacts_of(aside, 0.05);
  ASSERT_EQ(partly.size(), 1U);
  // Right to the border's length times a 16th of the face's size.
  EXPECT_NEAR(partly[0].gap_area, 1.7, 1.0 * std::hypot(2.0, 1.0) / 16.0);
}

TEST(Contacts, OpenGapsBetweenTurnedCopiesAreFound) {
  Scene scene;
  add_copy(scene, {});
  // Turned by 90 degrees it takes [2.02, 3.02] x [0, 2] x [0, 1]; by 2 degrees more its side opens like a wedge.
  add_copy(scene, Placement::turned(Vec3::UnitZ(), kPi / 2, Vec3(3.02, 0, 0)));
  const auto square = contacts_of(scene, 0.05);
  ASSERT_EQ(square.size(), 1U);
  EXPECT_NEAR(square[0].gap_area, 1.0, 1e-9);
  EXPECT_NEAR(square[0].gap_volume, 0.02, 1e-9);
  Scene wedge;
  add_copy(wedge, {});
  const double angle = kPi / 2 - 0.02;
  const Mat3 turn = Placement::turned(Vec3::UnitZ(), angle).linear;
  // The corner that was (0, 1, 0) lies at (2.01, 0, 0).
  add_copy(wedge, {turn, Vec3(2.01, 0, 0) - turn * Vec3(0, 1, 0)});
  const auto open = contacts_of(wedge, 0.05);
  ASSERT_EQ(open.size(), 1U);
  EXPECT_NEAR(open[0].gap_area, 1.0, 1.0 / 64.0);
  EXPECT_NEAR(open[0].least_gap, 0.01, 2e-3);
  EXPECT_NEAR(open[0].widest_gap, 0.03, 2e-3);
  EXPECT_NEAR(open[0].gap_volume, 0.02, 1e-3);
}

/// A tray of blocks in columns and rows, 0.03 and 0.02 mm apart, a pin in a corner of each gap of the first row.
Scene tray_of(int columns, int rows) {
  Scene scene;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) add_copy(scene, Placement::at({2.03 * column, 1.02 * row, 0}));
  }
  for (int column = 0; column < columns; ++column) {
    add_copy(scene, Placement::at({2.03 * column + 0.7, -0.41, 0}), 1);
  }
  return scene;
}

TEST(Contacts, OfATrayAreThoseOfItsPairsOneByOne) {
  const Scene tray = tray_of(4, 5);
  Scene loose = tray;
  for (Solid& solid : loose.solids) solid.info.instance.reset();
  const auto expected = contacts_of(loose, 0.05);
  const auto found = contacts_of(tray, 0.05);
  // 3 x 5 and 4 x 4 gaps between blocks, a pin before each of four; corners and pins' sides touch nothing.
  ASSERT_EQ(expected.size(), 15U + 16U + 4U);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].first, expected[i].first);
    EXPECT_EQ(found[i].second, expected[i].second);
    EXPECT_NEAR(found[i].gap_area, expected[i].gap_area, 1e-9);
    EXPECT_NEAR(found[i].gap_volume, expected[i].gap_volume, 1e-9);
    EXPECT_NEAR(found[i].least_gap, expected[i].least_gap, 1e-9);
    EXPECT_NEAR(found[i].widest_gap, expected[i].widest_gap, 1e-9);
    EXPECT_EQ(found[i].touching_area, 0.0);
  }
}

TEST(Contacts, OfCopiesThatLieAlikeAreSearchedForOnce) {
  const double touching = 0.04;  // the gap tolerance: copies touch that are no cluster
  const Scene tray = tray_of(12, 10);
  const auto measures = measure_solids(tray);
  const auto contacts = contacts_of(tray, 0.05, touching);
  std::set<const void*> searched;
  std::size_t between_blocks = 0;
  for (const Contact& contact : contacts) {
    if (!contact.patches) continue;
    searched.insert(contact.patches.get());
    const bool is_pin = contact.second.value() >= 120;
    EXPECT_NEAR(contact.touching_area, is_pin ? contact.touching_area : contact.largest_gap < 0.025 ? 2.0 : 1.0, 1e-9);
    between_blocks += is_pin ? 0 : 1;
    // Patches lie where the solids are.
    const Vec3 patch = contact.patches->front().center + contact.offset;
    EXPECT_LT(measures[contact.first].bounds.exteriorDistance(patch), 0.05);
    EXPECT_LT(measures[contact.second].bounds.exteriorDistance(patch), 0.05);
    for (const FaceId face : contact.faces) {
      const SolidId solid = tray.solid_of(face);
      EXPECT_TRUE(solid == contact.first || solid == contact.second);
    }
  }
  EXPECT_EQ(between_blocks, 11U * 10U + 12U * 9U);
  // Surroundings differ in the corners, along the sides and inside, and by who comes first: not from copy to copy.
  EXPECT_LE(searched.size(), 60U);
}

/// Two clusters that are copied, side by side: what lies between the two first ones is no part of either.
TEST(Contacts, BetweenClustersOfTwoKindsAreTheirOwn) {
  Scene scene;
  for (const double x : {0.0, 10.0, 30.0}) {
    add_copy(scene, Placement::at({x, 0, 0}));
    // Beside the first block, and elsewhere for the others.
    add_copy(scene, Placement::at({x == 30.0 ? 25.0 : x + 0.8, x == 0.0 ? -0.41 : -3.0, 0}), 1);
  }
  const auto contacts = contacts_of(scene, 0.05);
  ASSERT_EQ(contacts.size(), 1U);
  EXPECT_EQ(contacts[0].first, SolidId{0});
  EXPECT_EQ(contacts[0].second, SolidId{1});
}

/// An instance near a pair is told from another one at its place: one closes the gap, the other lies beside it.
TEST(Contacts, WhatIsNearTwoCopiesCounts) {
  Scene scene;
  for (const double x : {0.0, 10.0}) {
    add_copy(scene, Placement::at({x, 0, 0}));
    add_copy(scene, Placement::at({x, 1.03, 0}));
    const std::size_t first = scene.faces.size();
    const bool closes = x == 0.0;
    const Placement place = Placement::at({x, 0, 0});
    const SolidId id = closes ? test::add_box(scene, {0, 1.00001, 0}, {2, 1.02999, 1}, {place, "foil", "", {}}).id
                              : test::add_box(scene, {0, -0.03, 0}, {2, -0.01, 1}, {place, "plate", "", {}}).id;
    scene.solids[id].info.instance = Instance{closes ? 5U : 6U, place.linear, place.translation};
    for (std::size_t f = first; f < scene.faces.size(); ++f) {
      scene.faces[FaceId{f}].step_entity = static_cast<int>((closes ? 500 : 600) + f - first);
    }
  }
  bool is_open = false;
  for (const Contact& contact : contacts_of(scene, 0.05)) {
    if (contact.first == SolidId{0} && contact.second == SolidId{1}) {
      EXPECT_EQ(contact.gap_area, 0.0);
    }
    if (contact.first != SolidId{3} || contact.second != SolidId{4}) continue;
    EXPECT_NEAR(contact.gap_area, 2.0, 1e-9);
    is_open = true;
  }
  EXPECT_TRUE(is_open);
}

/// The numbers of pairs that are searched, and that are like them.
std::vector<std::size_t> sizes_of(const std::vector<AlikePairs>& alike) {
  std::vector<std::size_t> sizes;
  for (const AlikePairs& one : alike) sizes.push_back(1 + one.like.size());
  return sizes;
}

TEST(AlikePairs, AreThoseThatTheSceneShowsToBeShifted) {
  Scene scene;
  for (const double x : {20.0, 0.0, 10.0}) {
    add_copy(scene, Placement::at({x, 0, 0}));
    add_copy(scene, Placement::at({x, 1.03, 0}));
  }
  const std::vector<SolidPair> pairs{{SolidId{0}, SolidId{1}}, {SolidId{2}, SolidId{3}}, {SolidId{4}, SolidId{5}}};
  auto alike = find_alike_pairs(scene, pairs);
  ASSERT_EQ(sizes_of(alike), (std::vector<std::size_t>{3}));
  // The first is the one that lies lowest, not that of the lowest ids.
  EXPECT_EQ(alike[0].first, 1U);
  EXPECT_EQ(shift_between(scene, SolidId{3}, SolidId{5}), Vec3(10, 0, 0));
  // The other way round it is another pair.
  const std::vector<SolidPair> turned{pairs[0], {SolidId{3}, SolidId{2}}, pairs[2]};
  EXPECT_EQ(sizes_of(find_alike_pairs(scene, turned)), (std::vector<std::size_t>{2, 1}));
  // Somebody moves a solid, or says that it is moved by a hair, or that it isn't sound.
  Scene moved = scene;
  moved.vertices[moved.vertices.ids().first].point.x() += 1e-3;
  EXPECT_EQ(find_alike_pairs(moved, pairs).size(), 2U);
  Scene aside = scene;
  aside.solids[SolidId{5}].info.instance->shift.y() += 1e-7;
  EXPECT_EQ(find_alike_pairs(aside, pairs).size(), 2U);
  Scene open = scene;
  open.solids[SolidId{5}].info.closed = false;
  EXPECT_EQ(find_alike_pairs(open, pairs).size(), 2U);
  EXPECT_TRUE(find_alike_pairs(scene, {}).empty());
}

TEST(Contacts, AThirdSolidBetweenTwoOfManyCopiesClosesTheirGapOnly) {
  Scene scene;
  for (int i = 0; i < 4; ++i) add_copy(scene, Placement::at({0, 1.03 * i, 0}));
  test::add_box(scene, {0, 2.06 - 0.03 + 1e-5, 0}, {2, 2.06 - 1e-5, 1});
  std::size_t open = 0;
  for (const Contact& contact : contacts_of(scene, 0.05)) {
    if (contact.second.value() == 4 || !(contact.gap_area > 0.0)) continue;
    EXPECT_NEAR(contact.gap_area, 2.0, 1e-9);
    EXPECT_FALSE(contact.first == SolidId{1} && contact.second == SolidId{2});
    ++open;
  }
  EXPECT_EQ(open, 2U);
}

}  // namespace
}  // namespace lamella
