/// The span engine against the certified reference engine on random rows of all files there are; oracle_study.cpp does
/// more of the same.

#include <gtest/gtest.h>

#include "tests/slicing/span/oracle_comparison.h"
#include "tests/support/step_scenes.h"

namespace lamella {
namespace {

class Oracle : public testing::TestWithParam<std::filesystem::path> {};

TEST_P(Oracle, FindsTheSameSpans) {
  const Scene scene = test::read_scene(GetParam());
  const test::OracleTally tally = test::compare_with_oracle(scene, {});
  EXPECT_EQ(tally.differ, 0U) << testing::PrintToString(tally.examples);
  EXPECT_EQ(tally.unclosed, 0U);
  EXPECT_LE(tally.in_zone, 1 + tally.solid_rays / 20);
  RecordProperty("solid_rays", std::to_string(tally.solid_rays));
}

const auto kName = [](const auto& given) { return test::test_name(given.param); };

INSTANTIATE_TEST_SUITE_P(Datasets, Oracle, testing::ValuesIn(test::dataset_files()), kName);
INSTANTIATE_TEST_SUITE_P(Bench, Oracle, testing::ValuesIn(test::bench_files()), kName);
INSTANTIATE_TEST_SUITE_P(Corpus, Oracle, testing::ValuesIn(test::sound_corpus_files()), kName);
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(Oracle);

TEST(OracleFiles, AreThere) {
  LAMELLA_NEEDS_CORPUS();
  EXPECT_GE(test::dataset_files().size(), 10U);
  EXPECT_GE(test::bench_files().size(), 4U);
  EXPECT_GE(test::sound_corpus_files().size(), 50U);
}

}  // namespace
}  // namespace lamella
