#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <sstream>

#include "core/error.h"
#include "export/polyjet_stack.h"
#include "export/sl1_archives.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

Grid printer_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {25.4 / 600.0, 25.4 / 300.0, 0.027};
  grid.size = {53, 21, 32};
  return grid;
}

std::vector<Layer> random_layers(const BuildInfo& info) {
  std::mt19937 random(43);
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

/// Labels of all voxels, the row of the largest y first; -1 of void is 0.
std::string picture_labels(const BuildInfo& info, const std::vector<Layer>& layers) {
  const Grid& grid = info.plan.grid;
  std::string labels;
  for (const Layer& layer : layers) {
    for (std::int64_t j = grid.size[1] - 1; j >= 0; --j) {
      for (std::int64_t i = 0; i < grid.size[0]; ++i) labels += static_cast<char>(1 + label_of(layer, grid, i, j));
    }
  }
  return labels;
}

/// Runs read_printer_format.py and returns what it prints; the labels that it found go to `labels`.
std::string read_with_python(const std::string& kind, const fs::path& place, const BuildInfo& info,
                             std::string& labels) {
  const TemporaryFolder folder;
  std::string line = "/usr/bin/python3 " + quoted(source_dir() / "tests/export/read_printer_format.py") + " " + kind +
                     " " + quoted(place) + " " + quoted(folder / "labels");
  for (const Material& material : info.materials) line += " " + quoted(fs::path(material.name));
  const CommandResult result = run_command(line);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  labels = bytes_of(folder / "labels");
  return result.output;
}

TEST(Polyjet, PillowReadsOpaqueColorsAndContiguousNumbers) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"VeroCyan", "Agilus", "c", "d", "e", "f"});
  const auto layers = random_layers(info);
  feed(*make_polyjet_sink(folder / "out"), info, layers);
  std::string labels;
  EXPECT_EQ(read_with_python("polyjet", folder / "out", info, labels), "RGBA 53 21 32 opaque\n");
  EXPECT_EQ(labels, picture_labels(info, layers));
  const CommandResult check = run_command("pngcheck -v " + quoted(folder / "out") + "/layer_*.png");
  EXPECT_EQ(check.exit_code, 0) << check.output;
  EXPECT_THAT(check.output, HasSubstr("No errors were detected in 32 of the 32 files"));
  EXPECT_THAT(check.output, HasSubstr("53 x 21 image, 32-bit RGB+alpha, non-interlaced"));
  EXPECT_THAT(check.output, HasSubstr("23622x11811 pixels/meter"));
}

TEST(Polyjet, ARangeOfLayersIsNumberedFromZero) {
  Grid grid = printer_grid();
  grid.size[2] = 50;
  const TemporaryFolder folder;
  const BuildInfo info = make_build(grid, {"a"});
  const auto layers = random_layers(info);
  const std::vector<Layer> some(layers.begin() + 7, layers.begin() + 40);
  feed(*make_polyjet_sink(folder / "out"), info, some);
  std::string labels;
  EXPECT_EQ(read_with_python("polyjet", folder / "out", info, labels), "RGBA 53 21 33 opaque\n");
  EXPECT_EQ(labels, picture_labels(info, some));
}

void expect_refused(const BuildInfo& info, const char* hint) {
  const TemporaryFolder folder;
  try {
    make_polyjet_sink(folder / "out")->begin(info);
    FAIL() << hint;
  } catch (const UsageError& error) {
    EXPECT_THAT(error.hint(), HasSubstr(hint)) << error.what();
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(Polyjet, RefusesWhatTheMachinesRefuse) {
  Grid grid = printer_grid();
  expect_refused(make_build(grid, {"a", "b", "c", "d", "e", "f", "g"}), "fewer");
  BuildInfo same = make_build(grid, {"a", "b"});
  same.materials[MaterialId{1}].color = same.materials[MaterialId{0}].color;
  expect_refused(same, "different colours");
  same.materials[MaterialId{1}].color = {0.0, 0.001, 0.0};
  expect_refused(same, "another colour");
  grid.size[2] = 29;
  expect_refused(make_build(grid, {"a"}), "more layers");
  grid.size[2] = 30;
  grid.pitch.z() = 0.03;
  expect_refused(make_build(grid, {"a"}), "0.027 or 0.014");
  grid.pitch = {0.05, 0.05, 0.027};
  expect_refused(make_build(grid, {"a"}), "--dpi 600,300");
  grid.pitch = {25.4 / 300.0, 25.4 / 300.0, 0.027};
  expect_refused(make_build(grid, {"a"}), "0.01875");
}

TEST(Polyjet, TakesTheLatticeOfAJ55) {
  Grid grid = printer_grid();
  grid.pitch = {25.4 / 300.0, 25.4 / 300.0, 0.01875};
  const TemporaryFolder folder;
  EXPECT_NO_THROW(make_polyjet_sink(folder / "out")->begin(make_build(grid, {"a"})));
}

TEST(Polyjet, ARangeOfTooFewSlicesIsAnError) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"a"});
  const auto layers = random_layers(info);
  EXPECT_THROW(feed(*make_polyjet_sink(folder / "out"), info, {layers[3], layers[4]}), UsageError);
}

