#include "export/png_stack.h"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <map>
#include <sstream>

#include "core/error.h"
#include "tests/export/read_png.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Grid small_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {25.4 / 600.0, 25.4 / 300.0, 0.027};
  grid.size = {53, 21, 6};
  return grid;
}

std::vector<Layer> random_layers(const BuildInfo& info, unsigned seed = 5) {
  std::mt19937 random(seed);
  std::vector<Layer> layers;
  for (std::int64_t k = 0; k < info.plan.grid.size[2]; ++k) layers.push_back(random_layer(info, k, random));
  return layers;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> files_under(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) names.push_back(entry.path().lexically_relative(folder).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// value -> count, as Pillow sees the pictures.
std::map<int, std::int64_t> pillow_counts(const fs::path& folder) {
  const auto script = source_dir() / "tests" / "export" / "count_png_pixels.py";
  const CommandResult result = run_command("/usr/bin/python3 " + quoted(script) + " " + quoted(folder));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  std::map<int, std::int64_t> counts;
  std::istringstream stream(result.output);
  int value = 0;
  for (std::int64_t count = 0; stream >> value >> count;) counts[value] = count;
  return counts;
}

TEST(PngStack, EveryPixelOfEveryMaterialIsThatOfTheSegmentAtItsCentre) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber", "glass"});
  const auto layers = random_layers(info);
  feed(*make_png_sink(folder / "out"), info, layers);
  for (const Layer& layer : layers) {
    const std::string name = "layer_00000" + std::to_string(layer.index) + ".png";
    for (int m = 0; m < 3; ++m) {
      const PngPicture picture = read_png(folder / "out" / info.materials[MaterialId(m)].name / name);
      ASSERT_EQ(picture.bits, 1);
      for (std::int64_t j = 0; j < 21; ++j) {
        for (std::int64_t i = 0; i < 53; ++i) {
          ASSERT_EQ(picture.at(i, 20 - j) == 1, label_of(layer, info.plan.grid, i, j) == m);
        }
      }
    }
  }
}

TEST(PngStack, EveryIndexedPixelIsOnePlusTheMaterial) {
  const TemporaryFolder folder;
  for (std::size_t materials : {1u, 3u, 15u, 16u, 255u}) {
    std::vector<std::string> names;
    for (std::size_t m = 0; m < materials; ++m) names.push_back("m" + std::to_string(m));
    const BuildInfo info = make_build(small_grid(), names);
    const auto layers = random_layers(info);
    feed(*make_indexed_png_sink(folder / "out"), info, layers);
    for (const Layer& layer : layers) {
      const PngPicture picture = read_png(folder / "out" / ("layer_00000" + std::to_string(layer.index) + ".png"));
      ASSERT_EQ(picture.bits, materials == 1 ? 1 : materials == 3 ? 2 : materials == 15 ? 4 : 8);
      ASSERT_EQ(picture.palette.size(), materials + 1);
      for (std::int64_t j = 0; j < 21; ++j) {
        for (std::int64_t i = 0; i < 53; ++i) {
          ASSERT_EQ(picture.at(i, 20 - j), label_of(layer, info.plan.grid, i, j) + 1);
        }
      }
    }
  }
}

TEST(PngStack, PillowCountsThePixelsOfTheSegments) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber", "glass"});
  const auto layers = random_layers(info);
  const auto expected = count_labels(layers, info);
  feed(*make_indexed_png_sink(folder / "indexed"), info, layers);
  feed(*make_png_sink(folder / "stacks"), info, layers);
  const auto indexed = pillow_counts(folder / "indexed");
  for (int m = 0; m < 3; ++m) {
    EXPECT_EQ(indexed.at(m + 1), expected[m]);
    EXPECT_EQ(pillow_counts(folder / "stacks" / info.materials[MaterialId(m)].name).at(1), expected[m]);
  }
}

TEST(PngStack, PngcheckFindsNothingWrong) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber", "glass"});
  feed(*make_indexed_png_sink(folder / "indexed"), info, random_layers(info));
  feed(*make_png_sink(folder / "stacks"), info, random_layers(info));
  const std::string script =
      "pngcheck -v " + quoted(folder / "indexed") + "/*.png " + quoted(folder / "stacks") + "/*/*.png";
  const CommandResult result = run_command("sh -c " + quoted(fs::path(script)));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("No errors were detected in 24 of the 24 files tested"));
  EXPECT_THAT(result.output, HasSubstr("23622x11811 pixels/meter"));
}

