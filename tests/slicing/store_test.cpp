#include "slicing/store/store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>

#include "core/error.h"
#include "tests/slicing/store_sample.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;
using test::contents;
using test::make_sample;
using test::read_file;
using test::Sample;
using test::TemporaryFolder;
using test::write_file;
using test::write_sample;
using testing::HasSubstr;

void expect_same_info(const BuildInfo& a, const BuildInfo& b) {
  ASSERT_EQ(a.sources.size(), b.sources.size());
  EXPECT_EQ(a.sources[0].path, b.sources[0].path);
  EXPECT_EQ(a.sources[0].sha256, b.sources[0].sha256);
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (const MaterialId id : a.materials.ids()) {
    EXPECT_EQ(a.materials[id].name, b.materials[id].name);
    EXPECT_EQ(a.materials[id].density, b.materials[id].density);
    EXPECT_EQ(a.materials[id].color, b.materials[id].color);
  }
  ASSERT_EQ(a.solids.size(), b.solids.size());
  for (const SolidId id : a.solids.ids()) {
    EXPECT_EQ(a.solids[id].name, b.solids[id].name);
    EXPECT_EQ(a.solids[id].path, b.solids[id].path);
    EXPECT_EQ(a.solids[id].material, b.solids[id].material);
    EXPECT_EQ(a.solids[id].priority, b.solids[id].priority);
    EXPECT_EQ(a.solids[id].volume_exact, b.solids[id].volume_exact);
    EXPECT_EQ(a.solids[id].bounds.isEmpty(), b.solids[id].bounds.isEmpty());
    if (!a.solids[id].bounds.isEmpty()) {
      EXPECT_EQ(a.solids[id].bounds.max(), b.solids[id].bounds.max());
    }
  }
  EXPECT_EQ(a.policy, b.policy);
  EXPECT_EQ(a.plan.grid.origin, b.plan.grid.origin);
  EXPECT_EQ(a.plan.grid.pitch, b.plan.grid.pitch);
  EXPECT_EQ(a.plan.grid.size, b.plan.grid.size);
  ASSERT_EQ(a.plan.layers.size(), b.plan.layers.size());
  for (std::size_t k = 0; k < a.plan.layers.size(); ++k) {
    EXPECT_EQ(a.plan.layers[k].z_sample, b.plan.layers[k].z_sample);
    EXPECT_EQ(a.plan.layers[k].z_top, b.plan.layers[k].z_top);
  }
  ASSERT_EQ(a.plan.hatch.has_value(), b.plan.hatch.has_value());
  if (a.plan.hatch) {
    EXPECT_EQ(a.plan.hatch->rotation, b.plan.hatch->rotation);
  }
}

void expect_same_report(const SliceReport& a, const SliceReport& b) {
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.segments, b.segments);
  EXPECT_EQ(a.cast.hits, b.cast.hits);
  ASSERT_EQ(a.solids.size(), b.solids.size());
  for (const SolidId id : a.solids.ids()) {
    EXPECT_EQ(a.solids[id].volume_sliced, b.solids[id].volume_sliced);
    EXPECT_EQ(a.solids[id].volume_exact, b.solids[id].volume_exact);
    EXPECT_EQ(a.solids[id].quadrature_bound, b.solids[id].quadrature_bound);
    EXPECT_EQ(a.solids[id].left_out, b.solids[id].left_out);
    EXPECT_EQ(a.solids[id].status, b.solids[id].status);
  }
  EXPECT_EQ(a.materials[MaterialId{0}].volume, b.materials[MaterialId{0}].volume);
  EXPECT_EQ(a.materials[MaterialId{0}].mass, b.materials[MaterialId{0}].mass);
  ASSERT_EQ(a.overlaps.size(), b.overlaps.size());
  EXPECT_EQ(a.overlaps[0].second, b.overlaps[0].second);
  EXPECT_EQ(a.overlaps[0].volume, b.overlaps[0].volume);
  EXPECT_EQ(a.overlaps[0].largest_depth, b.overlaps[0].largest_depth);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  ASSERT_EQ(a.interfaces.size(), b.interfaces.size());
  EXPECT_EQ(a.interfaces[0].area, b.interfaces[0].area);
  EXPECT_EQ(a.interfaces[0].second, b.interfaces[0].second);
  ASSERT_EQ(a.open_gaps.size(), b.open_gaps.size());
  EXPECT_EQ(a.open_gaps[0].volume, b.open_gaps[0].volume);
  EXPECT_EQ(a.open_gaps[0].least_gap, b.open_gaps[0].least_gap);
  EXPECT_EQ(a.open_gaps[0].largest_gap, b.open_gaps[0].largest_gap);
  EXPECT_EQ(a.open_gaps[0].layers, b.open_gaps[0].layers);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  EXPECT_EQ(a.findings[0].severity, b.findings[0].severity);
  EXPECT_EQ(a.findings[0].what, b.findings[0].what);
  EXPECT_EQ(a.findings[0].hint, b.findings[0].hint);
}

