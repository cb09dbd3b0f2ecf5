/// Sinks of contour formats on hand-made layers: names that need escaping, targets that can't be, layers that don't
/// fit.

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>

#include "core/error.h"
#include "export/cli_sink.h"
#include "export/slc_sink.h"
#include "export/step_sink.h"
#include "export/svg_sink.h"
#include "export/threemf_sink.h"
#include "export/vtp_sink.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::SizeIs;

struct Sink {
  const char* name;
  std::unique_ptr<LayerSink> (*make)(const fs::path& path);
  bool needs_contours;
};

const std::vector<Sink> kSinks{{"svg", make_svg_sink, true},
                               {"cli", make_cli_sink, false},
                               {"cli-binary", make_binary_cli_sink, false},
                               {"slc", make_slc_sink, true},
                               {"3mf", make_3mf_sink, true},
                               {"vtp", make_vtp_sink, false},
                               {"step", [](const auto& path) { return make_step_sink(path); }, true}};

/// Two layers of two solids that overlap, with names that every format has to escape in its own way.
struct Sample {
  BuildInfo info;
  std::vector<Layer> layers;

  Sample() {
    Grid grid;
    grid.pitch = {0.5, 0.5, 0.3};
    grid.size = {20, 12, 2};
    info = make_build(grid, {"it's <\"&'> \\ // $$\xC3\xBC\xFF\n", "b/../c"});
    info.plan.chord_error = 0.01;
    std::mt19937 random(3);
    for (std::int64_t k = 0; k < 2; ++k) {
      Layer& layer = layers.emplace_back(random_layer(info, k, random));
      layer.contours.emplace();
      layer.contours->add({SolidId{0}, -1, 32.0}, std::vector<Vec2>{{1, 1}, {9, 1}, {9, 5}, {1, 5}});
      layer.contours->add({SolidId{1}, -1, 4.0}, std::vector<Vec2>{{2, 2}, {4, 2}, {4, 4}, {2, 4}});
    }
  }
};

std::string bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(VectorSinks, NamesThatNeedEscapingGiveReadableFiles) {
  const TemporaryFolder folder;
  const Sample sample;
  for (const Sink& sink : kSinks) feed(*sink.make(folder / sink.name), sample.info, sample.layers);
  for (const char* file : {"svg/layer_000001.svg", "vtp/layer_000001.vtp", "vtp/layers.pvd"})
    EXPECT_EQ(run_command("xmllint --noout " + quoted(folder / file)).exit_code, 0) << file;
  EXPECT_EQ(run_command("unzip -p " + quoted(folder / "3mf") + " 3D/3dmodel.model | xmllint --noout -").exit_code, 0);
  const std::string script = "import sys; sys.path.insert(0, '" + (source_dir() / "tests/export").string() + "'); ";
  for (const char* file : {"cli", "cli-binary"}) {
    const CommandResult result = run_command(
        "/usr/bin/python3 -c \"" + script + "from decode_cli import CliFile; f = CliFile('" + (folder / file).string() +
        "'); print(len(f.layers), f.labels[2], sum(len(l.polylines) for l in f.layers))\"");
    EXPECT_EQ(result.output, "3 b_.._c 6\n") << result.errors;
  }
  const std::string step = bytes_of(folder / "step");
  EXPECT_THAT(step, HasSubstr("PRODUCT('it''s <\"&''> \\\\ // $$\\X2\\00FC\\X0\\\\X2\\FFFD\\X0\\\\X2\\000A\\X0\\'"));
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "slc")) names.push_back(entry.path().filename().string());
  EXPECT_THAT(names, SizeIs(2));
  EXPECT_THAT(names, Each(HasSubstr(".slc")));
}

