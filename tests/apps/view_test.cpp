#include <gmock/gmock.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A build that all tests of this file read.
class View : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    const CommandResult result =
        run_lamella("slice " + boxes() + " --pitch 1 --layer-height 2 -o " + quoted(*folder_ / "build"));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  static void TearDownTestSuite() { delete folder_; }

  static CommandResult view(const std::string& name, const std::string& options = {}) {
    return run_lamella("view " + quoted(*folder_ / "build") + " -o " + quoted(*folder_ / name) + " " + options);
  }
  static std::filesystem::path place(const std::string& name) { return *folder_ / name; }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(View, HatchesOfABuildWithoutAreRefused) {
  const CommandResult result = view("hatched.html", "--hatches");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("slice with --hatch-spacing"));
  EXPECT_FALSE(std::filesystem::exists(place("hatched.html")));
}

TEST_F(View, SaysWhatItWroteAsExportDoes) {
  const CommandResult result = view("view.html", "--json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  EXPECT_EQ(report["format"], "html");
  ASSERT_EQ(report["files"].size(), 1U);
  EXPECT_EQ(report["files"][0]["path"], place("view.html").string());
  EXPECT_EQ(report["files"][0]["bytes"], std::filesystem::file_size(place("view.html")));
}

TEST_F(View, ThePageIsWholeAndNeedsNothingElse) {
  ASSERT_EQ(view("page.html").exit_code, 0);
  const std::string page = contents(place("page.html"));
  EXPECT_THAT(page, StartsWith("<!DOCTYPE html>"));
  EXPECT_EQ(page.substr(page.size() - 8), "</html>\n");
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(ContainsRegex("<(script|link|img|iframe)[^>]*(src|href)=")));
  EXPECT_THAT(page, Not(HasSubstr("lamella:data")));
}

TEST_F(View, TheSameBuildGivesTheSameBytes) {
  ASSERT_EQ(view("a.html").exit_code, 0);
  ASSERT_EQ(view("b.html", "--threads 1").exit_code, 0);
  EXPECT_EQ(contents(place("a.html")), contents(place("b.html")));
}

TEST_F(View, TakesRangesAndEveryNthLayer) {
  ASSERT_EQ(view("some.html", "--layers 1:5 --every 2").exit_code, 0);
  EXPECT_THAT(contents(place("some.html")), HasSubstr("\"index\":[1,3]"));
  EXPECT_EQ(view("none.html", "--layers 100000:").exit_code, 1);
  EXPECT_EQ(view("none.html", "--every 0").exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(place("none.html")));
}

TEST_F(View, WhatIsTooLargeIsRefusedAtOnceWithTheFewestLayersToLeaveOut) {
  std::filesystem::copy(place("build"), place("huge"), std::filesystem::copy_options::recursive);
  std::string text = contents(place("huge/build.xml"));
  const std::size_t rows = text.find(" rows=\"", text.find("<report "));
  ASSERT_NE(rows, std::string::npos);
  text.replace(rows, text.find('"', rows + 7) + 1 - rows, " rows=\"100000000\"");
  write_text(place("huge/build.xml"), text);
  const std::string command = "view " + quoted(place("huge")) + " -o " + quoted(place("huge.html"));
  const CommandResult result = run_lamella(command);
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("--every 3"));
  EXPECT_EQ(run_lamella(command + " --every 3").exit_code, 0);
}

TEST_F(View, RefusesToWriteOverTheBuildOrAFolder) {
  EXPECT_EQ(view("build").exit_code, 1);
  std::filesystem::create_directory(place("folder"));
  EXPECT_EQ(view("folder").exit_code, 4);
  EXPECT_TRUE(std::filesystem::exists(place("build") / "build.xml"));
}

}  // namespace
}  // namespace lamella::test
