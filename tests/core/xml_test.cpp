#include "core/xml.h"

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/utf8.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

/// The error that `text` is refused with; fails the test when it is accepted.
InputError refusal(const std::string& text) {
  try {
    (void)XmlDocument::parse(text, "file.xml");
  } catch (const InputError& error) {
    return error;
  }
  ADD_FAILURE() << "accepted: " << text.substr(0, 200);
  return InputError("accepted");
}

std::string nested(int depth) {
  std::string text;
  for (int i = 0; i < depth; ++i) text += "<a>";
  for (int i = 0; i < depth; ++i) text += "</a>";
  return text;
}

TEST(Xml, ReadsElementsAttributesAndText) {
  const auto document = XmlDocument::parse(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<root xmlns='urn:x'>\n  <!-- note -->\n"
      "  <item x='1.5' n=' +7 ' name='a&amp;b &#xE9;'>  some <![CDATA[<text>]]> </item>\n</root>\n",
      "file.xml");
  const XmlElement root = document.root("root");
  ASSERT_EQ(root.children().size(), 1U);
  const XmlElement item = root.child("item").value();
  EXPECT_EQ(item.line(), 4);
  EXPECT_EQ(item.where(), "file.xml:4");
  EXPECT_EQ(item.number("x"), 1.5);
  EXPECT_EQ(item.integer("n"), 7);
  EXPECT_EQ(item.attribute("name"), "a&b \xC3\xA9");
  EXPECT_EQ(item.text(), "some <text>");
  EXPECT_EQ(item.number_or("y", 2.0), 2.0);
  EXPECT_FALSE(root.child("other").has_value());
}