TEST(PngStack, TheTopOfAPictureIsTheLargestY) {
  Grid grid = small_grid();
  grid.size = {8, 8, 2};
  const TemporaryFolder folder;
  const BuildInfo info = make_build(grid, {"steel", "marker"});
  const auto label = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return l_shape_label(grid, i, j, k); };
  feed(*make_indexed_png_sink(folder / "out"), info,
       {layer_of_labels(info, 0, label), layer_of_labels(info, 1, label)});
  const PngPicture picture = read_png(folder / "out" / "layer_000001.png");
  std::vector<std::string> rows;
  for (std::int64_t row = 0; row < 8; ++row) {
    rows.emplace_back();
    for (std::int64_t column = 0; column < 8; ++column) rows.back() += ".#o"[picture.at(column, row)];
  }
  EXPECT_THAT(rows, ElementsAre("##......", "##......", "##......", "##......", "##......", "##......", "######oo",
                                "######oo"));
}

TEST(PngStack, TablesNameLayersMaterialsAndTheExactGrid) {
  const TemporaryFolder folder;
  BuildInfo info = make_build(small_grid(), {"a, \"b\"", "b"});
  info.materials[MaterialId{1}].density.reset();
  feed(*make_png_sink(folder / "out"), info, random_layers(info));
  EXPECT_EQ(text_of(folder / "out" / "materials.csv"),
            "value,name,folder,density_g_cm3,red,green,blue\n"
            "1,\"a, \"\"b\"\"\",a___b_,1.3333333333333333,85,170,64\n"
            "1,b,b,,170,85,64\n");
  EXPECT_THAT(text_of(folder / "out" / "layers.csv"),
              HasSubstr("index,z_bottom,z_sample,z_top,file\n0,0.7,0.7135,0.727,layer_000000.png\n1,"));
  EXPECT_THAT(text_of(folder / "out" / "grid.csv"), HasSubstr("y,20,0.08466666666666667,21\n"));
}

TEST(PngStack, HostileMaterialNamesStayInsideTheFolder) {
  const TemporaryFolder folder;
  const BuildInfo info =
      make_build(small_grid(), {"../../evil", "", "", "a/b", "layers.csv", "Geh\u00E4use", ".hidden"});
  feed(*make_png_sink(folder / "deep" / "out"), info, {});
  EXPECT_THAT(files_under(folder.path()),
              ElementsAre("deep/out/grid.csv", "deep/out/layers.csv", "deep/out/materials.csv"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "deep" / "out"), {}), 10);
}

TEST(PngStack, RefusesAFolderWithForeignFilesAndLeavesItAlone) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  std::ofstream(folder / "thesis.txt") << "years of work";
  EXPECT_THROW(make_png_sink(folder.path())->begin(info), ExportError);
  EXPECT_THROW(make_indexed_png_sink(folder.path())->begin(info), ExportError);
  EXPECT_THAT(files_under(folder.path()), ElementsAre("thesis.txt"));
}

TEST(PngStack, RefusesPicturesThatAreNotKnownToBeItsOwn) {
  const TemporaryFolder folder;
  std::ofstream(folder / "layer_000000.png") << "somebody else's";
  EXPECT_THROW(make_indexed_png_sink(folder.path())->begin(make_build(small_grid(), {"steel"})), ExportError);
  EXPECT_THAT(files_under(folder.path()), ElementsAre("layer_000000.png"));
}

TEST(PngStack, NeverFollowsLinks) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  feed(*make_png_sink(folder / "out"), info, random_layers(info));
  fs::create_directory(folder / "precious");
  std::ofstream(folder / "precious" / "layer_000000.png") << "x";
  fs::create_directory_symlink(folder / "precious", folder / "out" / "link");
  EXPECT_THROW(make_png_sink(folder / "out")->begin(info), ExportError);
  EXPECT_TRUE(fs::exists(folder / "precious" / "layer_000000.png"));
}

TEST(PngStack, ReplacesAnEarlierStackWhole) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "old"});
  feed(*make_png_sink(folder / "out"), info, random_layers(info));
  Grid lower = small_grid();
  lower.size[2] = 1;
  const BuildInfo fewer = make_build(lower, {"steel"});
  feed(*make_png_sink(folder / "out"), fewer, random_layers(fewer));
  EXPECT_THAT(files_under(folder / "out"),
              ElementsAre("grid.csv", "layers.csv", "materials.csv", "steel/layer_000000.png"));
  EXPECT_FALSE(fs::exists(folder / "out" / "old"));
}

