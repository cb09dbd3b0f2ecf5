#include <gmock/gmock.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::StartsWith;

TEST(Help, EveryVerbHasExamples) {
  for (const std::string verb : {"info", "slice", "orient", "ray", "export", "plan", "view", "accuracy", "check"}) {
    const CommandResult help = run_lamella(verb + " --help");
    EXPECT_EQ(help.exit_code, 0) << verb;
    EXPECT_THAT(help.output, HasSubstr("Examples:\n  lamella " + verb + " ")) << verb;
    EXPECT_THAT(help.errors, IsEmpty()) << verb;
  }
  EXPECT_THAT(run_lamella("--help").output, HasSubstr("lamella slice grip.step"));
}

TEST(Help, VersionIsPrinted) {
  const CommandResult version = run_lamella("--version");
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_THAT(version.output, MatchesRegex("lamella [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

/// A command line that can't be meant, and what its error line must mention.
struct Misuse {
  const char* arguments;
  const char* mentions;
};

class Misused : public ::testing::TestWithParam<Misuse> {};

TEST_P(Misused, EndsWithExitCodeOneAndAHint) {
  const CommandResult result = run_lamella(GetParam().arguments);
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_THAT(result.errors, ContainsRegex("^lamella: error: [^\n]*; [^\n]+\n$"));
  EXPECT_THAT(result.errors, HasSubstr(GetParam().mentions));
  EXPECT_THAT(result.output, IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(
    Usage, Misused,
    ::testing::Values(
        Misuse{"", "subcommand"}, Misuse{"slide x.step", "slide"}, Misuse{"info", "files"},
        Misuse{"info x.step --frobnicate", "--frobnicate"}, Misuse{"slice x.step", "--output"},
        Misuse{"slice -o out", "files"}, Misuse{"slice x.step -o out --pitch nan", "--pitch"},
        Misuse{"slice x.step -o out --pitch inf", "--pitch"}, Misuse{"slice x.step -o out --pitch -1", "--pitch"},
        Misuse{"slice x.step -o out --pitch 0", "--pitch"}, Misuse{"slice x.step -o out --pitch 1e999", "--pitch"},
        Misuse{"slice x.step -o out --pitch 0.1mm", "--pitch"}, Misuse{"slice x.step -o out --pitch 1,2,3", "--pitch"},
        Misuse{"slice x.step -o out --pitch 1,-2", "--pitch"}, Misuse{"slice x.step -o out --pitch ''", "--pitch"},
        Misuse{"slice x.step -o out --pitch 1 --dpi 300", "exclude"},
        Misuse{"slice x.step -o out --dpi 0,300", "--dpi"},
        Misuse{"slice x.step -o out --layer-height -0.1", "--layer-height"},
        Misuse{"slice x.step -o out --origin 1,2", "--origin"},
        Misuse{"slice x.step -o out --origin 1,2,nan", "--origin"},
        Misuse{"slice x.step -o out --hatch-angle 45", "--hatch-spacing"},
        Misuse{"slice x.step -o out --rotate-per-layer 90", "--hatch-spacing"},
        Misuse{"slice x.step -o out --threads -2", "--threads"},
        Misuse{"slice x.step -o out --threads 1e3", "--threads"},
        Misuse{"slice x.step -o out --threads 99999999999999999999", "--threads"},
        Misuse{"slice x.step -o out --engine warp", "reference"},
        Misuse{"slice x.step -o out --solver magic", "certified"},
        Misuse{"slice x.step -o out --solver bisection", "--engine reference"},
        Misuse{"slice x.step -o out --engine span --tolerance 0.1", "--engine reference"},
        Misuse{"ray x.step --from 0,0,0 --dir 1,0,0 --subdivision 0.1", "--engine reference"},
        Misuse{"slice x.step -o out --tolerance 0", "--tolerance"},
        Misuse{"slice x.step -o out --tolerance 1e9", "--tolerance"},
        Misuse{"slice x.step -o out --subdivision nan", "--subdivision"},
        Misuse{"slice x.step -o out --overlap mine", "average"}, Misuse{"slice x.step -o out --gif t", "--gif"},
        Misuse{"slice x.step -o out --xml a.xml --vdb ./a.xml", "same place"},
        Misuse{"slice x.step -o ./x.step", "overwrite an input"},
        Misuse{"slice x.step --tiff a.raw --mhd a.mhd --raw", "same place"},
        Misuse{"slice x.step --materials m.zraw --mhd m.mhd", "overwrite an input"},
        Misuse{"slice x.step --png-indexed p --raw", "--raw"}, Misuse{"slice x.step --png p --vdb-sdf", "--vdb-sdf"},
        Misuse{"slice x.step --png p --vdb-ids", "--vdb-ids"},
        Misuse{"slice x.step --png p --vdb-grids fog", "--vdb-grids"},
        Misuse{"slice x.step --png p --sl1-display portrait", "--sl1-display"},
        Misuse{"slice x.step --png p --grey-bits 16", "--grey-bits"},
        Misuse{"slice x.step --png p --xml-payload text", "--xml-payload"},
        Misuse{"slice x.step --png p --step-hatches", "--step-hatches"},
        Misuse{"slice x.step --png p --z-pitch 1", "--z-pitch"},
        Misuse{"slice x.step --xml s.xml --dither", "--dither"}, Misuse{"export b --to png -o p --raw", "--raw"},
        Misuse{"slice x.step -o out --materials m.xml --xml m.xml", "overwrite an input"},
        Misuse{"info x.step --write-materials x.step", "overwrite an input"},
        Misuse{"info x.step --materials m.xml --write-materials m.xml", "overwrite an input"},
        Misuse{"ray x.step", "--from"}, Misuse{"ray x.step --from 0,0,0", "--dir"},
        Misuse{"ray x.step --from 0,0,0 --dir 0,0,0", "--dir"},
        Misuse{"ray x.step --from 0,0,0 --dir 1,0,inf", "--dir"},
        Misuse{"ray x.step --from 0,0,0 --dir 1,0,0 --rays r.txt", "--rays"},
        Misuse{"ray x.step --from 0,0,0 --dir 0,1,1 --engine span", "horizontal"},
        Misuse{"plan build -o p.xml", "--machine"}, Misuse{"plan build --machine m.xml", "--output"},
        Misuse{"plan build --machine m.xml -o m.xml", "overwrite an input"},
        Misuse{"export build --to gcode -o f.gcode", "--plan"},
        Misuse{"export build --to gcode -o f.gcode --plan p.xml", "--machine"},
        Misuse{"export build --to xml -o f.xml --plan p.xml", "gcode"},
        Misuse{"slice x.step -o out --gcode f.gcode", "--plan"}, Misuse{"export build --to png", "--output"},
        Misuse{"export build --to gif -o t",
               "available: png, png-indexed, png-grey, png-coverage, polyjet, tiff, sl1, vdb, vti, nrrd, mhd, xml"},
        Misuse{"export build --to jpeg -o t", "available"},
        Misuse{"export build --to xml -o t.xml --layers 5", "--layers"},
        Misuse{"export build --to xml -o t.xml --layers 7:3", "--layers"},
        Misuse{"export build --to xml -o t.xml --layers -1:3", "--layers"},
        Misuse{"export build --to xml -o t.xml --xml-payload hex", "--xml-payload"}, Misuse{"view build", "--output"},
        Misuse{"slice x.step --vdb v.vdb --vdb-grids fog,smoke", "'smoke' is no grid"},
        Misuse{"slice x.step --vdb v.vdb --vdb-grids ''", "--vdb-grids"},
        Misuse{"view build -o v.html --every 0", "--every"}, Misuse{"view build -o v.html --layers 3", "--layers"},
        Misuse{"accuracy", "files"}, Misuse{"accuracy x.step --deflections 0.1,,1", "--deflections"},
        Misuse{"accuracy x.step --deflections ''", "--deflections"},
        Misuse{"accuracy x.step --deflections 0.1,0", "--deflections"},
        Misuse{"accuracy x.step --deflections 1,-0.1", "--deflections"},
        Misuse{"accuracy x.step --deflections nan", "--deflections"},
        Misuse{"accuracy x.step --deflections 1e-9", "out of range"},
        Misuse{"accuracy x.step --deflections 0.1mm", "--deflections"},
        Misuse{"accuracy x.step --pitches 1,zwei", "--pitches"}, Misuse{"accuracy x.step --rays 0", "--rays"},
        Misuse{"accuracy x.step --rays -5", "--rays"}, Misuse{"accuracy x.step --rays 1e99", "--rays"},
        Misuse{"accuracy x.step --max-triangles 0", "--max-triangles"},
        Misuse{"accuracy x.step --max-seconds inf", "--max-seconds"}, Misuse{"accuracy x.step --angle 100", "--angle"},
        Misuse{"accuracy x.step --angle 0", "--angle"}, Misuse{"accuracy x.step -o x.step", "overwrite an input"},
        Misuse{"slice x.step -o out --accuracy 0", "--accuracy"},
        Misuse{"slice x.step -o out --accuracy nan", "--accuracy"},
        Misuse{"slice x.step -o out --accuracy 0.1 --pitch 1", "exclude"},
        Misuse{"slice x.step -o out --accuracy 0.1 --dpi 300", "exclude"},
        Misuse{"slice x.step -o out --accuracy 0.1 --adaptive 0.1", "leave nothing of an accuracy"},
        Misuse{"slice x.step -o out --adaptive auto", "needs --accuracy"},
        Misuse{"slice x.step -o out --accuracy 0.1 --layer-height 0.1", "exclude"}, Misuse{"check", "path"}));

TEST(Errors, AreJsonOnStdoutToo) {
  const CommandResult result = run_lamella("slice x.step -o out --pitch nan --json");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, StartsWith("lamella: error: "));
  const Json error = parse_output(result)["error"];
  expect_keys(error, {"code", "what", "where", "hint"});
  EXPECT_EQ(error["code"], 1);
  EXPECT_EQ(error["where"], "--pitch");
}

TEST(Errors, AFileThatIsntThereIsExitCodeTwo) {
  for (const std::string verb : {"info absent.step", "slice absent.step -o absent-build", "check absent.step",
                                 "ray absent.step --from 0,0,0 --dir 1,0,0", "export absent-build --to xml -o a.xml",
                                 "view absent-build -o a.html", "accuracy absent.step"}) {
    const CommandResult result = run_lamella(verb + " --json");
    EXPECT_EQ(result.exit_code, 2) << verb << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("absent")) << verb;
    EXPECT_EQ(parse_output(result)["error"]["code"], 2) << verb;
  }
  EXPECT_FALSE(std::filesystem::exists("absent-build"));
}

TEST(Errors, NamesCantSteerTheTerminal) {
  const CommandResult result = run_lamella("info $'\\033[2Jx.step'");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_EQ(result.errors.find('\x1B'), std::string::npos) << result.errors;
}

TEST(Errors, AFullDiskBehindStdoutIsExitCodeFour) {
  const CommandResult result = run_command("bash -c \"" + lamella_binary().string() + " --version > /dev/full\"");
  EXPECT_EQ(result.exit_code, 4) << result.errors;
}

}  // namespace
}  // namespace lamella::test