TEST(Xml, MissingAndMalformedValuesNameFileAndLine) {
  const auto document =
      XmlDocument::parse("<root>\n<item x='1.5mm' n='1.5' i='inf' h='0x10' e=''/>\n</root>", "file.xml");
  const XmlElement item = document.root("root").child("item").value();
  const auto fails_here = [](const auto& call) {
    try {
      call();
    } catch (const InputError& error) {
      return error.where() == "file.xml:2" && !error.hint().empty();
    }
    return false;
  };
  EXPECT_TRUE(fails_here([&] { (void)item.attribute("absent"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.number("absent"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.number("x"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.number("i"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.number("h"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.number("e"); }));
  EXPECT_TRUE(fails_here([&] { (void)item.integer("n"); }));
}

TEST(Xml, NumbersOutOfRangeAreRefused) {
  const auto document = XmlDocument::parse("<r a='1e999' b='99999999999999999999'/>", "file.xml");
  EXPECT_THROW((void)document.root("r").number("a"), InputError);
  EXPECT_THROW((void)document.root("r").integer("b"), InputError);
}

TEST(Xml, TypingErrorsDontPassSilently) {
  const auto document =
      XmlDocument::parse("<r xmlns='urn:x' xmlns:xsi='urn:y' xsi:z='1' a='1' b='2'><c/>text</r>", "file.xml");
  const XmlElement root = document.root("r");
  EXPECT_THROW(root.allow_only({"a"}, {"c"}), InputError);       // attribute b
  EXPECT_THROW(root.allow_only({"a", "b"}, {"d"}), InputError);  // element c
  EXPECT_THROW(root.allow_only({"a", "b"}, {"c"}), InputError);  // the text
  EXPECT_NO_THROW(XmlDocument::parse("<r a='1'><c/></r>", "x").root("r").allow_only({"a"}, {"c"}));
  EXPECT_THROW((void)document.root("other"), InputError);
}

TEST(Xml, ADocumentTypeIsRefusedHoweverItIsSpelled) {
  const std::string bomb =
      "<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">\n"
      "<!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;\">]>\n<r>&c;</r>";
  EXPECT_THAT(refusal(bomb).what(), HasSubstr("document type"));
  EXPECT_EQ(refusal(bomb).where(), "file.xml:2");
  EXPECT_THAT(refusal("<!DOCTYPE r SYSTEM 'file:///etc/passwd'><r/>").what(), HasSubstr("document type"));
  EXPECT_THAT(refusal("<!-- x --><!doctype html><r/>").what(), HasSubstr("document type"));
  EXPECT_THAT(refusal("<r><!ENTITY x 'y'></r>").what(), HasSubstr("document type"));
}

TEST(Xml, EntitiesOtherThanTheFiveAreRefused) {
  refusal("<r>&xxe;</r>");
  refusal("<r a='&nbsp;'/>");
  refusal("<r>&#0;</r>");
  refusal("<r>&#xFFFFFFFFFFFF;</r>");
  refusal("<r>&#xD800;</r>");
  refusal("<r>fish & chips</r>");
  refusal("<r>&#;</r>");
  EXPECT_EQ(XmlDocument::parse("<r>&lt;&#65;&#x42;&apos;</r>", "x").root("r").text(), "<AB'");
}

TEST(Xml, SpecialsAreHarmlessInsideCommentsAndCharacterData) {
  const auto document = XmlDocument::parse("<r><!-- & <!DOCTYPE a> < --><![CDATA[& <!DOCTYPE b>]]></r>", "file.xml");
  EXPECT_EQ(document.root("r").text(), "& <!DOCTYPE b>");
}

TEST(Xml, NestingIsBounded) {
  EXPECT_NO_THROW((void)XmlDocument::parse(nested(XmlDocument::kMaxDepth), "file.xml"));
  EXPECT_THAT(refusal(nested(XmlDocument::kMaxDepth + 1)).what(), HasSubstr("nested"));
  refusal(nested(1000000));
}

TEST(Xml, TruncatedFilesAreRefusedAtEveryByte) {
  const std::string whole = "<?xml version='1.0'?><r a='1'><!-- c --><b c=\"2\">t&amp;<![CDATA[x]]></b></r>";
  ASSERT_NO_THROW((void)XmlDocument::parse(whole, "file.xml"));
  for (std::size_t size = 0; size < whole.size(); ++size) refusal(whole.substr(0, size));
}

TEST(Xml, MalformedMarkupIsRefused) {
  for (const char* text : {"",
                           " ",
                           "text",
                           "<r/><r/>",
                           "<r/>text",
                           "text<r/>",
                           "<r></s>",
                           "</r>",
                           "<r a=1/>",
                           "<r a='1' a='2'/>",
                           "<r a='<'/>",
                           "<r",
                           "<r a='x",
                           "<r><![CDATA[x</r>",
                           "<r><!-- x</r>",
                           "<?xml <r/>",
                           "<1/>",
                           "</a><b></b><a>",
                           "<r a/>",
                           "<![CDATA[x]]><r/>"}) {
    refusal(text);
  }
}

TEST(Xml, BytesThatArentUtf8AreRefused) {
  refusal("<r a='caf\xE9'/>");              // Latin-1
  refusal("<r a='\xC0\xAF'/>");             // overlong
  refusal("<r a='\xED\xA0\x80'/>");         // surrogate
  refusal("<r a='\xF4\x90\x80\x80'/>");     // above U+10FFFF
  refusal(std::string("<r a='\0'/>", 10));  // NUL
  refusal("<r>\x1B[2J</r>");                // terminal escape
  refusal("\xFF\xFE<\0r\0/\0>\0");          // UTF-16
  refusal("<?xml version='1.0' encoding='ISO-8859-1'?><r/>");
  EXPECT_NO_THROW((void)XmlDocument::parse("\xEF\xBB\xBF<?xml version='1.0' encoding='utf-8'?><r a='\xC3\xA9'/>", "x"));
}

TEST(Xml, ALargeHonestFileIsReadInBoundedTime) {
  const auto start = std::chrono::steady_clock::now();
  std::string text = "<r>";
  for (int i = 0; i < 300000; ++i) text += "<layer index=\"" + std::to_string(i) + "\"/>\n";
  EXPECT_EQ(XmlDocument::parse(text + "</r>", "x").root("r").children("layer").size(), 300000U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(Xml, HugeInputIsRefusedInBoundedTime) {
  const auto start = std::chrono::steady_clock::now();
  std::string attributes = "<r";
  for (int i = 0; i < 300000; ++i) attributes += " a" + std::to_string(i) + "=''";
  EXPECT_THAT(refusal(attributes + "/>").what(), HasSubstr("attributes"));
  std::string elements = "<r>";
  while (elements.size() < (std::size_t{12} << 20)) elements += "<a/><a/><a/><a/>";
  EXPECT_THAT(refusal(elements + "</r>").what(), HasSubstr("too many elements"));
  EXPECT_THAT(refusal(std::string(XmlDocument::kMaxBytes + 1, ' ')).what(), HasSubstr("too large"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(Xml, ReadsFilesAndRefusesWhatIsNoFile) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "a.xml") << "<r/>";
  EXPECT_NO_THROW((void)XmlDocument::read(folder / "a.xml").root("r"));
  EXPECT_THROW((void)XmlDocument::read(folder.path()), InputError);
  EXPECT_THROW((void)XmlDocument::read(folder / "absent.xml"), InputError);
  EXPECT_THROW((void)XmlDocument::read("/dev/zero"), InputError);
}

TEST(XmlEscape, AnyBytesComeBackAsLegalXml) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> byte(0, 255);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string bytes(16, ' ');
    for (char& c : bytes) c = static_cast<char>(byte(random));
    EXPECT_NO_THROW((void)XmlDocument::parse("<r a=\"" + xml_escape(bytes) + "\">" + xml_escape(bytes) + "</r>", "x"));
  }
}

TEST(XmlEscape, LegalTextSurvivesTheRoundTrip) {
  const std::string text =
      "<Gr\xC3\xBC\xC3\x9F"
      "e> & \"quotes\" 'n\ttabs\nlines \xF0\x9F\x94\xA9";
  const auto document = XmlDocument::parse("<r a='" + xml_escape(text) + "'/>", "x");
  EXPECT_EQ(document.root("r").attribute("a"), text);
}

TEST(XmlEscape, ForbiddenBytesBecomeTheReplacementCharacter) {
  EXPECT_EQ(xml_escape(std::string_view("a\0b\x1Bz\xFF", 6)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBDz\xEF\xBF\xBD");
}

TEST(FormatDouble, ReadsBackBitForBitInTheShortestForm) {
  EXPECT_EQ(format_double(0.1), "0.1");
  EXPECT_EQ(format_double(1e23), "1e+23");
  EXPECT_EQ(format_double(-0.0), "-0");
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 20000; ++trial) {
    const std::uint64_t bits = random();
    double value = 0.0;
    static_assert(sizeof value == sizeof bits);
    std::memcpy(&value, &bits, sizeof value);
    if (!std::isfinite(value)) continue;
    EXPECT_EQ(std::strtod(format_double(value).c_str(), nullptr), value);
  }
}

TEST(FormatDouble, RefusesWhatIsNotFinite) {
  EXPECT_THROW((void)format_double(std::numeric_limits<double>::infinity()), GeometryError);
  EXPECT_THROW((void)format_double(std::numeric_limits<double>::quiet_NaN()), GeometryError);
}

TEST(Utf8, DecodesTheLengthsAndTheirLimits) {
  EXPECT_EQ(decode_utf8("\x7F", 0).value, 0x7FU);
  EXPECT_EQ(decode_utf8("\xC2\x80", 0).value, 0x80U);
  EXPECT_EQ(decode_utf8("\xE0\xA0\x80", 0).value, 0x800U);
  EXPECT_EQ(decode_utf8("\xF0\x90\x80\x80", 0).value, 0x10000U);
  EXPECT_EQ(decode_utf8("\xF4\x8F\xBF\xBF", 0).value, 0x10FFFFU);
  EXPECT_EQ(decode_utf8("\xE0\x9F\xBF", 0).length, 0U);
  EXPECT_EQ(decode_utf8("\xC2", 0).length, 0U);
  EXPECT_EQ(decode_utf8("a", 1).length, 0U);
}

}  // namespace
}  // namespace lamella
