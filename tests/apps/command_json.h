#pragma once

#include <fstream>
#include <gtest/gtest.h>
#include <initializer_list>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/command.h"

namespace lamella::test {

using Json = nlohmann::json;

/// The one object that stdout holds; a failed parse fails the test.
inline Json parse_output(const CommandResult& result) {
  Json object = Json::parse(result.output, nullptr, false);
  EXPECT_FALSE(object.is_discarded()) << "stdout: " << result.output << "\nstderr: " << result.errors;
  return object;
}

/// Every documented key is there; more may be.
inline void expect_keys(const Json& object, std::initializer_list<const char*> keys) {
  ASSERT_TRUE(object.is_object()) << object;
  for (const char* key : keys)
    EXPECT_TRUE(object.contains(key)) << key << " is missing in " << object.dump().substr(0, 400);
}

/// A shipped assembly of a few boxes: fast to slice.
inline std::string boxes() { return quoted(datasets_dir() / "touching_boxes/touching_boxes.step"); }
inline std::string spheres() { return quoted(datasets_dir() / "nested_spheres/nested_spheres.step"); }

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Writes the boxes without one face of their first part, or of every part; returns the quoted path.
inline std::string write_open_boxes(const std::filesystem::path& path, bool every_part) {
  std::string text = contents(datasets_dir() / "touching_boxes/touching_boxes.step");
  std::size_t cut = 0;
  for (std::size_t at = text.find("CLOSED_SHELL("); at != std::string::npos; at = text.find("CLOSED_SHELL(", at + 1)) {
    const std::size_t end = text.find("))", at);
    const std::size_t comma = text.rfind(',', end);
    text.erase(comma, end - comma);
    ++cut;
    if (!every_part) break;
  }
  EXPECT_GE(cut, 1U);
  write_text(path, text);
  return quoted(path);
}

/// The solids with a status, "ok" or "open" say.
inline std::vector<Json> solids_with_status(const Json& report, const std::string& status) {
  std::vector<Json> solids;
  for (const Json& solid : report["solids"]) {
    if (solid["status"] == status) solids.push_back(solid);
  }
  return solids;
}

/// The names of all files below a folder.
inline std::vector<std::string> files_below(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  if (!std::filesystem::exists(folder)) return names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(std::filesystem::relative(entry.path(), folder).string());
  }
  return names;
}

/// What all files below a folder hold, by their names.
inline std::map<std::string, std::string> contents_below(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : files_below(folder)) files[name] = contents(folder / name);
  return files;
}

}  // namespace lamella::test
