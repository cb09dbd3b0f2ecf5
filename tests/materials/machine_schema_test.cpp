#include <cstdlib>
#include <gtest/gtest.h>

#include "core/error.h"
#include "materials/machine.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

bool schema_accepts(const fs::path& file) {
  const fs::path schema = test::source_dir() / "schemas/machine.xsd";
  const std::string command =
      "xmllint --nonet --noout --schema '" + schema.string() + "' '" + file.string() + "' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

bool reader_accepts(const fs::path& file) {
  try {
    (void)read_machine(file);
    return true;
  } catch (const InputError& error) {
    EXPECT_NE(error.where().find(file.filename().string()), std::string::npos) << error.what();
    EXPECT_FALSE(error.hint().empty()) << error.what();
    return false;
  }
}

std::vector<fs::path> files_of(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(test::source_dir() / folder)) files.push_back(entry.path());
  return files;
}

TEST(MachineSchema, SchemaAndReaderAcceptTheValidSamples) {
  const auto files = files_of("schemas/valid/machine");
  ASSERT_GE(files.size(), 4U);
  for (const fs::path& file : files) {
    EXPECT_TRUE(schema_accepts(file)) << file;
    EXPECT_TRUE(reader_accepts(file)) << file;
  }
}

TEST(MachineSchema, SchemaAndReaderRefuseTheInvalidSamples) {
  const auto files = files_of("schemas/invalid/machine");
  ASSERT_GE(files.size(), 40U);
  for (const fs::path& file : files) {
    EXPECT_FALSE(schema_accepts(file)) << file;
    EXPECT_FALSE(reader_accepts(file)) << file;
  }
}

TEST(MachineSchema, TheShippedMachinesAreValid) {
  const auto files = files_of("datasets/machines");
  ASSERT_GE(files.size(), 4U);
  for (const fs::path& file : files) {
    EXPECT_TRUE(schema_accepts(file)) << file;
    EXPECT_TRUE(reader_accepts(file)) << file;
  }
}

}  // namespace
}  // namespace lamella
