#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/material_rules.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::ElementsAre;
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
  return std::string(kLibrary) + "\n<assignments>\n" + rules + "\n</assignments>";
}

TEST(ReadRules, EveryAttributeArrives) {
  const MaterialRules rules = read_material_rules(test::source_dir() / "schemas/valid/materials/every_attribute.xml");
  ASSERT_EQ(rules.library.size(), 3U);
  EXPECT_EQ(rules.library[1].name, "Stainless 316L");
  EXPECT_EQ(rules.library[1].density, 7.99);
  EXPECT_EQ(rules.library[0].color, (Color{230 / 255.0, 50 / 255.0, 90 / 255.0}));
  EXPECT_EQ(rules.priorities, (std::vector<int>{0, 10, -5}));
  EXPECT_EQ(rules.library[0].layers.deviation, 0.02);
  EXPECT_EQ(rules.library[0].layers.least, 0.05);
  EXPECT_EQ(rules.library[0].layers.most, 0.2);
  EXPECT_FALSE(rules.library[1].layers.deviation || rules.library[1].layers.least || rules.library[1].layers.most);
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
  EXPECT_THAT(error.hint(), EndsWith("m.xml:3"));
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

TEST(ReadRules, AnUnknownDefaultNamesTheKnownOnes) {
  const InputError error = refusal(std::string(kLibrary) + "<assignments default=\"C\"/>");
  EXPECT_THAT(error.hint(), HasSubstr("A, B"));
}

TEST(ReadRules, SourcesMatchesAndOverridesArrive) {
  const MaterialRules rules =
      read_material_rules(test::source_dir() / "schemas/valid/materials/sources_and_overrides.xml");
  ASSERT_EQ(rules.library.size(), 2U);
  EXPECT_EQ(rules.library[0].name, "PLA");
  EXPECT_THAT(rules.sources, ElementsAre(MaterialSource::step_material, MaterialSource::layer, MaterialSource::color,
                                         MaterialSource::name, MaterialSource::path));
  ASSERT_EQ(rules.overrides.size(), 1U);
  EXPECT_EQ(rules.overrides[0].path, "/grip/bolt.3");
  EXPECT_EQ(rules.overrides[0].priority, 7);
  // PLA's name by three sources; of the steel also its colour, and five matches.
  EXPECT_EQ(rules.matches.size(), 3U + 4U + 5U);
  EXPECT_EQ(rules.matches.back().pattern, "*/fasteners/*");
}

TEST(ReadRules, ASourceMayBeNamedOnce) {
  const InputError error = refusal(std::string(kLibrary) + "<assignments sources=\"name color name\"/>");
  EXPECT_THAT(error.what(), HasSubstr("'name' twice"));
}

TEST(ReadRules, AMatchNeedsExactlyOneSource) {
  EXPECT_THAT(refusal("<library><material name=\"A\"><match/></material></library>").what(), HasSubstr("needs one"));
  EXPECT_THAT(refusal("<library><material name=\"A\"><match name=\"a\" path=\"b\"/></material></library>").what(),
              HasSubstr("needs one"));
}

TEST(ReadRules, ASolidHasOneLine) {
  const InputError error =
      refusal(with_rules("<solid path=\"/a\" material=\"A\"/>\n<solid path=\"/a\" material=\"B\"/>"));
  EXPECT_THAT(error.where(), EndsWith("m.xml:5"));
  EXPECT_THAT(error.hint(), EndsWith("m.xml:4"));
}

/// Files of a folder, each the body of a materials file.
class IncludedLibraries : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& body) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.1\">\n"
                                  << body << "\n</materials>\n";
  }
  InputError refusal_of(const std::string& name) {
    try {
      (void)read_material_rules(folder_ / name);
    } catch (const InputError& error) {
      return error;
    }
    ADD_FAILURE() << "accepted: " << name;
    return InputError("accepted");
  }
  static std::vector<std::string> names(const MaterialRules& rules) {
    std::vector<std::string> out;
    for (const Material& material : rules.library) out.push_back(material.name);
    return out;
  }

  test::TemporaryFolder folder_;
};

TEST_F(IncludedLibraries, StandWhereTheyAreIncludedAndAreReadOnce) {
  write("shop/base.xml", "<library><material name=\"base\"/></library>");
  write("shop/metal.xml", "<library><include href=\"base.xml\"/><material name=\"steel\" priority=\"4\"/></library>");
  write("job/m.xml",
        "<library><material name=\"own\"/><include href=\"../shop/metal.xml\"/><include href=\"../shop/base.xml\"/>"
        "<material name=\"last\"/></library><assignments default=\"steel\"/>");
  const MaterialRules rules = read_material_rules(folder_ / "job/m.xml");
  EXPECT_THAT(names(rules), ElementsAre("own", "base", "steel", "last"));
  EXPECT_EQ(rules.priorities, (std::vector<int>{0, 0, 4, 0}));
  EXPECT_EQ(rules.fallback, "steel");
}

TEST_F(IncludedLibraries, ACircleIsRefused) {
  write("a.xml", "<library><include href=\"b.xml\"/><material name=\"A\"/></library>");
  write("b.xml", "<library><include href=\"./a.xml\"/><material name=\"B\"/></library>");
  EXPECT_THAT(refusal_of("a.xml").what(), HasSubstr("includes itself"));
  EXPECT_THAT(refusal_of("a.xml").where(), EndsWith("b.xml:2"));
}

TEST_F(IncludedLibraries, AChainThatDoesNotEndIsRefused) {
  for (int i = 0; i < 30; ++i) {
    write(std::to_string(i) + ".xml", "<library><include href=\"" + std::to_string(i + 1) + ".xml\"/></library>");
  }
  write("30.xml", "<library><material name=\"A\"/></library>");
  EXPECT_THAT(refusal_of("0.xml").what(), HasSubstr("too many"));
  EXPECT_THAT(names(read_material_rules(folder_ / "20.xml")), ElementsAre("A"));
}

TEST_F(IncludedLibraries, AnIncludedFileHasNoAssignmentsAndNoNameTwice) {
  write("rules.xml", "<library><material name=\"A\"/></library><assignments default=\"A\"/>");
  write("m.xml", "<library><include href=\"rules.xml\"/></library>");
  EXPECT_THAT(refusal_of("m.xml").where(), HasSubstr("rules.xml"));
  write("a.xml", "<library><material name=\"A\"/></library>");
  write("twice.xml", "<library><include href=\"a.xml\"/><material name=\"A\"/></library>");
  EXPECT_THAT(refusal_of("twice.xml").what(), HasSubstr("defined twice"));
  EXPECT_THAT(refusal_of("twice.xml").hint(), HasSubstr("a.xml:2"));
}

TEST_F(IncludedLibraries, WhatIsNoFileIsRefused) {
  for (const char* href : {"missing.xml", "/dev/zero", ".", "../../../../../../../../etc/passwd"}) {
    write("m.xml", std::string("<library><include href=\"") + href + "\"/></library>");
    (void)refusal_of("m.xml");
  }
}

}  // namespace
}  // namespace lamella
