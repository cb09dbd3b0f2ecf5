#include "export/file_name.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/paths.h"

namespace lamella::test {
namespace {

using ::testing::ElementsAre;

std::string name_of(const std::string& name) { return safe_file_names({name}).front(); }

TEST(FileName, KeepsPlainNames) {
  EXPECT_EQ(name_of("steel"), "steel");
  EXPECT_EQ(name_of("Ti-6Al-4V_grade.5"), "Ti-6Al-4V_grade.5");
  EXPECT_EQ(name_of("Geh\u00E4use"), "Geh\u00E4use");
  EXPECT_EQ(name_of("\u94DC"), "\u94DC");
}

TEST(FileName, ReplacesWhatCouldLeaveTheFolder) {
  EXPECT_EQ(name_of(".."), "__");
  EXPECT_EQ(name_of("."), "_");
  EXPECT_EQ(name_of("../../etc/passwd"), "_._.._etc_passwd");
  EXPECT_EQ(name_of("/abs"), "_abs");
  EXPECT_EQ(name_of("C:\\temp"), "C__temp");
  EXPECT_EQ(name_of(std::string("a\0b", 3)), "a_b");
  EXPECT_EQ(name_of("a\nb\tc"), "a_b_c");
}

TEST(FileName, ReplacesBytesThatAreNotUtf8AndInvisibleCharacters) {
  EXPECT_EQ(name_of("a\xFF\xC0\xAF"), "a___");
  EXPECT_EQ(name_of("a\u202Eb\u200Bc\uFEFFd"), "a_b_c_d");
}

TEST(FileName, NamesWhatHasNoName) {
  EXPECT_EQ(name_of(""), "unnamed");
  EXPECT_THAT(safe_file_names({"", ""}), ElementsAre("unnamed", "unnamed_2"));
}

TEST(FileName, AvoidsReservedNames) {
  EXPECT_EQ(name_of("CON"), "_CON");
  EXPECT_EQ(name_of("aux.png"), "_aux.png");
  EXPECT_EQ(name_of("com1"), "_com1");
  EXPECT_EQ(name_of("common"), "common");
}

TEST(FileName, TellsDuplicatesApartWithoutRegardToCase) {
  EXPECT_THAT(safe_file_names({"steel", "Steel", "steel_2", "a/b", "a\\b"}),
              ElementsAre("steel", "Steel_2", "steel_2_2", "a_b", "a_b_2"));
}

TEST(FileName, AvoidsNamesThatAreTaken) {
  EXPECT_THAT(safe_file_names({"Layers.csv", "x"}, {"layers.csv"}), ElementsAre("Layers.csv_2", "x"));
}

TEST(FileName, StaysShortAndKeepsCharactersWhole) {
  const std::string name = name_of(std::string(89, 'a') + "\u94DC\u94DC");
  EXPECT_EQ(name, std::string(89, 'a'));
  EXPECT_LE(safe_file_names(std::vector<std::string>(1000, std::string(300, 'b'))).back().size(), 100u);
}

TEST(FileName, TakesManyEqualNamesInLinearTime) {
  const auto names = safe_file_names(std::vector<std::string>(100000, "x"));
  EXPECT_EQ(names.back(), "x_100000");
}

TEST(FileName, MakesFilesThatCanBeCreated) {
  const TemporaryFolder folder;
  const auto names = safe_file_names({"..", "/", "a\x01", "\u202E", std::string(5000, 'z'), "", "nul", "-rf"});
  for (const std::string& name : names) {
    std::ofstream(folder / name) << "x";
    EXPECT_TRUE(std::filesystem::is_regular_file(folder / name)) << name;
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 8);
}

}  // namespace
}  // namespace lamella::test
