#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

#include "core/error.h"
#include "export/xml_slices.h"
#include "export/xml_validate.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::IsEmpty;
using ::testing::Not;

std::vector<fs::path> samples(const char* kind) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(source_dir() / "schemas" / kind / "slices"))
    files.push_back(entry.path());
  return files;
}

int xmllint(const fs::path& file) {
  return run_command("xmllint --nonet --noout --stream --schema " + quoted(source_dir() / "schemas" / "slices.xsd") +
                     " " + quoted(file))
      .exit_code;
}

TEST(SlicesSchema, EveryValidSampleIsValidAndReads) {
  const auto files = samples("valid");
  ASSERT_GE(files.size(), 5u);
  for (const fs::path& file : files) {
    const XmlValidation validation = validate_xml(file);
    EXPECT_EQ(validation.schema, "slices.xsd") << file;
    EXPECT_THAT(validation.findings, IsEmpty()) << file;
    EXPECT_EQ(xmllint(file), 0) << file;
    CollectingSink sink;
    EXPECT_NO_THROW(read_xml_slices(file, sink)) << file;
    EXPECT_TRUE(sink.finished);
  }
}

TEST(SlicesSchema, EveryInvalidSampleIsFoundByTheSchemaAndRefusedByTheReader) {
  const auto files = samples("invalid");
  ASSERT_GE(files.size(), 25u);
  for (const fs::path& file : files) {
    EXPECT_THAT(validate_xml(file).findings, Not(IsEmpty())) << file;
    EXPECT_NE(xmllint(file), 0) << file;
    CollectingSink sink;
    EXPECT_THROW(read_xml_slices(file, sink), InputError) << file;
    EXPECT_FALSE(sink.finished);
  }
}

TEST(SlicesSchema, TheTextAndThePackedSampleHoldTheSameLayers) {
  CollectingSink text;
  CollectingSink packed;
  read_xml_slices(source_dir() / "schemas/valid/slices/text.xml", text);
  read_xml_slices(source_dir() / "schemas/valid/slices/packed.xml", packed);
  ASSERT_EQ(text.layers.size(), 3u);
  EXPECT_EQ(text.layers, packed.layers);
}

}  // namespace
}  // namespace lamella::test
