#include <csignal>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <sstream>
#include <sys/resource.h>

#include "core/error.h"
#include "export/mhd_file.h"
#include "export/nrrd_file.h"
#include "export/tiff_file.h"
#include "export/vti_file.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;

Grid small_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {0.04, 0.08, 0.027};
  grid.size = {53, 21, 6};
  return grid;
}

std::vector<std::string> names(std::size_t count) {
  std::vector<std::string> list{"steel", "r\u00FCbber & <clear> \\ glass"};
  while (list.size() < count) list.push_back("m" + std::to_string(list.size()));
  list.resize(count);
  return list;
}

std::vector<Layer> random_layers(const BuildInfo& info) {
  std::mt19937 random(41);
  std::vector<Layer> layers;
  for (std::size_t k = 0; k < info.plan.layers.size(); ++k) {
    layers.push_back(random_layer(info, static_cast<std::int64_t>(k), random));
  }
  return layers;
}

std::string bytes_of(const fs::path& file) {
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

Reading read_with(const std::string& program, const fs::path& file) {
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

std::string python(const char* script) { return "/usr/bin/python3 " + quoted(source_dir() / "tests/export" / script); }

/// The labels of slices, each of the layer that `layer_of` names, -1 for a void one.
std::vector<std::uint16_t> expected_labels(const BuildInfo& info, const std::vector<Layer>& layers,
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

struct Format {
  const char* name;
  const char* file;
  std::unique_ptr<LayerSink> (*make)(const fs::path&, const VolumeOptions&);
  bool has_names;
  bool has_vtk_reader;
};

const std::vector<Format> kFormats = {
    {"tiff", "a.tif",
     [](const fs::path& path, const VolumeOptions& options) { return make_tiff_sink(path, {.volume = options}); }, true,
     false},
    {"big tiff", "big.tif",
     [](const fs::path& path, const VolumeOptions& options) {
       return make_tiff_sink(path, {.volume = options, .big_from = 0});
     },
     true, false},
    {"nrrd", "a.seg.nrrd", make_nrrd_sink, true, true},
    {"mhd", "a.mhd", make_mhd_sink, false, true},
    {"vti", "a.vti", make_vti_sink, true, true},
};

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], expected[n], 2e-9);
}

void expect_volume(const Reading& reading, const BuildInfo& info, bool has_names) {
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

TEST(Volumes, EveryVoxelHasTheMaterialOfTheSegmentAtItsCentre) {
  for (const std::size_t materials : {2U, 255U, 256U}) {
    const BuildInfo info = make_build(small_grid(), names(materials));
    const auto layers = random_layers(info);
    const auto expected = expected_labels(info, layers, {0, 1, 2, 3, 4, 5});
    for (const Format& format : kFormats) {
      for (const bool raw : {false, true}) {
        const TemporaryFolder folder;
        feed(*format.make(folder / format.file, {.is_raw = raw}), info, layers);
        const Reading reading = read_with(python("read_volume.py"), folder / format.file);
        SCOPED_TRACE(std::string(format.name) + (raw ? ", raw" : ""));
        expect_volume(reading, info, format.has_names);
        ASSERT_EQ(reading.labels, expected);
      }
    }
  }
}

TEST(VolumesForeign, VtkReadsTheSame) {
  if (run_command("pvpython --version").exit_code != 0) GTEST_SKIP() << "no pvpython (package paraview)";
  const std::string program =
      "pvpython --force-offscreen-rendering " + quoted(source_dir() / "tests/export/read_volume_paraview.py");
  for (const std::size_t materials : {2U, 256U}) {
    const BuildInfo info = make_build(small_grid(), names(materials));
    const auto layers = random_layers(info);
    for (const Format& format : kFormats) {
      for (const bool raw : {false, true}) {
        if (!format.has_vtk_reader) continue;
        const TemporaryFolder folder;
        feed(*format.make(folder / format.file, {.is_raw = raw}), info, layers);
        const Reading reading = read_with(program, folder / format.file);
        SCOPED_TRACE(std::string(format.name) + (raw ? ", raw" : ""));
        expect_volume(reading, info, std::string(format.name) == "vti");
        ASSERT_EQ(reading.labels, expected_labels(info, layers, {0, 1, 2, 3, 4, 5}));
      }
    }
  }
}

TEST(Volumes, ARangeOfLayersIsAVolumeOfItsOwn) {
  const BuildInfo info = make_build(small_grid(), names(2));
  const auto layers = random_layers(info);
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    feed(*format.make(folder / format.file, {}), info, {layers[2], layers[3]});
    const Reading reading = read_with(python("read_volume.py"), folder / format.file);
    SCOPED_TRACE(format.name);
    EXPECT_EQ(reading.labels, expected_labels(info, layers, {2, 3}));
    expect_near(reading.numbers("origin"), {-3.1, 20.0, 0.7 + 2 * 0.027});
  }
}

