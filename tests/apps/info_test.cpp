#include <fstream>
#include <gmock/gmock.h>
#include <map>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST(Info, JsonHasTheDocumentedKeys) {
  const CommandResult result = run_lamella("info " + boxes() + " --json");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json info = parse_output(result);
  expect_keys(info, {"files", "solids", "warnings"});
  expect_keys(info["files"][0], {"path", "schema", "unit"});
  ASSERT_FALSE(info["solids"].empty());
  int id = 0;
  for (const Json& solid : info["solids"]) {
    expect_keys(solid, {"id", "file", "name", "path", "color", "layer", "step_material", "material", "rule", "volume",
                        "area", "bounds", "faces", "edges", "surface_types", "closed", "healed", "max_tolerance"});
    EXPECT_EQ(solid["id"], id++);
    EXPECT_EQ(solid["faces"], 6);
    EXPECT_EQ(solid["edges"], 12);
    EXPECT_EQ(solid["surface_types"]["plane"], 6);
    EXPECT_EQ(solid["closed"], true);
    EXPECT_EQ(solid["rule"], "STEP material");
    EXPECT_EQ(solid["material"], solid["step_material"]);
    EXPECT_EQ(solid["bounds"].size(), 2U);
  }
}

TEST(Info, VolumesAreThoseOfTheManifest) {
  const Json manifest = Json::parse(contents(datasets_dir() / "manifest.json"));
  const Json info =
      parse_output(run_lamella("info " + quoted(datasets_dir() / "nested_spheres/nested_spheres.step") + " --json"));
  for (const Json& dataset : manifest["datasets"]) {
    if (dataset["name"] != "nested_spheres") continue;
    ASSERT_EQ(dataset["solids"].size(), info["solids"].size());
    for (std::size_t i = 0; i < info["solids"].size(); ++i) {
      const double exact = dataset["solids"][i]["volume"];
      EXPECT_NEAR(info["solids"][i]["volume"].get<double>(), exact, 1e-6 * exact);
    }
    return;
  }
  FAIL() << "nested_spheres isn't in the manifest";
}

TEST(Info, TheTableNamesItsUnits) {
  const CommandResult result = run_lamella("info " + boxes());
  for (const char* label : {"volume [mm^3]", "area [mm^2]", "size [mm]", "density [g/cm^3]", "length unit"}) {
    EXPECT_THAT(result.output, HasSubstr(label));
  }
}

TEST(Info, SeveralFilesAreOneAssembly) {
  const Json one = parse_output(run_lamella("info " + boxes() + " --json"));
  const Json two = parse_output(run_lamella("info " + boxes() + " " + boxes() + " --json"));
  EXPECT_EQ(two["solids"].size(), 2 * one["solids"].size());
  EXPECT_EQ(two["solids"].back()["file"], 1);
}

TEST(Info, TheStarterFileReproducesTheMaterials) {
  const TemporaryFolder folder;
  const auto starter = folder / "m.xml";
  ASSERT_EQ(run_lamella("info " + boxes() + " --write-materials " + quoted(starter)).exit_code, 0);
  const std::string schema = quoted(source_dir() / "schemas/materials.xsd");
  EXPECT_EQ(run_command("xmllint --nonet --noout --schema " + schema + " " + quoted(starter)).exit_code, 0);
  const Json without = parse_output(run_lamella("info " + boxes() + " --json"));
  const Json with = parse_output(run_lamella("info " + boxes() + " --json --materials " + quoted(starter)));
  for (std::size_t i = 0; i < without["solids"].size(); ++i) {
    EXPECT_EQ(with["solids"][i]["material"], without["solids"][i]["material"]);
    EXPECT_THAT(with["solids"][i]["rule"].get<std::string>(), HasSubstr("m.xml:"));
  }
}

/// All files of a build's folder but its log, by name.
std::map<std::string, std::string> files_of_build(const std::filesystem::path& build) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(build)) {
    const std::string name = std::filesystem::relative(entry.path(), build).string();
    if (entry.is_regular_file() && name != "run.json") files[name] = contents(entry.path());
  }
  return files;
}