TEST(VectorSinks, LinesOfVtkSayHowTheAssemblyWasTurned) {
  const TemporaryFolder folder;
  Sample sample;
  feed(*make_vtp_sink(folder / "plain"), sample.info, sample.layers);
  EXPECT_THAT(bytes_of(folder / "plain/layer_000001.vtp"), ::testing::Not(HasSubstr("rotation")));
  sample.info.turn = Mat3{{0.0, 0.0, 1.0}, {0.6, 0.8, 0.0}, {-0.8, 0.6, 0.0}};
  feed(*make_vtp_sink(folder / "turned"), sample.info, sample.layers);
  const std::string path = "//FieldData/DataArray[@Name=\\\"rotation\\\"][@NumberOfComponents=9]/text()";
  const CommandResult found =
      run_command("xmllint --xpath \"" + path + "\" " + quoted(folder / "turned/layer_000001.vtp"));
  EXPECT_THAT(found.output, HasSubstr("0 0 1 0.6 0.8 0 -0.8 0.6 0")) << found.errors;
}

TEST(VectorSinks, ARunThatEndsEarlyLeavesNoFile) {
  const Sample sample;
  for (const Sink& sink : kSinks) {
    const TemporaryFolder folder;
    {
      const auto made = sink.make(folder / "out");
      made->begin(sample.info);
      made->write(sample.layers[0]);
      made->abandon();
    }
    EXPECT_TRUE(fs::is_empty(folder.path())) << sink.name;
  }
}

TEST(VectorSinks, ACancelledRunOfSlcLeavesNoFolderOfItsOwn) {
  const Sample sample;
  const TemporaryFolder folder;
  fs::create_directory(folder / "before");
  for (const char* name : {"new", "before"}) {
    const auto sink = make_slc_sink(folder / name);
    sink->begin(sample.info);
    sink->write(sample.layers[0]);
  }
  EXPECT_FALSE(fs::exists(folder / "new"));
  EXPECT_TRUE(fs::is_empty(folder / "before"));
}

TEST(VectorSinks, AnSlcRunThatFailsAmongItsFilesLeavesNoneOfThem) {
  const Sample sample;
  const TemporaryFolder folder;
  feed(*make_slc_sink(folder / "whole"), sample.info, sample.layers);
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder / "whole")) names.push_back(entry.path().filename().string());
  ASSERT_EQ(names.size(), 2U);
  for (std::size_t n = 0; n < 2; ++n) {  // the one that fails is the first or the second
    const auto out = folder / ("out" + std::to_string(n));
    const auto sink = make_slc_sink(out);
    sink->begin(sample.info);
    for (const Layer& layer : sample.layers) sink->write(layer);
    fs::create_directory(out / names[n]);
    EXPECT_THROW(sink->finish({}), ExportError);
    sink->abandon();
    EXPECT_FALSE(fs::exists(out / names[1 - n]));
  }
}

TEST(VectorSinks, LayersThatDoNotFitTheirPlanAreRefused) {
  const Sample sample;
  for (const Sink& sink : kSinks) {
    const TemporaryFolder folder;
    const auto made = sink.make(folder / "out");
    made->begin(sample.info);
    Layer without = sample.layers[0];
    without.contours.reset();
    EXPECT_THROW(made->write(without), ExportError) << sink.name;
  }
}

TEST(VectorSinks, TargetsThatCannotBeAreRefusedBeforeAnyLayer) {
  const Sample sample;
  for (const Sink& sink : kSinks) {
    const TemporaryFolder folder;
    std::ofstream(folder / "file") << "x";
    EXPECT_THROW(sink.make(folder / "file" / "out")->begin(sample.info), ExportError) << sink.name;
  }
}

TEST(VectorSinks, BuildsWithoutContoursAreRefusedWhereTheyAreNeeded) {
  Sample sample;
  sample.info.plan.chord_error.reset();
  for (const Sink& sink : kSinks) {
    const TemporaryFolder folder;
    const auto made = sink.make(folder / "out");
    if (sink.needs_contours) {
      EXPECT_THROW(made->begin(sample.info), UsageError) << sink.name;
    } else {
      EXPECT_NO_THROW(made->begin(sample.info)) << sink.name;
    }
  }
}

}  // namespace
}  // namespace lamella::test
