#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

Json check(const std::string& path, int exit_code) {
  const CommandResult result = run_lamella("check --json " + path);
  EXPECT_EQ(result.exit_code, exit_code) << path << "\n" << result.output << result.errors;
  return parse_output(result);
}

TEST(Check, JsonHasTheDocumentedKeys) {
  const Json report = check(quoted(source_dir() / "schemas/invalid/materials/unknown_attribute.xml"), 3);
  expect_keys(report, {"ok", "findings"});
  EXPECT_EQ(report["ok"], false);
  ASSERT_EQ(report["findings"].size(), 1U);
  expect_keys(report["findings"][0], {"severity", "where", "what", "hint"});
  EXPECT_EQ(report["findings"][0]["severity"], "error");
  EXPECT_THAT(report["findings"][0]["where"].get<std::string>(), HasSubstr("unknown_attribute.xml:7"));
}

TEST(Check, AValidMaterialsFileIsOk) {
  EXPECT_EQ(check(quoted(source_dir() / "schemas/valid/materials/every_attribute.xml"), 0)["ok"], true);
}

TEST(Check, AWholeBuildIsOkAndADamagedOneIsNot) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_lamella("slice " + boxes() + " --pitch 1 --layer-height 2 -o " + quoted(folder / "build") + " --xml " +
                        quoted(folder / "s.xml"))
                .exit_code,
            0);
  EXPECT_EQ(check(quoted(folder / "build"), 0)["ok"], true);
  EXPECT_EQ(check(quoted(folder / "build/build.xml"), 0)["ok"], true);
  EXPECT_EQ(check(quoted(folder / "s.xml"), 0)["ok"], true);

  const auto shard = folder / "build/layers/000000.h5";
  std::string bytes = contents(shard);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  write_text(shard, bytes);
  const Json damaged = check(quoted(folder / "build"), 3);
  EXPECT_EQ(damaged["ok"], false);
  EXPECT_THAT(damaged["findings"][0]["where"].get<std::string>(), HasSubstr("000000.h5"));

  const std::string slices = contents(folder / "s.xml");
  write_text(folder / "cut.xml", slices.substr(0, slices.size() / 2));
  EXPECT_EQ(check(quoted(folder / "cut.xml"), 3)["ok"], false);
}

TEST(Check, ABuildWithoutItsLinksIsNotOk) {
  const TemporaryFolder folder;
  ASSERT_EQ(run_lamella("slice " + boxes() + " --pitch 1 --layer-height 2 -o " + quoted(folder / "build")).exit_code,
            0);
  write_text(folder / "build/layers.h5", "");
  const Json damaged = check(quoted(folder / "build"), 3);
  EXPECT_THAT(damaged["findings"][0]["where"].get<std::string>(), HasSubstr("layers.h5"));
}

TEST(Check, ASoundStepFileIsOk) { EXPECT_EQ(check(boxes(), 0)["ok"], true); }

TEST(Check, AnOpenSolidIsFoundInAStepFile) {
  const TemporaryFolder folder;
  const Json report = check(write_open_boxes(folder / "open.step", false), 3);
  EXPECT_THAT(report["findings"].dump(), HasSubstr("#"));
}

TEST(Check, WhatIsNotOursIsExitCodeTwo) {
  const TemporaryFolder folder;
  write_text(folder / "note.txt", "hello");
  write_text(folder / "other.xml", "<html/>");
  write_text(folder / "empty", "");
  for (const char* name : {"note.txt", "other.xml", "empty", "absent"}) {
    EXPECT_EQ(check(quoted(folder / name), 2)["error"]["code"], 2) << name;
  }
  EXPECT_EQ(check(quoted(folder.path()), 2)["error"]["code"], 2);
}

TEST(Check, ADocumentTypeIsAFinding) {
  const TemporaryFolder folder;
  write_text(folder / "bomb.xml", "<!DOCTYPE materials [<!ENTITY a 'b'>]><materials/>");
  EXPECT_EQ(check(quoted(folder / "bomb.xml"), 3)["ok"], false);
}

/// To open one is to wait for who writes into it.
TEST(Check, RefusesAPipeAtOnce) {
  const TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const CommandResult result = run_lamella("check " + quoted(folder / "pipe"), {.seconds = 20});
  EXPECT_EQ(result.exit_code, 2) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("not a regular file"));
}

}  // namespace
}  // namespace lamella::test