class RoundTrip : public testing::TestWithParam<std::tuple<bool, std::uint32_t, int>> {};

TEST_P(RoundTrip, GivesEveryLayerBackBitForBit) {
  const auto [hatch, per_shard, compression] = GetParam();
  const TemporaryFolder folder;
  const Sample sample = make_sample(5, hatch);
  write_sample(sample, folder / "build", {per_shard, compression});
  const StoreReader reader(folder / "build");
  expect_same_info(reader.info(), sample.info);
  expect_same_report(reader.report(), sample.report);
  for (std::uint32_t k : {4u, 0u, 1u, 2u, 3u}) EXPECT_EQ(reader.read_layer(k), sample.layers[k]) << "layer " << k;
  EXPECT_THROW((void)reader.read_layer(5), UsageError);
}

INSTANTIATE_TEST_SUITE_P(Layouts, RoundTrip,
                         testing::Values(std::tuple(true, 2u, 4), std::tuple(false, 1u, 9), std::tuple(true, 64u, 0),
                                         std::tuple(false, 5u, 1)));

TEST(Store, KeepsLayersOfManyChunksAndOfNoSegments) {
  const TemporaryFolder folder;
  Sample sample = make_sample(2, false);
  SegmentRows& rows = sample.layers[1].raster;
  rows = {};
  for (int r = 0; r < 60; ++r) rows.row_start.push_back(0);
  rows.segments.clear();
  SegmentRows& many = sample.layers[0].raster;
  many = {};
  for (int r = 0; r < 60; ++r) {
    for (int i = 0; i < 5000; ++i) many.segments.push_back({i + 0.1 * r, i + 0.1 * r + 0.5, MaterialId{1}, SolidId{2}});
    many.row_start.push_back(many.segments.size());
  }
  write_sample(sample, folder / "build");
  const StoreReader reader(folder / "build");
  EXPECT_EQ(reader.read_layer(0), sample.layers[0]);
  EXPECT_EQ(reader.read_layer(1), sample.layers[1]);
}

TEST(Store, ReplaysARangeOfLayers) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(5);
  write_sample(sample, folder / "build");
  const StoreReader reader(folder / "build");
  test::CollectingSink sink;
  reader.replay(sink, {1, 4});
  EXPECT_EQ(sink.info.given.first, 1U);
  EXPECT_EQ(sink.info.given.last, 4U);
  EXPECT_EQ(sink.layers, std::vector<Layer>(sample.layers.begin() + 1, sample.layers.begin() + 4));
  EXPECT_TRUE(sink.finished);
  EXPECT_THROW(reader.replay(sink, {5, 9}), UsageError);
  EXPECT_THROW(reader.replay(sink, {3, 3}), UsageError);
}

TEST(Store, WritesTheSameBytesAgain) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(7);
  write_sample(sample, folder / "a");
  write_sample(make_sample(3, true, 99), folder / "other");
  write_sample(sample, folder / "b");
  EXPECT_EQ(contents(folder / "a"), contents(folder / "b"));
  EXPECT_EQ(contents(folder / "a").size(), 4u + 2u) << "four shards, layers.h5 and build.xml";
}

TEST(Store, WritesTheSameBytesHoweverLayersArePrepared) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(7);
  write_sample(sample, folder / "one", {.layers_per_shard = 3});
  TeeSink sink;
  sink.add(make_store_sink(folder / "two", {.layers_per_shard = 3}));
  sink.add(make_store_sink(folder / "three", {.layers_per_shard = 3}));
  sink.begin(sample.info);
  std::vector<std::function<void()>> rests(sample.layers.size());
  for (std::size_t i = rests.size(); i-- > 0;) rests[i] = sink.prepare(sample.layers[i]);
  for (const auto& rest : rests) rest();
  sink.finish(sample.report);
  EXPECT_EQ(contents(folder / "two"), contents(folder / "one"));
  EXPECT_EQ(contents(folder / "three"), contents(folder / "one"));
}