TEST(PngStack, ACancelledRunLeavesWholePicturesAndNoLayerTable) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  const auto layers = random_layers(info);
  {
    const auto sink = make_indexed_png_sink(folder / "out");
    sink->begin(info);
    sink->write(layers[0]);
    sink->write(layers[1]);
  }
  EXPECT_THAT(files_under(folder / "out"),
              ElementsAre("grid.csv", "layer_000000.png", "layer_000001.png", "materials.csv"));
  EXPECT_NO_THROW(static_cast<void>(read_png(folder / "out" / "layer_000001.png")));
  feed(*make_indexed_png_sink(folder / "out"), info, layers);  // and the folder can be used again
}

TEST(PngStack, AnAbandonedRunLeavesNothingOfItsOwn) {
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber"});
  const auto layers = random_layers(info);
  for (const auto make : {make_png_sink, make_indexed_png_sink}) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "before");
    for (const char* name : {"new", "before"}) {
      const auto sink = make(folder / name);
      sink->begin(info);
      sink->write(layers[0]);
      sink->abandon();
    }
    EXPECT_FALSE(fs::exists(folder / "new"));
    EXPECT_TRUE(fs::is_empty(folder / "before"));
  }
}

TEST(PngStack, AbandoningARunThatWasRefusedTakesNothingAway) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  feed(*make_png_sink(folder.path()), info, random_layers(info));
  const auto before = files_under(folder.path());
  const auto unopened = make_png_sink(folder.path());
  unopened->abandon();
  EXPECT_EQ(files_under(folder.path()), before);
  std::ofstream(folder / "thesis.txt") << "years of work";
  const auto refused = make_png_sink(folder.path());
  EXPECT_THROW(refused->begin(info), ExportError);
  refused->abandon();
  EXPECT_EQ(files_under(folder.path()).size(), before.size() + 1);
}

TEST(PngStack, RefusesMoreMaterialsThanAnIndexHolds) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), std::vector<std::string>(256, "m"));
  EXPECT_THROW(make_indexed_png_sink(folder / "out")->begin(info), UsageError);
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(PngStack, RefusesAPictureThatIsTooLargeBeforeTouchingTheDisk) {
  const TemporaryFolder folder;
  Grid grid = small_grid();
  grid.size = {2147483647, 2147483647, 1};
  BuildInfo info = make_build(small_grid(), {"steel"});
  info.plan.grid = grid;
  EXPECT_THROW(make_indexed_png_sink(folder / "out")->begin(info), UsageError);
  EXPECT_THROW(make_png_sink(folder / "out")->begin(info), UsageError);
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(PngStack, RefusesLayersThatDoNotFitTheBuild) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  const auto sink = make_indexed_png_sink(folder / "out");
  sink->begin(info);
  Layer layer = random_layers(info).front();
  layer.raster.segments.push_back({0.0, 1.0, MaterialId{7}, SolidId{0}});
  layer.raster.row_start.back() += 1;
  EXPECT_THROW(sink->write(layer), ExportError);
  layer.raster.segments.back().material = MaterialId{0};
  layer.raster.row_start.pop_back();
  EXPECT_THROW(sink->write(layer), ExportError);
}

TEST(PngStack, SaysWhenTheOutputCanNotBeWritten) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel"});
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(make_png_sink(folder / "file")->begin(info), ExportError);
  EXPECT_THROW(make_png_sink(folder / "file" / "out")->begin(info), ExportError);
  EXPECT_THROW(make_indexed_png_sink(fs::path("/proc/lamella"))->begin(info), ExportError);
}

TEST(PngStack, TheSameLayersGiveTheSameBytes) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(small_grid(), {"steel", "rubber"});
  for (const char* name : {"a", "b"}) feed(*make_png_sink(folder / name), info, random_layers(info));
  const auto names = files_under(folder / "a");
  ASSERT_EQ(names.size(), 15u);
  for (const auto& name : names) EXPECT_EQ(text_of(folder / "a" / name), text_of(folder / "b" / name)) << name;
}

}  // namespace
}  // namespace lamella::test
