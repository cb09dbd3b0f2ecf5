#include <csignal>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/error.h"
#include "tests/export/volumes.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;

TEST(Volumes, EveryVoxelHasTheMaterialOfTheSegmentAtItsCentre) {
  for (const std::size_t materials : {2U, 255U, 256U}) {
    const BuildInfo info = make_build(small_grid(), names(materials));
    const auto layers = random_layers(info);
    const auto expected = expected_labels(info, layers, {0, 1, 2, 3, 4, 5});
    for (const VolumeFormat& format : kFormats) {
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

TEST(Volumes, OtherProgramsReadHowTheAssemblyWasTurned) {
  BuildInfo info = make_build(small_grid(), names(2));
  const auto layers = random_layers(info);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (const VolumeFormat& format : kFormats) {
    SCOPED_TRACE(format.name);
    const TemporaryFolder folder;
    info.turn = turn;
    feed(*format.make(folder / format.file, {}), info, layers);
    const Reading turned = read_with(python("read_volume.py"), folder / format.file);
    ASSERT_EQ(turned.labels, expected_labels(info, layers, {0, 1, 2, 3, 4, 5}));
    info.turn.reset();
    feed(*format.make(folder / format.file, {}), info, layers);
    EXPECT_TRUE(read_with(python("read_volume.py"), folder / format.file).numbers("rotation").empty());
    const std::vector<double> rows = turned.numbers("rotation");
    ASSERT_EQ(rows.size(), 9U);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(rows[static_cast<std::size_t>(i)], turn(i / 3, i % 3)) << i;
  }
}

TEST(Volumes, ARangeOfLayersIsAVolumeOfItsOwn) {
  const BuildInfo info = make_build(small_grid(), names(2));
  const auto layers = random_layers(info);
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
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
  for (const VolumeFormat& format : kFormats) {
    fs::create_directory(folder / format.file);
    EXPECT_THROW(format.make(folder / format.file, {})->begin(info), ExportError) << format.name;
    EXPECT_THROW(format.make(folder / "other.mhd", {})->begin(large), UsageError) << format.name;
  }
}

TEST(Volumes, AMetaImageHasNoControlCharacterInItsName) {
  const TemporaryFolder folder;
  for (const char* name : {"a\nb.mhd", "a\rb.mhd", "a\tb.mhd", "a\x7F.mhd", "\n.mhd"}) {
    EXPECT_THROW(static_cast<void>(make_mhd_sink(folder / name)), UsageError) << name;
    EXPECT_THROW(static_cast<void>(make_mhd_sink(folder / name, {.is_raw = true})), UsageError) << name;
  }
  EXPECT_NO_THROW(static_cast<void>(make_mhd_sink(folder / "line\nend" / "Geh\u00E4use b.mhd")));  // isn't told
}

}  // namespace
}  // namespace lamella::test
