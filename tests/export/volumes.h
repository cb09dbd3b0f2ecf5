#pragma once

#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <sstream>

#include "export/mhd_file.h"
#include "export/nrrd_file.h"
#include "export/tiff_file.h"
#include "export/vti_file.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

/// Small builds, the formats that hold volumes of labels, and what other programs say about their files.
namespace lamella::test {

inline Grid small_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {0.04, 0.08, 0.027};
  grid.size = {53, 21, 6};
  return grid;
}

inline std::vector<std::string> names(std::size_t count) {
  std::vector<std::string> list{"steel", "r\u00FCbber & <clear> \\ glass"};
  while (list.size() < count) list.push_back("m" + std::to_string(list.size()));
  list.resize(count);
  return list;
}

inline std::vector<Layer> random_layers(const BuildInfo& info) {
  std::mt19937 random(41);
  std::vector<Layer> layers;
  for (std::size_t k = 0; k < info.plan.layers.size(); ++k) {
    layers.push_back(random_layer(info, static_cast<std::int64_t>(k), random));
  }
  return layers;
}

inline std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// What a program says about a volume: item -> the rest of its line.
struct Reading {
  std::map<std::string, std::string> items;
  std::vector<std::uint16_t> labels;  ///< x fastest

  [[nodiscard]] std::vector<double> numbers(const std::string& item) const {
    std::istringstream stream(items.count(item) > 0 ? items.at(item) : "");
    return {std::istream_iterator<double>(stream), {}};
  }
};

inline Reading read_with(const std::string& program, const std::filesystem::path& file) {
  const TemporaryFolder folder;
  const CommandResult result = run_command(program + " " + quoted(file) + " " + quoted(folder / "labels"));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  Reading reading;
  std::istringstream stream(result.output);
  for (std::string item, rest; stream >> item && std::getline(stream >> std::ws, rest);) reading.items[item] = rest;
  const std::string bytes = bytes_of(folder / "labels");
  reading.labels.resize(bytes.size() / 2);
  std::memcpy(reading.labels.data(), bytes.data(), 2 * reading.labels.size());
  return reading;
}

inline std::string python(const char* script) {
  return "/usr/bin/python3 " + quoted(source_dir() / "tests/export" / script);
}

/// The labels of slices, each of the layer that `layer_of` names, -1 for a void one.
inline std::vector<std::uint16_t> expected_labels(const BuildInfo& info, const std::vector<Layer>& layers,
                                                  const std::vector<int>& layer_of) {
  const Grid& grid = info.plan.grid;
  std::vector<std::uint16_t> labels;
  for (const int k : layer_of) {
    for (std::int64_t j = 0; j < grid.size[1]; ++j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) {
        const int label = k < 0 ? -1 : label_of(layers[static_cast<std::size_t>(k)], grid, i, j);
        labels.push_back(static_cast<std::uint16_t>(1 + label));
      }
    }
  }
  return labels;
}

struct VolumeFormat {
  const char* name;
  const char* file;
  std::unique_ptr<LayerSink> (*make)(const std::filesystem::path&, const VolumeOptions&);
  bool has_names;
  bool has_vtk_reader;
};

inline const std::vector<VolumeFormat> kFormats = {
    {"tiff", "a.tif",
     [](const std::filesystem::path& path, const VolumeOptions& options) {
       return make_tiff_sink(path, {.volume = options});
     },
     true, false},
    {"big tiff", "big.tif",
     [](const std::filesystem::path& path, const VolumeOptions& options) {
       return make_tiff_sink(path, {.volume = options, .big_from = 0});
     },
     true, false},
    {"nrrd", "a.seg.nrrd", make_nrrd_sink, true, true},
    {"mhd", "a.mhd", make_mhd_sink, true, true},
    {"vti", "a.vti", make_vti_sink, true, true},
};

inline void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], expected[n], 2e-9);
}

inline void expect_volume(const Reading& reading, const BuildInfo& info, bool has_names) {
  expect_near(reading.numbers("pitch"), {0.04, 0.08, 0.027});
  expect_near(reading.numbers("origin"), {-3.1, 20.0, 0.7});
  EXPECT_EQ(reading.items.at("type"), info.materials.size() > 255 ? "uint16" : "uint8");
  for (const MaterialId id : info.materials.ids()) {
    if (!has_names) break;
    std::string name = info.materials[id].name;
    const std::string key = "name" + std::to_string(1 + id.value());
    if (reading.items.count(key) == 0) FAIL() << key;
    std::string found = reading.items.at(key);
    if (const auto at = found.find("\\\\"); at != std::string::npos) found.erase(at, 1);  // as NRRD escapes it
    EXPECT_EQ(found, name);
  }
}

}  // namespace lamella::test
