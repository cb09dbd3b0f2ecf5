#include <cmath>
#include <gmock/gmock.h>
#include <set>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

std::string adaptive_run(const TemporaryFolder& folder, const std::string& more) {
  return "slice " + spheres() + " --pitch 0.5 --json -o " + quoted(folder / "build") + " " + more;
}

TEST(Adaptive, ReportsLayersWithinTheDeviation) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella(adaptive_run(folder, "--adaptive 0.1 --adaptive-chart " + quoted(folder / "chart.svg")));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  expect_keys(report, {"adaptive", "grid", "layers"});
  const Json& adaptive = report["adaptive"];
  expect_keys(adaptive, {"deviation", "quantum", "range", "layers", "largest_deviation", "mean_deviation",
                         "greedy_layers", "greedy_missed", "uniform_layers", "uniform_thickness", "materials",
                         "sharp_edges", "thin_faces", "missed", "features", "thicknesses"});
  EXPECT_EQ(adaptive["layers"], report["layers"]);
  EXPECT_EQ(report["grid"]["size"][2], report["layers"]);
  EXPECT_LE(adaptive["largest_deviation"], 0.1 + 1e-9);
  int layers = 0;
  for (const Json& run : adaptive["thicknesses"]) {
    layers += run["layers"].get<int>();
    const double quanta = run["thickness"].get<double>() / adaptive["quantum"].get<double>();
    EXPECT_NEAR(quanta, std::round(quanta), 1e-6);
  }
  EXPECT_EQ(layers, report["layers"].get<int>());
  EXPECT_THAT(contents(folder / "chart.svg"), HasSubstr("thickness of layers in mm"));
  EXPECT_EQ(run_lamella("check " + quoted(folder / "build")).exit_code, 0);
}

// The stack's power plane is a sheet of 0.036 mm between heights that layers of 0.05 mm and more can't both meet.
TEST(Adaptive, NamesFacesThatLayersMayLose) {
  const TemporaryFolder folder;
  const std::string run = "slice " + quoted(datasets_dir() / "pcb_stack" / "pcb_stack.step") + " --pitch 0.5 -o " +
                          quoted(folder / "build") +
                          " --adaptive 0.05 --adaptive-range 0.05,0.4 --adaptive-step 0.01 --dry-run";
  const CommandResult result = run_lamella(run + " --json");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  std::set<std::string> paths;
  for (const Json& face : report["adaptive"]["thin_faces"]) {
    expect_keys(face, {"solid", "path", "face", "at", "deviation"});
    EXPECT_TRUE(face["deviation"].is_null());
    EXPECT_EQ(face["at"].size(), 3U);
    paths.insert(face["path"].get<std::string>());
  }
  EXPECT_EQ(paths.count("/PCB stack/Power plane"), 1U);
  EXPECT_THAT(run_lamella(run).output, HasSubstr("thin, flat places that these layers may lose: 4"));
}

TEST(Adaptive, ThicknessesSuitFormatsOfOneThickness) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_lamella(adaptive_run(folder, "--adaptive 0.2 --vdb " + quoted(folder / "v.vdb") + " --nrrd " +
                                           quoted(folder / "v.nrrd") + " --png " + quoted(folder / "png")));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_GT(std::filesystem::file_size(folder / "v.nrrd"), 100U);
  EXPECT_GT(std::filesystem::file_size(folder / "v.vdb"), 100U);
}

TEST(Adaptive, DryRunShowsThePlanAndWritesNothing) {
  const TemporaryFolder folder;
  const CommandResult result = run_lamella(adaptive_run(
      folder, "--adaptive 0.1 --adaptive-range 0.05,0.5 --dry-run --adaptive-chart " + quoted(folder / "chart.svg")));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json plan = parse_output(result);
  EXPECT_EQ(plan["adaptive"]["range"], Json::array({0.05, 0.5}));
  EXPECT_EQ(plan["adaptive"]["layers"], plan["layers"]);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Adaptive, SaysWhatIsWrongWithItsNumbers) {
  const TemporaryFolder folder;
  const struct {
    const char* options;
    int code;
    const char* says;
  } cases[] = {
      {"--adaptive 0", 1, "not more than zero"},
      {"--adaptive -0.1", 1, "not more than zero"},
      {"--adaptive nan", 1, "--adaptive"},
      {"--adaptive x", 1, "--adaptive"},
      {"--adaptive 0.1 --adaptive-range 0.5,0.1", 1, "more than the largest"},
      {"--adaptive 0.1 --adaptive-range 0.5", 1, "--adaptive-range"},
      {"--adaptive 0.1 --adaptive-range 0,1", 1, "must be positive"},
      {"--adaptive 0.1 --adaptive-step 0", 1, "--adaptive-step"},
      {"--adaptive 0.1 --layer-height 0.1", 1, "exclude each other"},
      {"--adaptive-range 0.1,0.2", 1, "needs --adaptive"},
      {"--adaptive 0.01 --adaptive-range 0.1,0.2", 2, "no layer suits the material"},
  };
  for (const auto& wrong : cases) {
    const CommandResult result = run_lamella(adaptive_run(folder, wrong.options));
    EXPECT_EQ(result.exit_code, wrong.code) << wrong.options;
    EXPECT_THAT(result.errors, HasSubstr(wrong.says)) << wrong.options;
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << wrong.options;
  }
}