TEST(Store, WritesABuildXmlThatItsSchemaAccepts) {
  const TemporaryFolder folder;
  write_sample(make_sample(), folder / "build");
  const std::string command = "xmllint --nonet --noout --schema '" +
                              (test::source_dir() / "schemas/build.xsd").string() + "' '" +
                              (folder / "build").string() + "/build.xml' > /dev/null 2>&1";
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(Store, RecordsHowTheAssemblyWasTurned) {
  const TemporaryFolder folder;
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  Sample sample = make_sample();
  sample.info.turn = turn;
  write_sample(sample, folder / "turned");
  write_sample(make_sample(), folder / "plain");
  ASSERT_TRUE(StoreReader(folder / "turned").info().turn.has_value());
  EXPECT_EQ(*StoreReader(folder / "turned").info().turn, turn);
  EXPECT_FALSE(StoreReader(folder / "plain").info().turn.has_value());
  std::string text = read_file(folder / "turned/build.xml");
  const std::size_t at = text.find(" xx=\"") + 5;
  text.replace(at, text.find('"', at) - at, "0.5");
  write_file(folder / "turned/build.xml", text);
  EXPECT_THROW((void)StoreReader(folder / "turned"), InputError) << "no rotation";
}

TEST(Store, RefusesAFolderThatHoldsSomethingElse) {
  const TemporaryFolder folder;
  write_file(folder / "photos/layers/000001.h5", "mine");
  const auto sink = make_store_sink(folder / "photos");
  EXPECT_THROW(sink->begin(make_sample().info), UsageError);
  sink->abandon();
  EXPECT_EQ(contents(folder / "photos").size(), 1u);
  write_file(folder / "file", "mine");
  EXPECT_THROW(make_store_sink(folder / "file")->begin(make_sample().info), ExportError);
  EXPECT_THROW(make_store_sink(folder / "file/below")->begin(make_sample().info), ExportError);
  EXPECT_EQ(read_file(folder / "file"), "mine");
}

TEST(Store, ReplacesAnOldBuildAndLeavesOtherFilesInItsFolder) {
  const TemporaryFolder folder;
  write_sample(make_sample(9), folder / "build");
  write_file(folder / "build/notes.txt", "mine");
  write_file(folder / "build/layers/notes.txt", "mine");
  write_file(folder / "build/layers/000044.h5.part-1-2", "left by a killed run");
  const Sample sample = make_sample(2);
  write_sample(sample, folder / "build");
  const auto files = contents(folder / "build");
  EXPECT_EQ(files.size(), 5u) << "one shard, layers.h5, build.xml and two notes";
  EXPECT_TRUE(files.contains("notes.txt") && files.contains("layers/notes.txt"));
  EXPECT_EQ(StoreReader(folder / "build").read_layer(1), sample.layers[1]);
}

TEST(Store, LeavesAnInterruptedBuildRecognisable) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(5);
  {
    const auto sink = make_store_sink(folder / "build", {2, 4});
    sink->begin(sample.info);
    for (int k = 0; k < 3; ++k) sink->write(sample.layers[static_cast<std::size_t>(k)]);
  }
  std::vector<std::string> names;
  for (const auto& [name, bytes] : contents(folder / "build")) names.push_back(name);
  EXPECT_EQ(names, (std::vector<std::string>{"layers/000000.h5", "unfinished.xml"}));
  try {
    const StoreReader reader(folder / "build");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("unfinished"));
  }
  write_sample(sample, folder / "build");
  EXPECT_EQ(StoreReader(folder / "build").read_layer(4), sample.layers[4]);
}

TEST(Store, RemovesEverythingWhenAbandoned) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(5);
  const auto sink = make_store_sink(folder / "build", {2, 4});
  sink->begin(sample.info);
  for (int k = 0; k < 3; ++k) sink->write(sample.layers[static_cast<std::size_t>(k)]);
  sink->abandon();
  EXPECT_FALSE(fs::exists(folder / "build"));
}

TEST(Store, RefusesToFinishABuildThatLacksLayers) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(5);
  const auto sink = make_store_sink(folder / "build");
  sink->begin(sample.info);
  sink->write(sample.layers[0]);
  EXPECT_THROW(sink->write(sample.layers[2]), ExportError) << "out of order";
  EXPECT_THROW(sink->finish(sample.report), ExportError);
  EXPECT_FALSE(fs::exists(folder / "build/build.xml"));
}

TEST(Store, SaysSoWhenTheDiskIsFullAndLeavesNoHalfFile) {
  const TemporaryFolder folder;
  const Sample sample = make_sample(8);
  const auto sink = make_store_sink(folder / "build", {8, 0});
  sink->begin(sample.info);
  // A limit on the size of files stands for a full disk.
  rlimit old{};
  getrlimit(RLIMIT_FSIZE, &old);
  const auto old_handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small{4096, old.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string path;
  try {
    for (const Layer& layer : sample.layers) sink->write(layer);
  } catch (const ExportError& error) {
    path = error.where();
  }
  setrlimit(RLIMIT_FSIZE, &old);
  signal(SIGXFSZ, old_handler);
  EXPECT_THAT(path, HasSubstr("000000.h5"));
  EXPECT_EQ(contents(folder / "build").size(), 1u) << "only unfinished.xml";
}

TEST(Store, RefusesOptionsOutOfRange) {
  EXPECT_THROW((void)make_store_sink("x", {0, 4}), UsageError);
  EXPECT_THROW((void)make_store_sink("x", {64, 10}), UsageError);
  EXPECT_THROW((void)make_store_sink("x", {64, -1}), UsageError);
}

}  // namespace
}  // namespace lamella
