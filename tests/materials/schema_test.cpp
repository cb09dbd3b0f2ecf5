#include <cstdlib>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/material_rules.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

bool schema_accepts(const fs::path& file) {
  const fs::path schema = test::source_dir() / "schemas/materials.xsd";
  const std::string command =
      "xmllint --nonet --noout --schema '" + schema.string() + "' '" + file.string() + "' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

bool reader_accepts(const fs::path& file) {
  try {
    (void)read_material_rules(file);
    return true;
  } catch (const InputError& error) {
    EXPECT_NE(error.where().find(file.filename().string()), std::string::npos) << error.what();
    return false;
  }
}

std::vector<fs::path> samples(const char* kind) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(test::source_dir() / "schemas" / kind / "materials")) {
    files.push_back(entry.path());
  }
  return files;
}

TEST(MaterialsSchema, XmllintIsThere) { ASSERT_EQ(std::system("xmllint --version >/dev/null 2>&1"), 0); }

TEST(MaterialsSchema, SchemaAndReaderAcceptTheValidSamples) {
  const auto files = samples("valid");
  ASSERT_GE(files.size(), 3U);
  for (const fs::path& file : files) {
    EXPECT_TRUE(schema_accepts(file)) << file;
    EXPECT_TRUE(reader_accepts(file)) << file;
  }
}

TEST(MaterialsSchema, SchemaAndReaderRefuseTheInvalidSamples) {
  const auto files = samples("invalid");
  ASSERT_GE(files.size(), 30U);
  for (const fs::path& file : files) {
    EXPECT_FALSE(schema_accepts(file)) << file;
    EXPECT_FALSE(reader_accepts(file)) << file;
  }
}

}  // namespace
}  // namespace lamella
