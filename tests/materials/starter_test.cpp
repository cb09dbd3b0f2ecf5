#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/material_rules.h"
#include "tests/materials/solids.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

const Color kRed{1, 0, 0};
const Color kHalf{0.5, 0.5, 0.5};

/// Writes the starter file, checks it against the schema, and applies it to the same scene.
MaterialTable round_trip(const Scene& scene, const MaterialTable& table) {
  const test::TemporaryFolder folder;
  const auto file = folder / "m.xml";
  std::ofstream(file) << starter_rules(scene, table);
  const std::string schema = (test::source_dir() / "schemas/materials.xsd").string();
  EXPECT_EQ(std::system(
                ("xmllint --nonet --noout --schema '" + schema + "' '" + file.string() + "' >/dev/null 2>&1").c_str()),
            0);
  return assign_materials(scene, read_material_rules(file));
}

void expect_reproduced(const Scene& scene, const MaterialTable& table) {
  const MaterialTable again = round_trip(scene, table);
  EXPECT_EQ(test::material_names(again), test::material_names(table));
  ASSERT_EQ(again.materials.size(), table.materials.size());
  for (const MaterialId id : table.materials.ids()) {
    EXPECT_EQ(again.materials[id].name, table.materials[id].name);
    EXPECT_EQ(again.materials[id].density, table.materials[id].density);
  }
  for (const SolidId solid : scene.solids.ids()) {
    EXPECT_EQ(again.assignments[solid].priority, table.assignments[solid].priority);
  }
}

TEST(StarterRules, ReproduceTheAutomaticAssignment) {
  const Scene scene = test::bare_scene({{"a", "Steel", kRed, "", 7.85},
                                        {"b", "", kRed},
                                        {"c"},
                                        {"c"},
                                        {"d", "", kHalf},
                                        {"e", "", Color{127 / 255.0, 0.5, 0.5}}});
  expect_reproduced(scene, assign_materials(scene));
}

TEST(StarterRules, SurviveHostileNames) {
  const Scene scene = test::bare_scene({{"<a href=\"x\">&amp;"},
                                        {"[1]*?\\"},
                                        {"'quoted'\nlines\ttabs"},
                                        {""},
                                        {"Gr\xC3\xBCn"},
                                        {"\x1B[2J"},
                                        {"x", "]]>"},
                                        {"y", "-->"},
                                        {"z", "  blanks  "}});
  expect_reproduced(scene, assign_materials(scene));
}

TEST(StarterRules, ReproduceWhatNoSingleSelectorTellsApart) {
  const Scene scene =
      test::bare_scene({{"a", "Steel", kRed}, {"a", "Steel", kRed}, {"b", "Steel", kRed}, {"c", "", kRed}});
  MaterialTable table;
  for (const char* name : {"x", "y", "z"}) table.materials.push_back({name, std::nullopt, kRed});
  for (const int material : {0, 1, 2, 2})
    table.assignments.push_back({MaterialId{static_cast<std::size_t>(material)}, 0, ""});
  table.assignments[SolidId{1}].priority = -7;
  expect_reproduced(scene, table);
}

TEST(StarterRules, ReproduceOneNameWithTwoDensities) {
  const Scene scene = test::bare_scene({{"a", "Steel", {}, "", 7.85}, {"b", "Steel", {}, "", 7.9}});
  expect_reproduced(scene, assign_materials(scene));
}

}  // namespace
}  // namespace lamella
