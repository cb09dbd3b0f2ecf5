#include <chrono>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>

#include "core/error.h"
#include "export/xml_guard.h"
#include "export/xml_payload.h"
#include "export/xml_slices.h"
#include "export/xml_validate.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

std::string sample(const char* name) {
  std::ifstream stream(source_dir() / "schemas" / "valid" / "slices" / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// `text` with the first `from` replaced; the test fails when there is none.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

/// Peak memory of this process so far, bytes.
std::int64_t peak_memory() {
  std::ifstream stream("/proc/self/status");
  for (std::string word; stream >> word;) {
    std::int64_t kilobytes = 0;
    if (word == "VmHWM:" && stream >> kilobytes) return kilobytes * 1024;
  }
  return 0;
}

class XmlHostile : public ::testing::Test {
 protected:
  /// The message with which the reader refuses `text`; empty when it doesn't. The check must find a fault too unless
  /// the fault is of a kind that no schema sees.
  std::string refusal(const std::string& text, bool schema_sees_it = true) {
    std::ofstream(file_, std::ios::binary) << text;
    if (schema_sees_it) {
      EXPECT_THAT(validate_xml(file_).findings, Not(IsEmpty())) << text.substr(0, 100);
    }
    CollectingSink sink;
    try {
      read_xml_slices(file_, sink);
    } catch (const InputError& error) {
      EXPECT_FALSE(sink.finished);
      return std::string(error.what()) + " (" + error.where() + ")";
    }
    return {};
  }

  TemporaryFolder folder_;
  fs::path file_ = folder_ / "hostile.xml";
};

TEST_F(XmlHostile, DocumentTypesAreRefusedWithTheirLine) {
  const std::string bomb =
      "<?xml version=\"1.0\"?>\n<!-- <!DOCTYPE in a comment is nothing -->\n<!DOCTYPE slices [<!ENTITY a "
      "\"aaaa\"><!ENTITY b "
      "\"&a;&a;&a;&a;\"><!ENTITY c \"&b;&b;&b;&b;\">]>\n<slices>&c;</slices>";
  EXPECT_THAT(refusal(bomb), HasSubstr("document type declaration"));
  EXPECT_THAT(refusal(bomb), HasSubstr("hostile.xml:3)"));
  EXPECT_THAT(refusal("<!DOCTYPE slices SYSTEM \"http://127.0.0.1:1/x.dtd\"><slices/>"), HasSubstr("document type"));
  EXPECT_THAT(refusal("<!DOCTYPE s [<!ENTITY x SYSTEM \"file:///etc/passwd\">]><s>&x;</s>"),
              HasSubstr("document type"));
  EXPECT_THAT(refusal("<?p <!-- ?><!DOCTYPE s []><!-- ?> --><s/>"), HasSubstr("document type"));
}

TEST_F(XmlHostile, EntitiesWithoutDeclarationAreErrors) {
  EXPECT_THAT(refusal(replaced(sample("text.xml"), "<x>0 3</x>", "<x>&bomb;</x>")), Not(IsEmpty()));
}

TEST_F(XmlHostile, SchemaLocationsAreNeverFetched) {
  for (const char* attribute : {"xsi:schemaLocation=\"urn:x http://127.0.0.1:1/x.xsd\"",
                                "xsi:noNamespaceSchemaLocation = \"file:///etc/passwd\"", "q:schemaLocation='a b'"}) {
    const std::string text =
        replaced(sample("text.xml"), "<slices ",
                 std::string("<slices xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" xmlns:q=\"urn:q\" ") +
                     attribute + " ");
    EXPECT_THAT(refusal(text), HasSubstr("schema location")) << attribute;
  }
}

TEST_F(XmlHostile, OtherEncodingsAreRefused) {
  const std::string text = sample("text.xml");
  std::string utf16 = "\xFF\xFE";
  for (char c : text) utf16 += std::string{c, '\0'};
  EXPECT_THAT(refusal(utf16), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal(utf16.substr(2)), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal(replaced(text, "grip", "gr\xFFp")), Not(IsEmpty()));
  EXPECT_THAT(refusal("\xEF\xBB\xBF" + text, false), IsEmpty());  // a byte order mark is fine
}

TEST_F(XmlHostile, DeepNestingAndManyAttributesAreRefusedInTime) {
  const auto begin = std::chrono::steady_clock::now();
  std::string deep;
  for (int i = 0; i < 1000000; ++i) deep += "<a>";
  EXPECT_THAT(refusal(deep), HasSubstr("nested"));
  std::string wide = "<slices";
  for (int i = 0; i < 100000; ++i) wide += " a" + std::to_string(i) + "=\"\"";
  EXPECT_THAT(refusal(wide + "/>"), HasSubstr("attributes"));
  EXPECT_THAT(refusal("<slices version=\"" + std::string(std::size_t{3} << 20, 'x') + "\"/>"), HasSubstr("mebibyte"));
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST_F(XmlHostile, BlocksThatLieAboutTheirSizeAreRefused) {
  const std::string packed = sample("packed.xml");
  for (const auto& [from, to] : {std::pair{"bytes=\"16\"", "bytes=\"20\""},
                                 {"bytes=\"16\"", "bytes=\"524288\""},
                                 {"bytes=\"16\"", "bytes=\"17\""},
                                 {"stored=\"", "stored=\"9"},
                                 {"rows=\"4\" segments=\"4\"", "rows=\"4\" segments=\"3\""},
                                 {"rows=\"4\" segments=\"4\"", "rows=\"5\" segments=\"4\""},
                                 {"rows=\"4\" segments=\"4\"", "rows=\"1048576\" segments=\"33554432\""}}) {
    EXPECT_THAT(refusal(replaced(packed, from, to), false), Not(IsEmpty())) << to;
  }
}

TEST_F(XmlHostile, SegmentsThatContradictTheGridAreRefused) {
  const std::string text = sample("text.xml");
  for (const auto& [from, to] : {std::pair{"<x>0 3</x>", "<x>3 0</x>"},
                                 {"<x>0 3</x>", "<x>0</x>"},
                                 {"<x>0 3</x>", "<x>0 3 4 5</x>"},
                                 {"<x>0 3</x>", "<x>0 1e999</x>"},
                                 {"<material>0</material>", "<material>2</material>"},
                                 {"<solid>0</solid>", "<solid>2</solid>"},
                                 {"<row index=\"1\"", "<row index=\"4\""},
                                 {"<row index=\"2\"", "<row index=\"0\""},
                                 {"<layer index=\"1\"", "<layer index=\"0\""},
                                 {"<layer index=\"2\"", "<layer index=\"3\""},
                                 {"z_bottom=\"0\"", "z_bottom=\"0.01\""},
                                 {"<plan layers=\"3\"", "<plan layers=\"2\""},
                                 {"size=\"8 4 3\"", "size=\"8 5 3\""},
                                 {"size=\"8 4 3\"", "size=\"8 0 3\""},
                                 {"pitch=\"0.5 ", "pitch=\"-0.5 "},
                                 {"<material id=\"1\"", "<material id=\"2\""}}) {
    EXPECT_THAT(refusal(replaced(text, from, to), false), Not(IsEmpty())) << to;
  }
}

TEST_F(XmlHostile, ZlibBombsAreBoundedInMemoryAndTime) {
  // 1.6 GB of zeros in well under 10 MB of file: refused at the stated number of segments, block by block.
  const std::vector<std::uint32_t> zeros(kMaxBlockItems);
  const PackedBlock block = pack_block(std::span<const std::uint32_t>(zeros));
  const std::string element = "<block bytes=\"" + std::to_string(block.bytes) + "\" stored=\"" +
                              std::to_string(block.stored) + "\">" + block.text + "</block>";
  std::string text = sample("packed.xml");
  const auto begin = text.find("<block");
  text.resize(begin);
  for (int i = 0; i < 6000; ++i) text += element;
  const std::int64_t before = peak_memory();
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(refusal(text), HasSubstr("more numbers than stated"));
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  EXPECT_LT(peak_memory() - before, std::int64_t{200} << 20);
}

TEST_F(XmlHostile, ABlockThatInflatesBeyondItsStatedBytesIsRefused) {
  const std::vector<std::uint32_t> zeros(kMaxBlockItems);
  const PackedBlock block = pack_block(std::span<const std::uint32_t>(zeros));
  std::vector<std::uint32_t> out;
  EXPECT_THROW(unpack_block(16, block.stored, block.text, out), std::invalid_argument);
  EXPECT_THROW(unpack_block(block.bytes + 4, block.stored, block.text, out), std::invalid_argument);
  EXPECT_THROW(unpack_block(std::size_t{1} << 40, block.stored, block.text, out), std::invalid_argument);
  EXPECT_THROW(unpack_block(block.bytes, std::size_t{1} << 40, block.text, out), std::invalid_argument);
}

TEST_F(XmlHostile, ManyMaterialsValidateInTime) {
  std::string many;
  for (int i = 0; i < 20000; ++i) many += "<material id=\"" + std::to_string(i) + "\" name=\"m\" color=\"0 0 0\"/>";
  std::string text = sample("text.xml");
  const auto begin = text.find("<material ");
  text.replace(begin, text.find("</materials>") - begin, many);
  std::ofstream(file_, std::ios::binary) << text;
  const auto start = std::chrono::steady_clock::now();
  EXPECT_THAT(validate_xml(file_).findings, IsEmpty());
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
}

TEST(XmlValidate, ReportsLinesAndStopsAtAHundredFindings) {
  const TemporaryFolder folder;
  std::string text = "<slices xmlns=\"urn:lamella:slices:1\" version=\"1.0\">\n";
  for (int i = 0; i < 1000; ++i) text += "<wrong" + std::to_string(i) + "/>\n";
  std::ofstream(folder / "a.xml") << replaced(sample("text.xml"), "<x>0 3</x>", "<x>0 three</x>");
  const auto findings = validate_xml(folder / "a.xml").findings;
  ASSERT_GE(findings.size(), 1u);  // libxml2 reports the number and the list that it is in
  EXPECT_EQ(findings[0].line, 26);
  EXPECT_THAT(findings[0].what, HasSubstr("three"));
  std::ofstream(folder / "b.xml") << text << "</slices>";
  EXPECT_LE(validate_xml(folder / "b.xml").findings.size(), kMaxXmlFindings);
}

TEST(XmlValidate, NamesAnUnknownNamespace) {
  const TemporaryFolder folder;
  std::ofstream(folder / "a.xml") << "<other xmlns='urn:x'/>";
  const XmlValidation validation = validate_xml(folder / "a.xml");
  EXPECT_THAT(validation.schema, IsEmpty());
  ASSERT_EQ(validation.findings.size(), 1u);
  EXPECT_THAT(validation.findings[0].what, HasSubstr("urn:x"));
}

TEST(XmlValidate, ThrowsForFilesThatCanNotBeRead) {
  EXPECT_THROW(static_cast<void>(validate_xml("/no/such/file.xml")), InputError);
  EXPECT_THROW(static_cast<void>(validate_xml("/tmp")), InputError);
}

TEST(XmlValidate, KnowsEverySchemaOfTheTree) {
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(source_dir() / "schemas"))
    files += entry.path().extension() == ".xsd";
  ASSERT_EQ(embedded_schemas().size(), files);
  for (const XmlSchema& schema : embedded_schemas()) {
    std::ifstream stream(source_dir() / "schemas" / schema.file_name, std::ios::binary);
    EXPECT_EQ(schema.text, std::string(std::istreambuf_iterator<char>(stream), {})) << schema.file_name;
    EXPECT_THAT(std::string(schema.target_namespace()), ::testing::StartsWith("urn:lamella:"));
  }
}

}  // namespace
}  // namespace lamella::test
