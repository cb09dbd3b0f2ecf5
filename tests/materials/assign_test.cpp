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

LibraryMatch match(std::size_t material, MaterialSource source, std::string pattern) {
  return {material, source, std::move(pattern), {}, "lib.xml:" + std::to_string(material + 3)};
}

TEST(AssignBySource, TheDeclaredOrderDecides) {
  const Scene scene = test::bare_scene({{"grip", "AISI 304"}, {"AISI 304", "NBR"}, {"bolt", "unknown"}});
  MaterialRules rules = steel_and_rubber();
  rules.fallback = "rubber";
  rules.matches = {match(0, MaterialSource::step_material, "AISI*"), match(0, MaterialSource::name, "AISI*"),
                   match(1, MaterialSource::step_material, "NBR"), match(1, MaterialSource::name, "grip")};
  rules.sources = {MaterialSource::step_material, MaterialSource::name};
  EXPECT_THAT(test::material_names(assign_materials(scene, rules)), ElementsAre("steel", "rubber", "rubber"));
  rules.sources = {MaterialSource::name, MaterialSource::step_material};
  const MaterialTable table = assign_materials(scene, rules);
  EXPECT_THAT(test::material_names(table), ElementsAre("rubber", "steel", "rubber"));
  EXPECT_EQ(table.assignments[SolidId{1}].rule, "lib.xml:3 name=AISI*");
  EXPECT_EQ(table.assignments[SolidId{1}].priority, 10);
  EXPECT_EQ(table.assignments[SolidId{2}].rule, "m.xml default");
}

TEST(AssignBySource, WithoutSourcesTheLibraryIsNotAsked) {
  const Scene scene = test::bare_scene({{"grip", "AISI 304"}});
  MaterialRules rules = steel_and_rubber();
  rules.matches = {match(0, MaterialSource::step_material, "AISI*")};
  rules.fallback = "rubber";
  EXPECT_THAT(test::material_names(assign_materials(scene, rules)), ElementsAre("rubber"));
}

TEST(AssignBySource, ColorsMatchAsRounded) {
  const Scene scene = test::bare_scene({{"a", "", Color{1.0, 0.001, 0.0}}, {"b"}});
  MaterialRules rules = steel_and_rubber();
  rules.matches = {{0, MaterialSource::color, "", parse_color("#ff0000"), "lib.xml:3"}};
  rules.sources = {MaterialSource::color};
  rules.fallback = "rubber";
  EXPECT_THAT(test::material_names(assign_materials(scene, rules)), ElementsAre("steel", "rubber"));
}

TEST(AssignBySource, RulesAndOverridesGoBefore) {
  const Scene scene = test::bare_scene({{"a", "steel"}, {"b", "steel"}, {"c", "steel"}});
  MaterialRules rules = steel_and_rubber();
  rules.matches = {match(0, MaterialSource::step_material, "steel")};
  rules.sources = {MaterialSource::step_material};
  rules.rules = {rule("a", "steel"), rule("b", "rubber")};
  rules.overrides = {{"/assembly/a", "rubber", 5, "m.xml:7"}};
  const MaterialTable table = assign_materials(scene, rules);
  EXPECT_THAT(test::material_names(table), ElementsAre("rubber", "rubber", "steel"));
  EXPECT_EQ(table.assignments[SolidId{0}].priority, 5);
  EXPECT_EQ(table.assignments[SolidId{0}].rule, "m.xml:7 path=/assembly/a");
}

TEST(AssignBySource, TwoMaterialsForOneSolidAreRefused) {
  const Scene scene = test::bare_scene({{"grip", "AISI 304"}});
  MaterialRules rules = steel_and_rubber();
  rules.matches = {match(0, MaterialSource::step_material, "AISI*"), match(1, MaterialSource::step_material, "*304")};
  rules.sources = {MaterialSource::step_material};
  try {
    (void)assign_materials(scene, rules);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'steel' and 'rubber'"));
    EXPECT_THAT(error.where(), HasSubstr("lib.xml:4 step_material=*304"));
  }
  rules.overrides = {{"/assembly/grip", "steel", {}, "m.xml:7"}};
  EXPECT_THAT(test::material_names(assign_materials(scene, rules)), ElementsAre("steel"));
}

TEST(UnusedRules, AnOverrideOfNoSolidIsNamedAndTakesFromRules) {
  const Scene scene = test::bare_scene({{"a"}});
  MaterialRules rules = steel_and_rubber();
  rules.overrides = {{"/assembly/a", "rubber", {}, "m.xml:7"}, {"/assembly/b", "rubber", {}, "m.xml:8"}};
  rules.rules = {rule("a", "steel")};
  const auto findings = find_unused_rules(scene, rules);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_THAT(findings[0].what, HasSubstr("m.xml:8 path=/assembly/b"));
  EXPECT_THAT(findings[1].hint, HasSubstr("earlier"));
}

}  // namespace
}  // namespace lamella