TEST(Info, GradedMaterialsAreWrittenSoThatTheBuildIsTheSame) {
  const TemporaryFolder folder;
  const std::string lens = quoted(datasets_dir() / "gradient_lens/gradient_lens.step");
  const std::string graded = quoted(datasets_dir() / "gradient_lens/graded.xml");
  const std::string written = quoted(folder / "written.xml");
  ASSERT_EQ(run_lamella("info " + lens + " --materials " + graded + " --write-materials " + written).exit_code, 0);
  EXPECT_EQ(run_lamella("check " + written).exit_code, 0);
  for (const auto& [name, materials] : {std::pair{"a", graded}, std::pair{"b", written}}) {
    const CommandResult result = run_lamella("slice " + lens + " --materials " + materials +
                                             " --pitch 0.5 --layer-height 0.5 -o " + quoted(folder / name));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  const auto before = files_of_build(folder / "a");
  const auto after = files_of_build(folder / "b");
  ASSERT_EQ(after.size(), before.size());
  for (const auto& [name, text] : before) EXPECT_TRUE(after.at(name) == text) << name;
}

TEST(Info, SolidsThatNoRuleCoversAreListed) {
  const TemporaryFolder folder;
  write_text(folder / "m.xml",
             "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.0\"><library><material name=\"A\"/></library>"
             "<assignments><assign name=\"nobody\" material=\"A\"/></assignments></materials>");
  const CommandResult result = run_lamella("info " + boxes() + " --json --materials " + quoted(folder / "m.xml"));
  EXPECT_EQ(result.exit_code, 2);
  const Json info = parse_output(run_lamella("info " + boxes() + " --json"));
  const std::string what = parse_output(result)["error"]["what"];
  for (const Json& solid : info["solids"]) EXPECT_THAT(what, HasSubstr(solid["path"].get<std::string>()));
  EXPECT_THAT(result.errors, HasSubstr("decides about no solid"));
}

TEST(Info, PreviewsWhichLineDecidesAboutEachSolid) {
  const TemporaryFolder folder;
  std::ofstream(folder / "shop.xml") << "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.1\"><library>\n"
                                        "<material name=\"steel\"><match name=\"*\"/></material>\n"
                                        "</library></materials>";
  std::ofstream(folder / "m.xml") << "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.1\">\n"
                                     "<library><include href=\"shop.xml\"/></library>\n"
                                     "<assignments sources=\"step_material name\"/></materials>";
  const CommandResult result = run_lamella("info " + boxes() + " --json --materials " + quoted(folder / "m.xml"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const Json& solid : Json::parse(result.output)["solids"]) {
    EXPECT_EQ(solid["material"], "steel");
    EXPECT_THAT(solid["rule"].get<std::string>(), HasSubstr("shop.xml:2 name=*"));
  }
}

TEST(Info, AnErrorInTheMaterialsFileNamesItsLine) {
  const CommandResult result =
      run_lamella("info " + boxes() + " --materials " +
                  quoted(source_dir() / "schemas/invalid/materials/solid_without_material.xml"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("solid_without_material.xml:4"));
}

TEST(Info, AnUnwritableStarterFileIsExitCodeFour) {
  const CommandResult result = run_lamella("info " + boxes() + " --write-materials /proc/nowhere/m.xml");
  EXPECT_EQ(result.exit_code, 4) << result.errors;
}

TEST(Info, QuietMeansNoProgress) { EXPECT_THAT(run_lamella("info " + boxes() + " --quiet").errors, IsEmpty()); }

TEST(Info, AnOpenSolidAmongOthersIsNamedAndEndsInExitCodeThree) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella("info --json " + write_open_boxes(folder / "open.step", false));
  EXPECT_EQ(result.exit_code, 3) << result.errors;
  const Json info = parse_output(result);
  const std::vector<Json> open = solids_with_status(info, "open");
  ASSERT_EQ(open.size(), 2U);  // two instances of the part
  EXPECT_EQ(open[0]["closed"], false);
  EXPECT_EQ(solids_with_status(info, "ok").size(), 10U);
  EXPECT_THAT(info["warnings"], Not(IsEmpty()));
  EXPECT_THAT(result.errors, HasSubstr(open[0]["path"].get<std::string>()));
}

TEST(Info, OnlyOpenSolidsEndInExitCodeTwo) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella("info --json " + write_open_boxes(folder / "open.step", true));
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("#"));
  const Json info = parse_output(result);
  expect_keys(info, {"files", "solids", "warnings", "error"});
  EXPECT_EQ(info["error"]["code"], 2);
}

}  // namespace
}  // namespace lamella::test
