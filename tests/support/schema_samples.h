#pragma once

#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/support/paths.h"

/// The samples that every schema has, and what must be said of them.
namespace lamella::test {

/// The files of schemas/KIND/NAME; KIND is valid or invalid.
inline std::vector<std::filesystem::path> schema_samples(const std::string& kind, const std::string& name) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(source_dir() / "schemas" / kind / name)) {
    files.push_back(entry.path());
  }
  return files;
}

/// Whether xmllint, which isn't ours, finds a file valid by schemas/NAME.xsd.
inline bool schema_accepts(const std::string& name, const std::filesystem::path& file) {
  const std::filesystem::path schema = source_dir() / "schemas" / (name + ".xsd");
  const std::string command =
      "xmllint --nonet --noout --schema '" + schema.string() + "' '" + file.string() + "' >/dev/null 2>&1";
  return std::system(command.c_str()) == 0;
}

/// Whether `read` takes a file; an InputError must name it.
inline bool reader_accepts(const auto& read, const std::filesystem::path& file) {
  try {
    (void)read(file);
    return true;
  } catch (const InputError& error) {
    EXPECT_NE(error.where().find(file.filename().string()), std::string::npos) << error.what();
    return false;
  }
}

/// Schema and reader agree on all samples, of which there are at least so many.
inline void expect_samples_to_be_judged(const std::string& name, std::size_t valid, std::size_t invalid,
                                        const auto& read) {
  ASSERT_EQ(std::system("xmllint --version >/dev/null 2>&1"), 0) << "xmllint is missing";
  const auto good = schema_samples("valid", name);
  const auto bad = schema_samples("invalid", name);
  ASSERT_GE(good.size(), valid);
  ASSERT_GE(bad.size(), invalid);
  for (const auto& file : good) {
    EXPECT_TRUE(schema_accepts(name, file)) << file;
    EXPECT_TRUE(reader_accepts(read, file)) << file;
  }
  for (const auto& file : bad) {
    EXPECT_FALSE(schema_accepts(name, file)) << file;
    EXPECT_FALSE(reader_accepts(read, file)) << file;
  }
}

}  // namespace lamella::test