/// A library in which the boxes' materials accept no common layer.
std::string clashing_library() {
  return "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.3\"><library>"
         "<material name=\"Thick\" layer_min=\"0.4\"/><material name=\"Thin\" layer_max=\"0.2\" deviation=\"0.05\"/>"
         "</library><assignments default=\"Thick\"><assign name=\"Cork*\" "
         "material=\"Thin\"/></assignments></materials>";
}

TEST(Adaptive, NamesMaterialsThatClash) {
  const TemporaryFolder folder;
  write_text(folder / "m.xml", clashing_library());
  const Json info = parse_output(run_lamella("info " + boxes() + " --json --materials " + quoted(folder / "m.xml")));
  std::set<std::string> used;
  for (const Json& solid : info["solids"]) used.insert(solid["material"]);
  ASSERT_EQ(used.size(), 2U) << info["solids"].dump();
  const CommandResult result =
      run_lamella("slice " + boxes() + " --pitch 1 --adaptive 0.3 --adaptive-range 0.1,1 --materials " +
                  quoted(folder / "m.xml") + " -o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("no layer suits the materials 'Thick' and 'Thin'"));
  EXPECT_THAT(result.errors, HasSubstr("z = "));
}

TEST(Adaptive, TakesThicknessesFromTheMachineAndOptionsFromAJob) {
  const TemporaryFolder folder;
  const std::string machine = (datasets_dir() / "machines/multi_nozzle.xml").string();
  write_text(folder / "job.xml", "<job xmlns=\"urn:lamella:job:1\" version=\"1.0\"><part file=\"" +
                                     (datasets_dir() / "nested_spheres/nested_spheres.step").string() +
                                     "\"/><options output=\"build\" adaptive=\"0.15\" machine=\"" + machine +
                                     "\" dry-run=\"true\" json=\"true\"/></job>");
  EXPECT_EQ(run_lamella("check " + quoted(folder / "job.xml")).exit_code, 0);
  const CommandResult result = run_lamella("slice --job " + quoted(folder / "job.xml"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const Json plan = parse_output(result);
  EXPECT_NEAR(plan["adaptive"]["range"][0].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(plan["adaptive"]["range"][1].get<double>(), 0.3, 1e-9);
}

TEST(Adaptive, AJobHasAllOfItsOptions) {
  const TemporaryFolder folder;
  write_text(folder / "job.xml", "<job xmlns=\"urn:lamella:job:1\" version=\"1.0\"><part file=\"" +
                                     (datasets_dir() / "nested_spheres/nested_spheres.step").string() +
                                     "\"/><options output=\"build\" pitch=\"0.5\" adaptive=\"0.15\" "
                                     "adaptive-range=\"0.08,0.4\" adaptive-step=\"0.04\" "
                                     "adaptive-chart=\"chart.svg\" json=\"true\"/></job>");
  EXPECT_EQ(run_lamella("check " + quoted(folder / "job.xml")).exit_code, 0);
  const CommandResult result = run_lamella("slice --job " + quoted(folder / "job.xml"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json adaptive = parse_output(result)["adaptive"];
  EXPECT_EQ(adaptive["deviation"], 0.15);
  EXPECT_NEAR(adaptive["quantum"].get<double>(), 0.04, 1e-12);
  EXPECT_NEAR(adaptive["range"][0].get<double>(), 0.08, 1e-12);
  EXPECT_NEAR(adaptive["range"][1].get<double>(), 0.4, 1e-12);
  // Places are those beside the job.
  EXPECT_THAT(contents(folder / "chart.svg"), HasSubstr("thickness of layers in mm"));
  EXPECT_EQ(run_lamella("check " + quoted(folder / "build")).exit_code, 0);
  // The command line counts before the job.
  const CommandResult other = run_lamella("slice --job " + quoted(folder / "job.xml") + " --adaptive-step 0.02");
  ASSERT_EQ(other.exit_code, 0) << other.errors;
  EXPECT_NEAR(parse_output(other)["adaptive"]["quantum"].get<double>(), 0.02, 1e-12);
}

TEST(Adaptive, LayersOfAMachinesToolsClashByName) {
  const TemporaryFolder folder;
  std::string machine = contents(datasets_dir() / "machines/multi_nozzle.xml");
  const auto replace = [&](const std::string& was, const std::string& by) {
    const std::size_t at = machine.find(was);
    ASSERT_NE(at, std::string::npos) << was;
    machine.replace(at, was.size(), by);
  };
  replace("<holds material=\"Steel*\"/>", "<holds material=\"Thick\"/>");
  replace("layer_min=\"0.1\">", "layer_min=\"0.25\">");
  replace("<holds material=\"TP[EU]*\"/>", "<holds material=\"Thin\"/>");
  replace("layer_max=\"0.25\">", "layer_max=\"0.2\">");
  for (const char* head : {"1", "2", "3", "4"}) {
    const std::string tool = std::string("name=\"head ") + head + "\" speed=\"80\" travel=\"250\" purge=\"15\"";
    replace("<tool " + tool + "/>", "<tool " + tool + "><holds material=\"PVA\"/></tool>");
  }
  write_text(folder / "machine.xml", machine);
  EXPECT_EQ(run_lamella("check " + quoted(folder / "machine.xml")).exit_code, 0);
  write_text(folder / "m.xml",
             "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.3\"><library>"
             "<material name=\"Thick\"/><material name=\"Thin\"/></library><assignments default=\"Thick\">"
             "<assign name=\"Cork*\" material=\"Thin\"/></assignments></materials>");
  const CommandResult result =
      run_lamella("slice " + boxes() + " --pitch 1 --adaptive 0.3 --materials " + quoted(folder / "m.xml") +
                  " --machine " + quoted(folder / "machine.xml") + " -o " + quoted(folder / "build"));
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("no layer suits the materials 'Thick' and 'Thin' from z = "));
  EXPECT_THAT(result.errors, HasSubstr("'Thick' takes 0.25 to 0.3 mm (tool 'hot head')"));
  EXPECT_THAT(result.errors, HasSubstr("'Thin' takes 0.1 to 0.2 mm (tool 'soft head')"));
  EXPECT_FALSE(std::filesystem::exists(folder / "build"));
}

TEST(Adaptive, SharesTheAccuracyWithThePitch) {
  const TemporaryFolder folder;
  const std::string run = "slice " + spheres() + " --json --dry-run -o " + quoted(folder / "build");
  const CommandResult result = run_lamella(run + " --accuracy 0.3 --adaptive auto");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json plan = parse_output(result);
  EXPECT_DOUBLE_EQ(plan["adaptive"]["deviation"].get<double>(), 0.15);
  EXPECT_DOUBLE_EQ(plan["grid"]["pitch"][0].get<double>(), 0.21);
  const double diagonal = 0.5 * std::hypot(0.21, 0.21);
  EXPECT_NEAR(plan["accuracy"]["surface_bound"].get<double>(),
              diagonal + plan["adaptive"]["largest_deviation"].get<double>(), 1e-12);
  EXPECT_LE(plan["accuracy"]["surface_bound"], 0.3);
  const Json own = parse_output(run_lamella(run + " --accuracy 0.3 --adaptive 0.1"));
  EXPECT_DOUBLE_EQ(own["grid"]["pitch"][1].get<double>(), 0.28);
  const CommandResult nozzles = run_lamella(run + " --accuracy 0.3 --adaptive auto --machine " +
                                            quoted(datasets_dir() / "machines/multi_nozzle.xml"));
  EXPECT_DOUBLE_EQ(parse_output(nozzles)["grid"]["pitch"][1].get<double>(), 0.2);
  EXPECT_DOUBLE_EQ(parse_output(nozzles)["adaptive"]["deviation"].get<double>(), 0.18);
}

TEST(Adaptive, WarnsWhereALibraryAllowsMoreThanTheAccuracy) {
  const TemporaryFolder folder;
  write_text(folder / "m.xml",
             "<materials xmlns=\"urn:lamella:materials:1\" version=\"1.3\"><library>"
             "<material name=\"Loose\" deviation=\"0.4\"/></library><assignments default=\"Loose\"/></materials>");
  const CommandResult result = run_lamella(
      "slice " + spheres() + " --accuracy 0.3 --adaptive auto --adaptive-range 0.1,2 --dry-run --materials " +
      quoted(folder / "m.xml") + " -o " + quoted(folder / "build"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("not within the 0.3 mm asked for"));
}

}  // namespace
}  // namespace lamella::test
