#include "core/xml_parts.h"

#include <chrono>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>
#include <vector>

#include "core/error.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kPlenty = std::uint64_t{1} << 30;

/// What is said of an element: its name, where it is, its attributes, text and children.
std::string described(const XmlElement& element) {
  std::string out = std::string(element.name()) + "@" + std::to_string(element.line()) + "{";
  for (const std::string& name : element.attributes()) out += name + "=" + element.attribute(name.c_str()) + ";";
  out += element.text();
  for (const XmlElement& child : element.children()) out += described(child);
  return out + "}";
}

/// The children of a file's root, read part by part.
std::vector<std::string> parts_of(const std::string& text, std::uint64_t most = kPlenty) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "f.xml", std::ios::binary) << text;
  XmlParts file(folder / "f.xml", most);
  std::vector<std::string> parts;
  while (const auto part = file.next()) parts.push_back(described(part->root()));
  EXPECT_FALSE(file.next());
  return parts;
}

InputError refusal_of_parts(const std::string& text, std::uint64_t most = kPlenty) {
  try {
    (void)parts_of(text, most);
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << text.substr(0, 200);
  return InputError("accepted");
}

std::string random_element(std::mt19937& random, int depth) {
  const std::vector<std::string> texts{"", " x ", "&lt;&#65;", "<!-- > -->", "<![CDATA[</a>]]>", "\n"};
  const std::string name(1, static_cast<char>('a' + random() % 3));
  std::string out = "<" + name;
  if (random() % 2 == 0) out += " k='\">/>'";
  if (random() % 2 == 0) out += "\n m=\"" + std::string(random() % 9, 'm') + "'>\"";
  if (random() % 3 == 0) return out + "/>";
  out += ">";
  for (std::size_t n = random() % 4; n > 0; --n) {
    out += texts[random() % texts.size()];
    if (depth < 4) out += random_element(random, depth + 1);
  }
  return out + "</" + name + ">";
}

TEST(XmlParts, AreTheChildrenThatTheWholeDocumentHas) {
  std::mt19937 random(5);
  for (int round = 0; round < 100; ++round) {
    std::string text = round % 2 == 0 ? "\xEF\xBB\xBF<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- <x> -->\n" : "";
    text += "<root xmlns='urn:x' a='>'>";
    // Some are larger than what is read at once.
    const std::size_t wide = round % 10 == 0 ? 3000 : 8;
    for (std::size_t n = random() % wide; n > 0; --n) {
      text += std::vector<std::string>{"", "\n", " \t\r\n", "<!-- <a> -->"}[random() % 4];
      text += random_element(random, 0);
    }
    text += "\n<!-- - -->\n</root \n>\n<!-- end -->\n";
    std::vector<std::string> expected;
    const XmlDocument whole = XmlDocument::parse(text, "f.xml");
    for (const XmlElement& child : whole.root("root").children()) {
      expected.push_back(described(child));
    }
    ASSERT_EQ(parts_of(text), expected) << text.substr(0, 2000);
  }
}

/// The file is read in chunks: nothing may be overlooked that lies across their edge.
TEST(XmlParts, MarkupAcrossTheEdgeOfAChunkIsSeen) {
  constexpr std::size_t kChunk = std::size_t{1} << 18;
  for (const std::string markup : {"<!---->", "<a x='>'/>", "<a>]</a>", "<a><![CDATA[]]></a>", "<a><!-- - --></a>"}) {
    for (std::size_t before = 0; before <= markup.size(); ++before) {
      const std::string head = "<r><b/>";
      const std::string text = head + std::string(kChunk - head.size() - before, ' ') + markup + "<c/></r>";
      std::vector<std::string> expected;
      const XmlDocument whole = XmlDocument::parse(text, "f.xml");
      for (const XmlElement& child : whole.root("r").children()) expected.push_back(described(child));
      ASSERT_EQ(parts_of(text), expected) << markup << " " << before;
    }
    // Within a comment and within a child.
    for (std::size_t before = 0; before <= 3; ++before) {
      const std::string filling(kChunk - 7 - before, 'x');
      EXPECT_EQ(parts_of("<r><!--" + filling + "--><c/></r>").size(), 1U) << before;
      EXPECT_EQ(parts_of("<r><a>x" + filling + "<![CDATA[]]></a><c/></r>").size(), 2U) << before;
    }
  }
}

TEST(XmlParts, HaveARootWithoutChildren) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "f.xml") << "<?xml version=\"1.0\"?>\n<root a=\"1\"><b/></root>";
  XmlParts file(folder / "f.xml", kPlenty);
  EXPECT_EQ(file.root().root("root").number("a"), 1.0);
  EXPECT_EQ(file.root().root().line(), 2);
  EXPECT_TRUE(file.root().root().children().empty());
  EXPECT_TRUE(parts_of("<root/>").empty());
  EXPECT_TRUE(parts_of("<root a='1'/> <!-- x -->\n").empty());
}

TEST(XmlParts, TruncatedAnywhereAreRefused) {
  const std::string text =
      "<?xml version=\"1.0\"?><!-- c --><root a='1'> <b x=\"2\">t<c/></b><!-- d --><b/></root><!-- e -->";
  EXPECT_EQ(parts_of(text).size(), 2U);
  const std::size_t whole = text.find("</root>") + 7;
  for (std::size_t size = 0; size < text.size(); ++size) {
    if (size == whole) continue;
    EXPECT_NE(refusal_of_parts(text.substr(0, size)).where(), "") << size;
  }
}

