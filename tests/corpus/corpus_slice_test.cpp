#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "tests/support/command.h"
#include "tests/support/corpus.h"

namespace lamella::test {
namespace {

using nlohmann::json;
using ::testing::AnyOf;
using ::testing::ContainsRegex;
using ::testing::Eq;
using ::testing::HasSubstr;
using ::testing::Not;

class OkFile : public ::testing::TestWithParam<CorpusFile> {};
class BadFile : public ::testing::TestWithParam<CorpusFile> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(OkFile);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(BadFile);

const auto by_name = [](const auto& info) { return test_name(info.param); };
INSTANTIATE_TEST_SUITE_P(Corpus, OkFile, ::testing::ValuesIn(corpus_files("ok")), by_name);
INSTANTIATE_TEST_SUITE_P(Corpus, BadFile, ::testing::ValuesIn(corpus_files("bad")), by_name);

constexpr CommandLimits kHostile{.seconds = 60, .bytes = 4LL << 30};

TEST(Corpus, IsComplete) {
  LAMELLA_NEEDS_CORPUS();
  EXPECT_EQ(corpus_files("ok").size(), 53u);
  EXPECT_EQ(corpus_files("bad").size(), 16u);
}

/// Pitch and layer height that give about 100 rows and 50 layers.
std::string lattice_options(const json& info) {
  double low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<double>::infinity());
  std::fill_n(high, 3, -std::numeric_limits<double>::infinity());
  for (const json& solid : info["solids"]) {
    if (solid["bounds"].is_null()) continue;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], solid["bounds"][0][axis].get<double>());
      high[axis] = std::max(high[axis], solid["bounds"][1][axis].get<double>());
    }
  }
  const auto text = [](double value) { return json(value).dump(); };
  return "--pitch " + text((high[1] - low[1]) / 100) + " --layer-height " + text((high[2] - low[2]) / 50);
}

/// Whether the manifest itself says that the file can't be trusted.
bool may_exceed_budget(const CorpusFile& file) {
  return file.text("valid") != "yes" || file.number("open_shells") > 0 || file.number("free_faces") > 0 ||
         file.number("max_edge_tol") > 0.01;
}

TEST_P(OkFile, SlicesAtAHundredRowsByFiftyLayers) {
  const TemporaryFolder folder;
  const CommandResult info = run_lamella("info --json " + quoted(GetParam().path()));
  ASSERT_THAT(info.exit_code, AnyOf(Eq(0), Eq(3))) << info.errors;

  const CommandResult slice = run_lamella("slice " + quoted(GetParam().path()) + " -o " + quoted(folder / "build") +
                                              " --json " + lattice_options(json::parse(info.output)),
                                          {.seconds = 280});
  if (may_exceed_budget(GetParam())) {
    EXPECT_THAT(slice.exit_code, AnyOf(Eq(0), Eq(3))) << slice.errors;
  } else {
    EXPECT_EQ(slice.exit_code, 0) << slice.errors;
  }
  const json report = json::parse(slice.output);
  EXPECT_NEAR(report["layers"].get<double>(), 50, 1);
  EXPECT_GE(report["rays"].get<double>(), 99 * 49);
  EXPECT_GT(report["segments"].get<double>(), 0);
  if (slice.exit_code == 3) {
    EXPECT_THAT(slice.errors, HasSubstr("warning")) << "exit 3 without saying why";
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "build/build.xml"));
}

bool is_named(const std::string& text) { return std::regex_search(text, std::regex("#[0-9]+|line [0-9]+|:[0-9]+")); }

TEST_P(BadFile, IsRefusedOrWarnedOfByEntity) {
  const CorpusFile& file = GetParam();
  const bool refuse = file.text("category") == "bad-refuse";
  const TemporaryFolder folder;
  const CommandResult info = run_lamella("info --json " + quoted(file.path()), kHostile);
  const CommandResult slice = run_lamella(
      "slice " + quoted(file.path()) + " -o " + quoted(folder / "build") + " --pitch 5 --layer-height 20", kHostile);
  if (refuse) {
    EXPECT_EQ(info.exit_code, 2) << info.errors;
    EXPECT_EQ(slice.exit_code, 2) << slice.errors;
  } else {
    EXPECT_THAT(slice.exit_code, AnyOf(Eq(0), Eq(2), Eq(3))) << slice.errors;
  }
  EXPECT_THAT(slice.errors, ContainsRegex("lamella: (error|warning): "));
  EXPECT_TRUE(is_named(slice.errors)) << "no STEP entity or line named: " << slice.errors;
  EXPECT_THAT(slice.errors, Not(HasSubstr("terminate called")));
  if (slice.exit_code == 2) {
    EXPECT_FALSE(std::filesystem::exists(folder / "build")) << "exit 2 wrote something";
  }
}

}  // namespace
}  // namespace lamella::test