TEST(Polyjet, ARangeOfTooFewSlicesLeavesAnEarlierStack) {
  const TemporaryFolder folder;
  BuildInfo info = make_build(printer_grid(), {"a"});
  feed(*make_polyjet_sink(folder / "out"), info, random_layers(info));
  for (const LayerRange range : {LayerRange{3, 5}, LayerRange{3, 32}, LayerRange{20, 900}}) {
    info.given = range;
    const auto sink = make_polyjet_sink(folder / "out");
    EXPECT_THROW(sink->begin(info), UsageError);
    sink->abandon();
  }
  std::string labels;
  EXPECT_EQ(read_with_python("polyjet", folder / "out", info, labels), "RGBA 53 21 32 opaque\n");
  info.given = {2, 900};  // 30 slices
  EXPECT_NO_THROW(make_polyjet_sink(folder / "out")->begin(info));
}

TEST(Sl1, EachMaterialIsAnArchiveOfMasks) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"hard", "soft"});
  const auto layers = random_layers(info);
  feed(*make_sl1_sink(folder / "out"), info, layers);
  std::string labels;
  const std::string about = read_with_python("sl1", folder / "out", info, labels);
  EXPECT_EQ(labels, picture_labels(info, layers));
  EXPECT_THAT(about, HasSubstr("L 53 21 32\n"));
  EXPECT_THAT(about, HasSubstr("layerHeight 0.027\n"));
  EXPECT_THAT(about, HasSubstr("materialName hard\n"));
  EXPECT_THAT(about, HasSubstr("display_pixels_x 53\n"));
  EXPECT_THAT(about, HasSubstr("display_mirror_x 0\n"));
  const auto counts = count_labels(layers, info);
  const double pixel = 25.4 / 600.0 * 25.4 / 300.0 * 0.027 / 1000.0;
  const std::size_t at = about.find("usedMaterial ");
  ASSERT_NE(at, std::string::npos);
  EXPECT_NEAR(std::stod(about.substr(at + 13)), static_cast<double>(counts[0]) * pixel, 1e-12);
  EXPECT_EQ(run_command("unzip -tq " + quoted(folder / "out/soft.sl1")).exit_code, 0);
}

/// What the pictures of an L show in the corners and middles of its box, row by row.
std::string nine_places(const std::string& labels, std::size_t width, std::size_t height) {
  std::string out;
  for (const std::size_t row : {std::size_t{0}, height / 2, height - 1}) {
    for (const std::size_t column : {std::size_t{0}, width / 2, width - 1})
      out += labels[row * width + column] != 0 ? '#' : '.';
    out += ' ';
  }
  return out;
}

