#include "model/step/text.h"

#include <gtest/gtest.h>

namespace lamella::step {
namespace {

TEST(Text, KnowsUtf8FromOtherBytes) {
  EXPECT_TRUE(is_utf8("K\xC3\xB6rper \xF0\x9F\x9F\x8A"));
  EXPECT_FALSE(is_utf8("K\xF6rper"));
  EXPECT_FALSE(is_utf8("\xC0\x80")) << "overlong";
  EXPECT_FALSE(is_utf8("\xED\xA0\x80")) << "surrogate";
  EXPECT_FALSE(is_utf8("\xF4\x90\x80\x80")) << "above U+10FFFF";
  EXPECT_FALSE(is_utf8("\xC3")) << "cut short";
}

TEST(Text, TakesOtherBytesAsLatin1) {
  EXPECT_EQ(clean_name("K\xF6rper"), "K\xC3\xB6rper");
  EXPECT_TRUE(is_utf8(clean_name("\xFF\xFE\x80")));
}

TEST(Text, CleansNamesOfControlCharactersAndPlaceholders) {
  EXPECT_EQ(clean_name("  top\n cover\x7F "), "top  cover");
  EXPECT_EQ(clean_name("NONE"), "");
  EXPECT_EQ(clean_name(" \t "), "");
}

TEST(Text, MakesPathComponentsWithoutSlashes) {
  EXPECT_EQ(path_component("M3/M4 screw", "part"), "M3_M4 screw");
  EXPECT_EQ(path_component("", "part"), "part");
}

}  // namespace
}  // namespace lamella::step
