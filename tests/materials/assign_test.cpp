#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/color.h"
#include "materials/material_rules.h"
#include "tests/materials/solids.h"

namespace lamella {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

MaterialRule rule(std::optional<std::string> name, std::string material) {
  MaterialRule out;
  out.name = std::move(name);
  out.material = std::move(material);
  out.where = "m.xml:9";
  return out;
}

MaterialRules steel_and_rubber() {
  MaterialRules rules;
  rules.library = {{"steel", 7.85, {}}, {"rubber", 1.1, {}}};
  rules.priorities = {10, 0};
  rules.source = "m.xml";
  return rules;
}

TEST(AssignByRules, TheFirstThatMatchesWins) {
  const Scene scene = test::bare_scene({{"bolt.1"}, {"bolt.2"}, {"grip"}});
  MaterialRules rules = steel_and_rubber();
  rules.rules = {rule("bolt.1", "rubber"), rule("bolt*", "steel"), rule("*", "rubber")};
  const MaterialTable table = assign_materials(scene, rules);
  EXPECT_THAT(test::material_names(table), ElementsAre("rubber", "steel", "rubber"));
  EXPECT_EQ(table.assignments[SolidId{1}].rule, "m.xml:9 name=bolt*");
}

TEST(AssignByRules, AllSelectorsOfARuleMustMatch) {
  const Scene scene =
      test::bare_scene({{"a", "AISI 304", Color{1, 0, 0}, "metal"}, {"a", "AISI 304", Color{1, 0, 0}, "other"}});
  MaterialRules rules = steel_and_rubber();
  MaterialRule strict = rule("a", "steel");
  strict.step_material = "AISI*";
  strict.color = parse_color("#ff0000");
  strict.layer = "metal";
  strict.path = "/assembly/*";
  rules.rules = {strict};
  rules.fallback = "rubber";
  EXPECT_THAT(test::material_names(assign_materials(scene, rules)), ElementsAre("steel", "rubber"));
}

TEST(AssignByRules, PriorityComesFromTheRuleElseFromTheLibrary) {
  const Scene scene = test::bare_scene({{"a"}, {"b"}, {"c"}});
  MaterialRules rules = steel_and_rubber();
  rules.rules = {rule("a", "steel"), rule("b", "steel")};
  rules.rules[1].priority = 3;
  rules.fallback = "steel";
  const MaterialTable table = assign_materials(scene, rules);
  EXPECT_EQ(table.assignments[SolidId{0}].priority, 10);
  EXPECT_EQ(table.assignments[SolidId{1}].priority, 3);
  EXPECT_EQ(table.assignments[SolidId{2}].priority, 10);
  EXPECT_EQ(table.assignments[SolidId{2}].rule, "m.xml default");
}

TEST(AssignByRules, EverySolidThatNoRuleCoversIsListed) {
  const Scene scene = test::bare_scene({{"bolt"}, {"grip"}, {"lid"}});
  MaterialRules rules = steel_and_rubber();
  rules.rules = {rule("bolt", "steel")};
  try {
    (void)assign_materials(scene, rules);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("2 solids"));
    EXPECT_THAT(error.what(), HasSubstr("/assembly/grip"));
    EXPECT_THAT(error.what(), HasSubstr("/assembly/lid"));
    EXPECT_EQ(error.where(), "m.xml");
    EXPECT_THAT(error.hint(), HasSubstr("default"));
  }
}

TEST(AssignByRules, ASolidWithoutColorMatchesNoColorRule) {
  const Scene scene = test::bare_scene({{"a"}});
  MaterialRules rules = steel_and_rubber();
  rules.rules = {rule(std::nullopt, "steel")};
  rules.rules[0].color = Color{0.5, 0.5, 0.5};
  EXPECT_THROW((void)assign_materials(scene, rules), InputError);
}

TEST(AssignByRules, MaterialIdsFollowTheLibrary) {
  const MaterialTable table = [] {
    MaterialRules rules = steel_and_rubber();
    rules.fallback = "rubber";
    return assign_materials(test::bare_scene({{"a"}}), rules);
  }();
  EXPECT_EQ(table.materials[MaterialId{0}].name, "steel");
  EXPECT_EQ(table.assignments[SolidId{0}].material, MaterialId{1});
}

TEST(UnusedRules, AreNamedWithTheirReason) {
  const Scene scene = test::bare_scene({{"bolt"}});
  MaterialRules rules = steel_and_rubber();
  rules.rules = {rule("bolt", "steel"), rule("b*", "rubber"), rule("blot", "steel")};
  const std::vector<Finding> findings = find_unused_rules(scene, rules);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].hint, HasSubstr("earlier"));
  EXPECT_THAT(findings[1].what, HasSubstr("blot"));
  EXPECT_THAT(findings[1].hint, HasSubstr("nothing"));
}

}  // namespace
}  // namespace lamella