TEST(XmlParts, WhatTheWholeDocumentIsRefusedForIsRefused) {
  const auto what = [](const std::string& text) { return std::string(refusal_of_parts(text).what()); };
  EXPECT_THAT(what("<!DOCTYPE r><r><a/></r>"), HasSubstr("document type"));
  EXPECT_THAT(what("<r><a/><!DOCTYPE r><a/></r>"), HasSubstr("document type"));
  EXPECT_THAT(what("<r><a><!ENTITY x 'y'></a></r>"), HasSubstr("document type"));
  EXPECT_THAT(what("<r><a/></r><!DOCTYPE r>"), HasSubstr("document type"));
  EXPECT_THAT(what("<r><a>&lol;</a></r>"), HasSubstr("entity"));
  EXPECT_THAT(what("<r b='&lol;'><a/></r>"), HasSubstr("entity"));
  EXPECT_THAT(what("<r><a/>text<a/></r>"), HasSubstr("holds text"));
  EXPECT_THAT(what("<r><a/>&lt;<a/></r>"), HasSubstr("holds text"));
  EXPECT_THAT(what("<r><a/><![CDATA[ ]]></r>"), HasSubstr("holds text"));
  EXPECT_THAT(what("<r><a/><?xml version='1.0'?><a/></r>"), HasSubstr("processing instruction"));
  EXPECT_THAT(what("<r><?p?><a/></r>"), HasSubstr("processing instruction"));
  EXPECT_THAT(what("<r><a/></r><?p?>"), HasSubstr("well-formed"));
  EXPECT_THAT(what("<r><a/></r>text"), HasSubstr("outside the root"));
  EXPECT_THAT(what("<r/>text"), HasSubstr("outside the root"));
  EXPECT_THAT(what("<r><a/></r><r/>"), HasSubstr("second root"));
  EXPECT_THAT(what("<r/><r/>"), HasSubstr("second root"));
  EXPECT_THAT(what("<r><a/></s>"), HasSubstr("closes <r>"));
  EXPECT_THAT(what("<r><a></b></r>"), HasSubstr("well-formed"));
  EXPECT_THAT(what("</r>"), HasSubstr("end tag"));
  EXPECT_THAT(what("<r><a x='<'/></r>"), HasSubstr("'<'"));
  EXPECT_THAT(what("<r><!-- \xFF --><a/></r>"), HasSubstr("UTF-8"));
  EXPECT_THAT(what("<r><a/><!-- \xFF --></r>"), HasSubstr("UTF-8"));
  EXPECT_THAT(what("<r><a/></r><!-- \xFF -->"), HasSubstr("UTF-8"));
  EXPECT_THAT(what("<?xml version='1.0' encoding='latin1'?><r><a/></r>"), HasSubstr("encoding"));
  EXPECT_THAT(what(""), HasSubstr("ends"));
  EXPECT_THAT(refusal_of_parts("<r>\n<a/>\n<a\n x='&lol;'/></r>").where(), ::testing::EndsWith("f.xml:4"));
  std::string deep;
  for (int i = 0; i < 70; ++i) deep += "<a>";
  for (int i = 0; i < 70; ++i) deep += "</a>";
  EXPECT_THAT(what("<r>" + deep + "</r>"), HasSubstr("nested"));
}

TEST(XmlParts, BombsAreRefusedInBoundedTime) {
  const auto start = std::chrono::steady_clock::now();
  const std::string much(XmlDocument::kMaxBytes + (1U << 20), ' ');
  EXPECT_THAT(refusal_of_parts("<r><a/></r>", 10).what(), HasSubstr("too large"));
  EXPECT_THAT(refusal_of_parts("<r><a x='" + much + "'/></r>").what(), HasSubstr("too large"));
  EXPECT_THAT(refusal_of_parts("<r>" + much + "<a/></r>").what(), HasSubstr("too large"));
  EXPECT_THAT(refusal_of_parts("<r><!--" + much + "--><a/></r>").what(), HasSubstr("too large"));
  EXPECT_THAT(refusal_of_parts(much + "<r/>").what(), HasSubstr("too large"));
  EXPECT_THAT(refusal_of_parts("<r/>" + much).what(), HasSubstr("too large"));
  std::string open = "<r>";
  while (open.size() < much.size()) open += "<a><a><a><a><a><a><a><a><a><a><a><a><a><a><a><a>";
  EXPECT_THAT(refusal_of_parts(open).what(), HasSubstr("too large"));
  const test::TemporaryFolder folder;
  std::ofstream(folder / "sparse.xml") << "<r>";
  std::filesystem::resize_file(folder / "sparse.xml", std::uintmax_t{1} << 40);
  EXPECT_THROW((void)XmlParts(folder / "sparse.xml", kPlenty), InputError);
  EXPECT_THROW((void)XmlParts(folder.path(), kPlenty), InputError);
  EXPECT_THROW((void)XmlParts("/dev/zero", kPlenty), InputError);
  EXPECT_THROW((void)XmlParts(folder / "absent.xml", kPlenty), InputError);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

}  // namespace
}  // namespace lamella
