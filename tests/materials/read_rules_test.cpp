#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/material_rules.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

MaterialRules read(const std::string& body) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "m.xml") << "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.0\">\n"
                                  << body << "\n</materials>\n";
  return read_material_rules(folder / "m.xml");
}

InputError refusal(const std::string& body) {
  try {
    (void)read(body);
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << body;
  return InputError("accepted");
}

constexpr const char* kLibrary = "<library><material name=\"A\"/><material name=\"B\"/></library>";

std::string with_rules(const std::string& rules) {
  std::string text = kLibrary;
  text += "\n<assignments>\n";
  text += rules;
  text += "\n</assignments>";
  return text;
}

TEST(ReadRules, EveryAttributeArrives) {
  const MaterialRules rules = read_material_rules(test::source_dir() / "schemas/valid/materials/every_attribute.xml");
  ASSERT_EQ(rules.library.size(), 3U);
  EXPECT_EQ(rules.library[1].name, "Stainless 316L");
  EXPECT_EQ(rules.library[1].density, 7.99);
  EXPECT_EQ(rules.library[0].color, (Color{230 / 255.0, 50 / 255.0, 90 / 255.0}));
  EXPECT_EQ(rules.priorities, (std::vector<int>{0, 10, -5}));
  EXPECT_EQ(rules.fallback, "TPU 85A");
  ASSERT_EQ(rules.rules.size(), 4U);
  EXPECT_EQ(rules.rules[0].name, "Insert*");
  EXPECT_EQ(rules.rules[1].path, "/grip/*/bolt.[0-9]");
  EXPECT_EQ(rules.rules[1].layer, "metal");
  EXPECT_EQ(rules.rules[1].priority, 20);
  EXPECT_THAT(rules.rules[1].where, EndsWith("every_attribute.xml:11"));
  EXPECT_EQ(rules.rules[3].material, "Gr\xC3\xBCn & weich");
}

TEST(ReadRules, AnUnknownMaterialNamesTheKnownOnes) {
  const InputError error = refusal(with_rules("<assign name=\"x\" material=\"C\"/>"));
  EXPECT_THAT(error.what(), HasSubstr("'C'"));
  EXPECT_THAT(error.where(), EndsWith("m.xml:4"));
  EXPECT_THAT(error.hint(), HasSubstr("A, B"));
}

TEST(ReadRules, ADuplicateMaterialNamesBothLines) {
  const InputError error = refusal("<library>\n<material name=\"A\"/>\n<material name=\"A\"/>\n</library>");
  EXPECT_THAT(error.where(), EndsWith("m.xml:4"));
  EXPECT_THAT(error.hint(), HasSubstr("line 3"));
}

TEST(ReadRules, TwoRulesThatSelectTheSameConflict) {
  const InputError error = refusal(with_rules(
      "<assign name=\"x\" material=\"A\"/>\n<assign path=\"x\" material=\"A\"/>\n<assign name=\"x\" material=\"B\"/>"));
  EXPECT_THAT(error.what(), HasSubstr("conflicting"));
  EXPECT_THAT(error.where(), EndsWith("m.xml:6"));
  EXPECT_THAT(error.hint(), HasSubstr("m.xml:4"));
}

TEST(ReadRules, ARuleMustSelectSomething) {
  EXPECT_THAT(refusal(with_rules("<assign material=\"A\"/>")).what(), HasSubstr("selects nothing"));
}

TEST(ReadRules, ABrokenPatternIsRefusedAtItsLine) {
  const InputError error = refusal(with_rules("<assign name=\"x[0-9\" material=\"A\"/>"));
  EXPECT_THAT(error.what(), HasSubstr("x[0-9"));
  EXPECT_THAT(error.where(), EndsWith("m.xml:4"));
}

TEST(ReadRules, ADensityInKilogramsPerCubicMetreIsCaught) {
  EXPECT_THAT(refusal("<library><material name=\"A\" density=\"7850\"/></library>").hint(), HasSubstr("g/cm^3"));
}

TEST(ReadRules, MaterialsWithoutColorGetDifferentOnes) {
  const MaterialRules rules = read(kLibrary);
  EXPECT_NE(rules.library[0].color, rules.library[1].color);
}

}  // namespace
}  // namespace lamella
