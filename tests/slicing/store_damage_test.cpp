/// What the reader makes of builds that are damaged, hostile or none, and what foreign readers make of ours.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "core/error.h"
#include "slicing/store/store.h"
#include "tests/slicing/store_sample.h"
#include "tests/support/layers.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;
using test::make_sample;
using test::read_file;
using test::Sample;
using test::TemporaryFolder;
using test::write_file;
using test::write_sample;
using testing::HasSubstr;

TEST(StoreReader, RefusesWhatIsNoBuild) {
  const TemporaryFolder folder;
  EXPECT_THROW(StoreReader(folder / "absent"), InputError);
  EXPECT_THROW(StoreReader(folder.path()), InputError);
  for (const char* sample : {"valid/build/unfinished.xml", "valid/materials"}) {
    const fs::path from = test::source_dir() / "schemas" / sample;
    if (!fs::is_regular_file(from)) continue;
    write_file(folder / "build/build.xml", read_file(from));
    EXPECT_THROW(StoreReader(folder / "build"), InputError) << sample;
  }
}

TEST(StoreReader, ReadsTheValidSampleAndRefusesEveryInvalidOne) {
  const TemporaryFolder folder;
  const fs::path schemas = test::source_dir() / "schemas";
  write_file(folder / "build/build.xml", read_file(schemas / "valid/build/two_materials.xml"));
  EXPECT_EQ(StoreReader(folder / "build").info().materials.size(), 2u);
  int count = 0;
  for (const auto& entry : fs::directory_iterator(schemas / "invalid/build")) {
    write_file(folder / "build/build.xml", read_file(entry.path()));
    EXPECT_THROW(StoreReader(folder / "build"), InputError) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 20);
}

TEST(BuildSchema, AcceptsTheValidSamplesAndRefusesTheInvalidOnes) {
  const fs::path schemas = test::source_dir() / "schemas";
  for (const std::string kind : {"valid", "invalid"}) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(schemas / kind / "build")) {
      const std::string command = "xmllint --nonet --noout --schema '" + (schemas / "build.xsd").string() + "' '" +
                                  entry.path().string() + "' > /dev/null 2>&1";
      EXPECT_EQ(std::system(command.c_str()) == 0, kind == "valid") << entry.path();
      ++count;
    }
    EXPECT_GE(count, 2);
  }
}

TEST(StoreReader, NoticesEveryFlippedByteOfAShard) {
  const TemporaryFolder folder;
  write_sample(make_sample(2), folder / "build");
  const fs::path shard = folder / "build/layers/000000.h5";
  const std::string whole = read_file(shard);
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 37) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    write_file(shard, damaged);
    EXPECT_THROW((void)StoreReader(folder / "build").read_layer(0), InputError) << at;
  }
  write_file(shard, whole.substr(0, whole.size() / 2));
  EXPECT_THROW((void)StoreReader(folder / "build").read_layer(0), InputError);
  fs::remove(shard);
  EXPECT_THROW((void)StoreReader(folder / "build").read_layer(0), InputError);
}

TEST(StoreReader, SurvivesEveryTruncationOfBuildXml) {
  const TemporaryFolder folder;
  write_sample(make_sample(2), folder / "build");
  const std::string whole = read_file(folder / "build/build.xml");
  for (std::size_t size = 0; size + 2 < whole.size(); size += 41) {
    write_file(folder / "build/build.xml", whole.substr(0, size));
    EXPECT_THROW(StoreReader(folder / "build"), InputError) << size;
  }
}

/// Runs a script of this folder with Debian's Python, which has h5py; its output goes to `log`.
int run_python(const std::string& script, const std::string& arguments, const fs::path& log) {
  const fs::path path = test::source_dir() / "tests/slicing" / script;
  const std::string command =
      "/usr/bin/python3 '" + path.string() + "' " + arguments + " > '" + log.string() + "' 2>&1";
  return std::system(command.c_str());
}

bool has_h5py() { return std::system("/usr/bin/python3 -c 'import h5py' > /dev/null 2>&1") == 0; }

/// Raw little-endian bytes of a layer's arrays, in the order in which read_store.py writes them.
std::string raw_arrays(const SegmentRows& rows) {
  std::ostringstream out;
  const auto put = [&](const auto value) { out.write(reinterpret_cast<const char*>(&value), sizeof(value)); };
  for (const auto start : rows.row_start) put(start);
  for (const Segment& segment : rows.segments) put(segment.x_begin);
  for (const Segment& segment : rows.segments) put(segment.x_end);
  for (const Segment& segment : rows.segments) put(segment.material.value());
  for (const Segment& segment : rows.segments) put(segment.solid.value());
  return out.str();
}

TEST(Store, IsReadByH5pyThroughTheLinksOfLayersH5) {
  ASSERT_TRUE(has_h5py()) << "python3-h5py is missing: scripts/test installs it";
  const TemporaryFolder folder;
  const Sample sample = make_sample(5);
  write_sample(sample, folder / "build");
  const std::string arguments = "'" + (folder / "build").string() + "' '" + (folder / "raw").string() + "'";
  ASSERT_EQ(run_python("read_store.py", arguments, folder / "log"), 0) << read_file(folder / "log");
  std::string expected;
  for (const Layer& layer : sample.layers) expected += raw_arrays(layer.raster) + raw_arrays(layer.hatch->rows);
  EXPECT_EQ(read_file(folder / "raw"), expected);
}

class HostileShard : public testing::TestWithParam<const char*> {};

/// The script changes one thing in a shard and then mends the checksums of build.xml, so that only the check of that
/// one thing can refuse it.
TEST_P(HostileShard, IsRefused) {
  ASSERT_TRUE(has_h5py()) << "python3-h5py is missing: scripts/test installs it";
  const TemporaryFolder folder;
  write_sample(make_sample(2), folder / "build");
  const std::string arguments = "'" + (folder / "build").string() + "' " + GetParam();
  ASSERT_EQ(run_python("damage_store.py", arguments, folder / "log"), 0) << read_file(folder / "log");
  const StoreReader reader(folder / "build");
  if (std::string(GetParam()) == "nothing") {
    EXPECT_EQ(reader.read_layer(0), make_sample(2).layers[0]) << "the script computes checksums as documented";
    return;
  }
  try {
    (void)reader.read_layer(0);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.where(), HasSubstr("000000.h5"));
    EXPECT_THAT(error.what(), testing::Not(HasSubstr("checksum"))) << "the wrong guard stopped it";
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, HostileShard,
                         testing::Values("nothing", "nan", "infinite", "reversed", "overlapping", "row_start_falls",
                                         "row_start_ends_elsewhere", "material_out_of_range", "solid_out_of_range",
                                         "wrong_length", "wrong_type", "two_dimensions", "huge_array",
                                         "soft_link_cycle", "external_link", "virtual_array", "external_data",
                                         "missing_array", "group_for_array", "huge_chunk", "garbage"),
                         [](const auto& tested) { return std::string(tested.param); });

}  // namespace
}  // namespace lamella