TEST(Sl1, PicturesLieAsPrusaSlicersDo) {
  // As PrusaSlicer 2.5.0 wrote an L with the long arm along x and the short one along y, by --export-sla on a display
  // of 1000 x 800 pixels with these settings of --display-orientation, -mirror-x and -mirror-y.
  struct Fact {
    Sl1Display display;
    const char* shown;
  };
  const Fact facts[] = {{{false, false, false}, "#.. #.. ### "}, {{false, false, true}, "### #.. #.. "},
                        {{false, true, false}, "..# ..# ### "},  {{false, true, true}, "### ..# ..# "},
                        {{true, false, false}, "..# ..# ### "},  {{true, false, true}, "### ..# ..# "},
                        {{true, true, false}, "#.. #.. ### "},   {{true, true, true}, "### #.. #.. "}};
  Grid grid = printer_grid();
  grid.size = {50, 30, 2};
  const BuildInfo info = make_build(grid, {"hard", "soft"});
  const auto label = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return l_shape_label(grid, i, j, k); };
  const std::vector<Layer> layers{layer_of_labels(info, 0, label), layer_of_labels(info, 1, label)};
  for (const auto& [display, shown] : facts) {
    const TemporaryFolder folder;
    feed(*make_sl1_sink(folder / "out", {.display = display}), info, layers);
    std::string labels;
    const std::string about = read_with_python("sl1", folder / "out", info, labels);
    EXPECT_THAT(about, HasSubstr(display.is_portrait ? "L 30 50 2\n" : "L 50 30 2\n"));
    EXPECT_THAT(about,
                HasSubstr(display.is_portrait ? "display_orientation portrait" : "display_orientation landscape"));
    EXPECT_THAT(about, HasSubstr(display.mirror_x ? "display_mirror_x 1" : "display_mirror_x 0"));
    EXPECT_THAT(about, HasSubstr(display.mirror_y ? "display_mirror_y 1" : "display_mirror_y 0"));
    EXPECT_THAT(about, HasSubstr("display_pixels_x 50\n"));  // of the machine's x, as PrusaSlicer states it
    const std::string top = labels.substr(labels.size() / 2);
    EXPECT_EQ(display.is_portrait ? nine_places(top, 30, 50) : nine_places(top, 50, 30), shown);
    EXPECT_EQ(std::count(top.begin(), top.end(), '\0'), 50 * 30 - 12 * 30 - 38 * 7);  // the L is whole
  }
}

TEST(Sl1, ThickerLayersAreRepeatedAndTheBytesAreAlwaysTheSame) {
  Grid grid = printer_grid();
  grid.size[2] = 2;
  BuildInfo info = make_build(grid, {"hard", "soft"});
  info.plan.layers[1].z_top += 2 * 0.027;
  info.plan.layers[1].z_sample += 0.027;
  const auto layers = random_layers(info);
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) feed(*make_sl1_sink(folder / name), info, layers);
  std::string labels;
  EXPECT_THAT(read_with_python("sl1", folder / "a", info, labels), HasSubstr("L 53 21 4\n"));
  EXPECT_EQ(labels, picture_labels(info, {layers[0], layers[1], layers[1], layers[1]}));
  EXPECT_EQ(bytes_of(folder / "a/soft.sl1"), bytes_of(folder / "b/soft.sl1"));
}

TEST(Sl1, RefusesAFolderWithOtherFilesAndLeavesItAlone) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"hard", "soft"});
  const auto layers = random_layers(info);
  feed(*make_sl1_sink(folder / "out"), info, layers);
  std::ofstream(folder / "out/soft.sl1.part-7-0") << "of a killed run";
  feed(*make_sl1_sink(folder / "out"), info, layers);  // what this build writes may be there
  const std::string before = bytes_of(folder / "out/soft.sl1");
  BuildInfo other = info;
  other.materials[MaterialId{0}].name = "tough";
  EXPECT_THROW(make_sl1_sink(folder / "out")->begin(other), ExportError);
  EXPECT_FALSE(fs::exists(folder / "out/tough.sl1"));
  std::ofstream(folder / "out/thesis.txt") << "years of work";
  EXPECT_THROW(make_sl1_sink(folder / "out")->begin(info), ExportError);
  EXPECT_EQ(bytes_of(folder / "out/soft.sl1"), before);
  EXPECT_TRUE(fs::exists(folder / "out/thesis.txt"));
}

TEST(Sl1, ARunThatFailsAmongItsArchivesLeavesNoneOfThem) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"hard", "soft"});
  const auto sink = make_sl1_sink(folder / "out");
  sink->begin(info);
  for (const Layer& layer : random_layers(info)) sink->write(layer);
  fs::create_directory(folder / "out/soft.sl1");
  EXPECT_THROW(sink->finish({}), ExportError);
  EXPECT_TRUE(fs::exists(folder / "out/hard.sl1"));
  sink->abandon();
  EXPECT_FALSE(fs::exists(folder / "out/hard.sl1"));
}

TEST(Sl1, AnEndedRunLeavesNoArchive) {
  const TemporaryFolder folder;
  const BuildInfo info = make_build(printer_grid(), {"hard", "soft"});
  {
    const auto sink = make_sl1_sink(folder / "out");
    sink->begin(info);
    sink->write(random_layers(info)[0]);
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
  fs::create_directory(folder / "before");
  make_sl1_sink(folder / "before")->begin(info);
  EXPECT_TRUE(fs::is_empty(folder / "before"));
  std::ofstream(folder / "file") << "x";
  EXPECT_THROW(make_sl1_sink(folder / "file")->begin(info), ExportError);
}

}  // namespace
}  // namespace lamella::test
