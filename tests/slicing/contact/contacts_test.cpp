#include "slicing/contact/contacts.h"

#include <cmath>
#include <gtest/gtest.h>

#include "slicing/combine.h"
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

}  // namespace
}  // namespace lamella
