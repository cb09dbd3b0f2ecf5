#include <algorithm>
#include <gmock/gmock.h>
#include <regex>
#include <set>

#include "tests/apps/command_json.h"
#include "tests/support/schema_samples.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

std::string job_text(const std::string& body) {
  return "<job xmlns=\"urn:lamella:job:1\" version=\"1.0\">\n" + body + "\n</job>\n";
}

TEST(JobSchema, SchemaAndReaderAcceptTheValidSamples) {
  ASSERT_GE(schema_samples("valid", "job").size(), 2U);
  for (const auto& file : schema_samples("valid", "job")) {
    EXPECT_TRUE(schema_accepts("job", file)) << file;
    EXPECT_EQ(run_lamella("check " + quoted(file)).exit_code, 0) << file;
  }
}

TEST(JobSchema, SchemaAndReaderRefuseTheInvalidSamples) {
  ASSERT_GE(schema_samples("invalid", "job").size(), 20U);
  for (const auto& file : schema_samples("invalid", "job")) {
    EXPECT_FALSE(schema_accepts("job", file)) << file;
    const int code = run_lamella("check " + quoted(file)).exit_code;
    EXPECT_TRUE(code == 2 || code == 3) << file << ": exit code " << code;
  }
}

/// "--pitch" of every option that the text mentions.
std::set<std::string> names_in(const std::string& text, const std::regex& pattern) {
  std::set<std::string> names;
  for (std::sregex_iterator it(text.begin(), text.end(), pattern), end; it != end; ++it) names.insert((*it)[1]);
  return names;
}

TEST(JobSchema, EveryOptionOfSliceHasItsPlace) {
  const std::string help = run_lamella("slice --help").output;
  std::set<std::string> options =
      names_in(help.substr(0, help.find("Examples")), std::regex("\\n  [^\\n]*?--([a-z0-9-]+)"));
  for (const char* of_the_command_line : {"help", "job"}) EXPECT_EQ(options.erase(of_the_command_line), 1U);
  const std::string schema = contents(source_dir() / "schemas/job.xsd");
  const std::size_t begin = schema.find("name=\"Options\"");
  const std::string type = schema.substr(begin, schema.find("</xs:complexType>", begin) - begin);
  // Names in XML don't begin with a digit: there `_` goes before it.
  EXPECT_EQ(names_in(type, std::regex("attribute name=\"_?([a-z0-9-]+)\"")), options);
}

class Job : public ::testing::Test {
 protected:
  CommandResult run(const std::string& body, const std::string& arguments = "") {
    write_text(folder_ / "job.xml", job_text(body));
    return run_lamella("slice --quiet --job " + quoted(folder_ / "job.xml") + " " + arguments);
  }
  /// The touching boxes, named relative to the job.
  [[nodiscard]] std::string part(const std::string& children = "", const std::string& more = "") const {
    const auto file = std::filesystem::relative(datasets_dir() / "touching_boxes/touching_boxes.step", folder_.path());
    return "<part file=\"" + file.string() + "\"" + more + ">" + children + "</part>\n";
  }

  TemporaryFolder folder_;
};

TEST_F(Job, GivesTheSameAsTheCommandLine) {
  const CommandResult by_job =
      run(part() + "<options output=\"a\" layer-height=\"2\" pitch=\"1\" hatch-spacing=\"1.5\" json=\"true\"/>");
  ASSERT_EQ(by_job.exit_code, 0) << by_job.errors;
  const CommandResult typed = run_lamella("slice " + boxes() +
                                          " --quiet --json --layer-height 2 --pitch 1 "
                                          "--hatch-spacing 1.5 -o " +
                                          quoted(folder_ / "b"));
  Json a = parse_output(by_job);
  Json b = parse_output(typed);
  for (const char* key : {"grid", "rows", "segments", "solids", "materials"}) EXPECT_EQ(a[key], b[key]) << key;
  EXPECT_EQ(contents(folder_ / "a/layers/000000.h5"), contents(folder_ / "b/layers/000000.h5"));
}

TEST_F(Job, TheCommandLineGoesBefore) {
  const CommandResult result = run(part() + "<options output=\"a\" layer-height=\"2\" pitch=\"1\"/>",
                                   "--json --pitch 3 -o " + quoted(folder_ / "c"));
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(parse_output(result)["grid"]["pitch"], Json({3.0, 3.0, 2.0}));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "c/build.xml"));
}

TEST_F(Job, PlacesTurnsAndTilesParts) {
  const std::string options = "<options output=\"a\" layer-height=\"2\" pitch=\"1\" json=\"true\"/>";
  const Json once = parse_output(run(part() + options));
  const Json many = parse_output(run(part("<place shift=\"0,0,100\"/><place turn=\"1,0,0,180\" shift=\"0,500,0\"/>"
                                          "<tile counts=\"2,3,1\" spacing=\"100,100,0\"/>",
                                          " label=\"b\"") +
                                     options));
  ASSERT_EQ(many["solids"].size(), 8 * once["solids"].size());
  double volume = 0.0;
  for (const Json& solid : once["solids"]) volume += solid["volume_exact"].get<double>();
  double all = 0.0;
  for (const Json& solid : many["solids"]) all += solid["volume_exact"].get<double>();
  EXPECT_NEAR(all, 8 * volume, 1e-9 * all);
  EXPECT_THAT(many["solids"][0]["path"].get<std::string>(), HasSubstr("/b.1/"));
  EXPECT_THAT(many["solids"].back()["path"].get<std::string>(), HasSubstr("/b.8/"));
}

TEST_F(Job, RefusesWhatMakesNoSense) {
  struct Case {
    std::string body;
    const char* says;
  };
  const std::vector<Case> cases{
      {part("<place turn=\"0,0,0,90\"/>"), "no direction"},
      {part("<tile counts=\"2,1,1\"/>"), "one place"},
      {part("<tile counts=\"1000,1000,1000\" spacing=\"1,1,1\"/>"), "million"},
      {part("<tile counts=\"99999999999999999999,1,1\" spacing=\"1,1,1\"/>"), "counts"},
      {part("<tile counts=\"1000000,1,1\" spacing=\"1,1,1\"/><place/>"), "copies"},
      {part("<place shift=\"1e400,0,0\"/>"), "job.xml:2"},
      {"<part file=\"missing.step\"/>", "missing.step"},
      {part() + "<options pitch=\"fine\"/>", "--pitch"},
      {"<part file=\"job.xml\"/>", "job.xml"},
  };
  for (const Case& c : cases) {
    const CommandResult result = run(c.body, "-o " + quoted(folder_ / "out"));
    EXPECT_TRUE(result.exit_code == 1 || result.exit_code == 2) << c.body << result.errors;
    EXPECT_THAT(result.errors, HasSubstr(c.says));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out")) << c.body;
  }
}

TEST_F(Job, NeverWritesOverItself) {
  const CommandResult result = run(part() + "<options output=\"a\" pitch=\"1\" xml=\"job.xml\"/>");
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("overwrite an input"));
}

TEST_F(Job, DryRunWritesNothing) {
  const CommandResult result = run(part() + "<options output=\"a\" pitch=\"1\" dry-run=\"true\" json=\"true\"/>");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a"));
}

}  // namespace
}  // namespace lamella::test
