#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

#include "materials/color.h"
#include "materials/material_rules.h"
#include "tests/materials/solids.h"

namespace lamella {
namespace {

using ::testing::ElementsAre;

const Color kRed{1, 0, 0};
const Color kBlue{0, 0, 1};

TEST(AssignWithoutRules, StepMaterialThenColorThenName) {
  const MaterialTable table =
      assign_materials(test::bare_scene({{"a", "Steel", kRed}, {"b", "", kRed}, {"c"}, {"d", "Steel", kBlue}}));
  EXPECT_THAT(test::material_names(table), ElementsAre("Steel", "red #ff0000", "c", "Steel"));
  EXPECT_EQ(table.assignments[SolidId{0}].rule, "STEP material");
  EXPECT_EQ(table.assignments[SolidId{1}].rule, "color");
  EXPECT_EQ(table.assignments[SolidId{2}].rule, "name");
}

TEST(AssignWithoutRules, IdsAndColorsDontDependOnTheOrderOfTheSolids) {
  std::vector<test::BareSolid> solids{{"a", "Steel", kRed, "", 7.85}, {"b", "", kRed},     {"c"},
                                      {"d", "Steel", kBlue},          {"e", "PLA", kBlue}, {"PLA"}};
  const MaterialTable table = assign_materials(test::bare_scene(solids));
  const auto by_name = [](const test::BareSolid& x, const test::BareSolid& y) { return x.name < y.name; };
  std::sort(solids.begin(), solids.end(), by_name);
  do {
    const MaterialTable other = assign_materials(test::bare_scene(solids));
    ASSERT_EQ(other.materials.size(), table.materials.size());
    for (const MaterialId id : table.materials.ids()) {
      EXPECT_EQ(other.materials[id].name, table.materials[id].name);
      EXPECT_EQ(other.materials[id].color, table.materials[id].color);
      EXPECT_EQ(other.materials[id].density, table.materials[id].density);
    }
  } while (std::next_permutation(solids.begin(), solids.end(), by_name));
}

TEST(AssignWithoutRules, EveryMaterialHasAColorOfItsOwn) {
  const MaterialTable table = assign_materials(test::bare_scene(
      {{"a", "Steel", kRed}, {"b", "Brass", kRed}, {"c"}, {"d"}, {"e", "", kRed}, {"f", "PLA", kBlue}}));
  std::set<std::string> colors;
  for (const Material& material : table.materials) colors.insert(format_color(material.color));
  EXPECT_EQ(colors.size(), table.materials.size());
  EXPECT_EQ(format_color(table.materials[table.assignments[SolidId{5}].material].color), "#0000ff");
}

TEST(AssignWithoutRules, DensityComesFromTheStepFile) {
  const MaterialTable table =
      assign_materials(test::bare_scene({{"a", "Steel", {}, "", 7.85}, {"b", "Steel"}, {"c", "PLA"}}));
  EXPECT_THAT(test::material_names(table), ElementsAre("Steel", "Steel", "PLA"));
  EXPECT_EQ(table.materials[table.assignments[SolidId{1}].material].density, 7.85);
  EXPECT_FALSE(table.materials[table.assignments[SolidId{2}].material].density.has_value());
}

TEST(AssignWithoutRules, OneNameWithTwoDensitiesMeansTwoMaterials) {
  const MaterialTable table =
      assign_materials(test::bare_scene({{"a", "Steel", {}, "", 7.85}, {"b", "Steel", {}, "", 7.9}}));
  EXPECT_THAT(test::material_names(table), ElementsAre("Steel 7.85 g/cm3", "Steel 7.9 g/cm3"));
  EXPECT_EQ(table.materials[MaterialId{1}].density, 7.9);
}

TEST(AssignWithoutRules, ADensityBeyondAnyMaterialIsUnknown) {
  const MaterialTable table =
      assign_materials(test::bare_scene({{"a", "Steel", {}, "", 7850.0}, {"b", "PLA", {}, "", -1.0}}));
  for (const Material& material : table.materials) EXPECT_FALSE(material.density.has_value());
}

TEST(AssignWithoutRules, ANameDoesNotJoinAStepMaterialOfThatName) {
  const MaterialTable table = assign_materials(test::bare_scene({{"x", "Steel"}, {"Steel"}}));
  EXPECT_THAT(test::material_names(table), ElementsAre("Steel", "Steel (name)"));
}

TEST(AssignWithoutRules, NamesAreMadePresentable) {
  const MaterialTable table = assign_materials(test::bare_scene({{""}, {" a\nb\x1B "}, {"\xFF"}}));
  EXPECT_THAT(test::material_names(table), ElementsAre("unnamed", "a b", "unnamed (name)"));
}

}  // namespace
}  // namespace lamella
