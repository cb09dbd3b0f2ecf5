#include "materials/glob.h"

#include <chrono>
#include <fnmatch.h>
#include <gtest/gtest.h>
#include <random>

namespace lamella {
namespace {

TEST(Glob, StarsMatchAnyRunAlsoOfSlashes) {
  EXPECT_TRUE(matches_glob("Grip*", "Grip"));
  EXPECT_TRUE(matches_glob("Grip*", "Grip left.2"));
  EXPECT_TRUE(matches_glob("/asm/*/bolt*", "/asm/sub/deep/bolt.1"));
  EXPECT_TRUE(matches_glob("*", ""));
  EXPECT_FALSE(matches_glob("Grip*", "grip"));
  EXPECT_FALSE(matches_glob("", "a"));
  EXPECT_TRUE(matches_glob("a*b*c", "a-b-b-c"));
  EXPECT_FALSE(matches_glob("a*b*c", "a-c-b"));
}

TEST(Glob, QuestionMarksAndSetsTakeOneCharacterNotOneByte) {
  EXPECT_TRUE(matches_glob("Gr?n", "Gr\xC3\xBCn"));
  EXPECT_TRUE(matches_glob("Gr[\xC3\xA4-\xC3\xBC]n", "Gr\xC3\xBCn"));
  EXPECT_FALSE(matches_glob("Gr[!\xC3\xBC]n", "Gr\xC3\xBCn"));
  EXPECT_TRUE(matches_glob("pin.[0-9]", "pin.7"));
  EXPECT_FALSE(matches_glob("pin.[0-9]", "pin.x"));
  EXPECT_TRUE(matches_glob("[]]", "]"));
  EXPECT_TRUE(matches_glob("[a-]", "-"));
}

TEST(Glob, BackslashesMakeSpecialsPlain) {
  EXPECT_TRUE(matches_glob("M6 \\[A2\\] \\*\\?\\\\", "M6 [A2] *?\\"));
  EXPECT_FALSE(matches_glob("\\*", "x"));
}

TEST(Glob, FaultsAreNamed) {
  EXPECT_FALSE(glob_fault("Grip[0-9]*").has_value());
  EXPECT_TRUE(glob_fault("Grip[0-9").has_value());
  EXPECT_TRUE(glob_fault("[").has_value());
  EXPECT_TRUE(glob_fault("[]").has_value());
  EXPECT_TRUE(glob_fault("x\\").has_value());
  EXPECT_TRUE(glob_fault("x\xFF").has_value());
  EXPECT_FALSE(matches_glob("[", "["));
}

TEST(Glob, AgreesWithFnmatchOnRandomAsciiPatterns) {
  std::mt19937 random(3);
  const auto word = [&random](const std::string& letters, std::size_t longest) {
    std::string text(random() % (longest + 1), ' ');
    for (char& c : text) c = letters[random() % letters.size()];
    return text;
  };
  int matched = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    const std::string pattern = word("ab*?", 7);
    const std::string text = word("ab", 7);
    const bool expected = ::fnmatch(pattern.c_str(), text.c_str(), 0) == 0;
    matched += expected ? 1 : 0;
    ASSERT_EQ(matches_glob(pattern, text), expected) << pattern << " on " << text;
  }
  EXPECT_GT(matched, 1000);
}

TEST(Glob, AHostilePatternTakesNoExponentialTime) {
  const auto start = std::chrono::steady_clock::now();
  std::string pattern;
  for (int i = 0; i < 1000; ++i) pattern += "*a";
  EXPECT_FALSE(matches_glob(pattern + "b", std::string(20000, 'a')));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(Glob, AnEscapedTextMatchesItselfOnly) {
  for (const std::string text : {"plain", "a*b", "[x]", "q?", "back\\slash", "Gr\xC3\xBCn"}) {
    EXPECT_TRUE(matches_glob(escape_glob(text), text)) << text;
    EXPECT_FALSE(matches_glob(escape_glob(text), text + "x")) << text;
  }
  EXPECT_FALSE(matches_glob(escape_glob("a*b"), "aab"));
  EXPECT_TRUE(matches_glob(escape_glob("bell\a\xFF"), "bell\a\xFF"));
}

}  // namespace
}  // namespace lamella