/// Layers of 0.1, 0.1, 0.2, 0.05 and 0.15 mm.
BuildInfo adaptive_build() {
  Grid grid = small_grid();
  grid.size[2] = 5;
  BuildInfo info = make_build(grid, names(2));
  double z = grid.origin.z();
  const double thickness[] = {0.1, 0.1, 0.2, 0.05, 0.15};
  for (std::size_t k = 0; k < 5; ++k) {
    const double top = z + thickness[k];
    info.plan.layers[k] = {z, 0.5 * (z + top), top};
    z = top;
  }
  return info;
}

TEST(Volumes, LayersOfDifferentThicknessAreRepeatedAsSlicesOfTheirCommonMeasure) {
  const BuildInfo info = adaptive_build();
  const auto layers = random_layers(info);
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    feed(*format.make(folder / format.file, {}), info, layers);
    const Reading reading = read_with(python("read_volume.py"), folder / format.file);
    SCOPED_TRACE(format.name);
    expect_near(reading.numbers("pitch"), {0.04, 0.08, 0.05});
    EXPECT_EQ(reading.labels, expected_labels(info, layers, {0, 0, 1, 1, 2, 2, 2, 2, 3, 4, 4, 4}));
  }
}

TEST(Volumes, AGivenThicknessTakesTheLayerAtTheMiddleOfEachSlice) {
  const BuildInfo info = adaptive_build();
  const auto layers = random_layers(info);
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    feed(*format.make(folder / format.file, {.z_pitch = 0.17}), info, layers);
    const Reading reading = read_with(python("read_volume.py"), folder / format.file);
    SCOPED_TRACE(format.name);
    expect_near(reading.numbers("pitch"), {0.04, 0.08, 0.17});
    // Middles at 0.085, 0.255, 0.425, 0.595; borders at 0.1, 0.2, 0.4, 0.45, 0.6.
    EXPECT_EQ(reading.labels, expected_labels(info, layers, {0, 2, 3, 4}));
  }
  const TemporaryFolder folder;
  feed(*make_nrrd_sink(folder / "a.nrrd", {.z_pitch = 0.45}), info, layers);
  // The second slice overhangs: its middle lies above all layers.
  EXPECT_EQ(read_with(python("read_volume.py"), folder / "a.nrrd").labels, expected_labels(info, layers, {2, -1}));
}

TEST(Volumes, LayersWithoutACommonMeasureAreRefusedWithAHint) {
  BuildInfo info = adaptive_build();
  info.plan.layers[4].z_top += 0.001234567;
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    try {
      format.make(folder / format.file, {})->begin(info);
      FAIL() << format.name;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.hint(), ::testing::HasSubstr("--z-pitch"));
    }
    EXPECT_TRUE(fs::is_empty(folder.path())) << format.name;
  }
}

TEST(Volumes, TheSameLayersGiveTheSameBytesAndAnEmptyBuildIsReadable) {
  const BuildInfo info = make_build(small_grid(), names(2));
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "b");
    feed(*format.make(folder / format.file, {}), info, random_layers(info));
    feed(*format.make(folder / "b" / format.file, {}), info, random_layers(info));
    EXPECT_EQ(bytes_of(folder / format.file), bytes_of(folder / "b" / format.file)) << format.name;
    feed(*format.make(folder / format.file, {}), info, {});
    const Reading reading = read_with(python("read_volume.py"), folder / format.file);
    EXPECT_EQ(reading.labels, std::vector<std::uint16_t>(53 * 21)) << format.name;
  }
}

TEST(Volumes, AKilledRunOrAFullDiskLeavesNothing) {
  const BuildInfo info = make_build(small_grid(), names(2));
  const auto layers = random_layers(info);
  for (const Format& format : kFormats) {
    const TemporaryFolder folder;
    {
      const auto sink = format.make(folder / format.file, {});
      sink->begin(info);
      sink->write(layers[0]);
    }
    EXPECT_TRUE(fs::is_empty(folder.path())) << format.name;
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit tight{1000, old.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &tight);
    EXPECT_THROW(feed(*format.make(folder / format.file, {.is_raw = true}), info, layers), ExportError);
    ::setrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, handler);
    EXPECT_TRUE(fs::is_empty(folder.path())) << format.name;
  }
}

TEST(Volumes, RefusesTargetsThatAreNotPlainFilesAndSlicesThatAreTooLarge) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), names(2));
  BuildInfo large = info;
  large.plan.grid.size = {2147483647, 2147483647, 6};
  for (const Format& format : kFormats) {
    fs::create_directory(folder / format.file);
    EXPECT_THROW(format.make(folder / format.file, {})->begin(info), ExportError) << format.name;
    EXPECT_THROW(format.make(folder / "other.mhd", {})->begin(large), UsageError) << format.name;
  }
}

}  // namespace
}  // namespace lamella::test
