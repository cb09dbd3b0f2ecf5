#include "model/step/part21.h"

#include <chrono>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "model/step/text.h"

namespace lamella::step {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::string file_of(const std::string& data) {
  return "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 }'));\nENDSEC;\nDATA;\n" + data +
         "\nENDSEC;\nEND-ISO-10303-21;\n";
}

TEST(Part21, IndexesEntitiesWithTheirLines) {
  const std::string text = file_of("#1=LINE('',#2,#3);\n\n/* #9=X(); */ #5 = ( a(1.5) B((#1,#7),$) );");
  const Part21 file(text);
  EXPECT_TRUE(file.recognised());
  EXPECT_TRUE(file.complete());
  EXPECT_EQ(file.schema(), "AUTOMOTIVE_DESIGN { 1 }");
  ASSERT_THAT(file.entities(), SizeIs(2));
  EXPECT_EQ(file.find(5)->line, 8);
  EXPECT_EQ(file.keyword_of(5), "(A B)");
  EXPECT_THAT(file.with_keyword("LINE"), ElementsAre(1));
  EXPECT_EQ(file.find(9), nullptr) << "inside a comment";
  EXPECT_THAT(file.references(*file.find(5)), ElementsAre(1, 7));
}

TEST(Part21, ParsesEveryKindOfValue) {
  const std::string text = file_of("#1=X('it''s; (#2)',-1.5E-3,#4,.T.,$,*,(1,(2)),LENGTH_MEASURE(25.4),\"0F\",42);");
  const Part21 file(text);
  const Part x = file.part(1);
  ASSERT_THAT(x.values, SizeIs(10));
  EXPECT_EQ(decode_string(x[0].text), "it's; (#2)");
  EXPECT_EQ(x[1].real_or(0), -1.5e-3);
  EXPECT_EQ(x[2].ref(), 4);
  EXPECT_TRUE(x[3].is_true(false));
  EXPECT_TRUE(x[4].is(Value::Kind::missing));
  EXPECT_TRUE(x[5].is(Value::Kind::derived));
  EXPECT_THAT(x[6].items, SizeIs(2));
  EXPECT_EQ(x[7].real_or(0), 25.4);
  EXPECT_EQ(x[9].real_or(0), 42.0);
  EXPECT_TRUE(x[99].is(Value::Kind::missing)) << "beyond the end";
  EXPECT_THAT(file.references(*file.find(1)), ElementsAre(4)) << "not those in strings";
}

TEST(Part21, NamesSyntaxFaultsByLineAndEntity) {
  const std::string text = file_of("#1=A();\n#2=B('x',(1);\n#3 C();\n#2=D();\nnonsense;");
  const Part21 file(text);
  ASSERT_THAT(file.faults(), SizeIs(3)) << "#2 is free again for a sound entity";
  EXPECT_EQ(file.faults()[0].line, 7);
  EXPECT_EQ(file.faults()[0].entity, 2);
  EXPECT_EQ(file.faults()[1].entity, 3);
  EXPECT_EQ(file.faults()[2].line, 10);
  const std::string twice = file_of("#1=A();#1=B();");
  EXPECT_EQ(Part21(twice).faults().at(0).what, "the number is used twice");
  EXPECT_EQ(Part21(twice).keyword_of(1), "A");
}

TEST(Part21, NamesTheFirstEntityWithSomethingThatIsNoValue) {
  for (const char* number : {"NAN", "1.E400", "1.E", "--3.", "5.E99999999999", "INF", "#", "0x1"}) {
    const std::string text = file_of("#1=A(1.,-2,+3.5E+2,'NAN');\n#2=B((1.," + std::string(number) + "));");
    EXPECT_EQ(Part21(text).unreadable().entity, 2) << number;
  }
  for (const char* entity : {"#2=B(1.)E;", "#2=B(1.)\x85;", "#2=(B(1.)C()) D();", "#2=B(1.) C(2.);"}) {
    const std::string junk = file_of(entity);
    EXPECT_EQ(Part21(junk).unreadable().entity, 2) << entity;
  }
  const std::string text = file_of("#1=A(1.,-2,+3.5E+2,'NAN',.NAN.,1.E-99,-0.) /* end */ ;");
  EXPECT_EQ(Part21(text).unreadable().entity, 0);
}

TEST(Part21, TellsAFileCutShort) {
  const std::string text = file_of("#1=A('text with ; in it');\n#2=B();");
  int complete = 0;
  for (std::size_t length = 0; length < text.size(); ++length) {
    complete += Part21(std::string_view(text).substr(0, length)).complete() ? 1 : 0;
  }
  EXPECT_EQ(complete, 1) << "only without the last line's end";
  EXPECT_TRUE(Part21(text).complete());
}

TEST(Part21, ReadsDirectivesInStrings) {
  EXPECT_EQ(decode_string("\\X\\E4\\X2\\00DF03B1\\X0\\\\S\\v"), "\xC3\xA4\xC3\x9F\xCE\xB1\xC3\xB6");
  EXPECT_EQ(decode_string("\\X4\\0001F7CA\\X0\\"), "\xF0\x9F\x9F\x8A");
  EXPECT_EQ(decode_string("\\X2\\D83DDFCA\\X0\\"), "\xF0\x9F\x9F\x8A") << "UTF-16 pair";
  EXPECT_EQ(decode_string("a\\\\b''c\\PE\\d"), "a\\b'cd");
  EXPECT_EQ(decode_string("K\xF6rper"), "K\xC3\xB6rper");
  EXPECT_EQ(decode_string("\\X2\\0C4\\X0\\rest"), "0C4\\X0\\rest") << "broken directives stay readable";
}

TEST(Part21, StringsStayUtf8WhateverTheBytes) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string text;
    for (int k = 0; k < 24; ++k) {
      static constexpr std::string_view kLikely = "\\XS024'P\xC3\xA4\xFF";
      text.push_back(random() % 3 == 0 ? static_cast<char>(random() % 256) : kLikely[random() % kLikely.size()]);
    }
    EXPECT_TRUE(is_utf8(decode_string(text))) << text;
  }
}

TEST(Part21, SurvivesDamagedText) {
  const std::string sound = file_of("#1=A('s',(1.,2),#2);#2=( B(#1) C('x') );/* c */#3=D(.T.,$,*);");
  std::mt19937 random(7);
  int still_complete = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string text = sound;
    for (int k = 0; k < 4; ++k) text[random() % text.size()] = static_cast<char>(random() % 256);
    const Part21 file(text);
    still_complete += file.complete() ? 1 : 0;
    for (const Entity& entity : file.entities()) {
      (void)file.parts(entity.number);
      EXPECT_LE(entity.begin + entity.size, text.size());
    }
  }
  EXPECT_GT(still_complete, 0);
  EXPECT_LT(still_complete, 3000);
}

TEST(Part21, RefusesNestingWithoutEnd) {
  const std::string text = file_of("#1=A(" + std::string(100000, '(') + std::string(100000, ')') + ");");
  const Part21 file(text);
  EXPECT_THAT(file.parts(1), IsEmpty());
}

TEST(Part21, TakesLinearTime) {
  std::string data;
  for (int i = 1; i < 200000; ++i) data += "#" + std::to_string(i) + "=CARTESIAN_POINT('',(1.,2.,3.));\n";
  const std::string text = file_of(data);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(Part21(text).entities(), SizeIs(199999));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Part21, EndsWhenCancelled) {
  const std::string text = file_of("#1=A();");
  const std::atomic<bool> cancel = true;
  EXPECT_THROW(Part21(text, Progress({}, &cancel)), Cancelled);
}

}  // namespace
}  // namespace lamella::step
