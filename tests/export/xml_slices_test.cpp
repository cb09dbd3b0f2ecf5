#include "export/xml_slices.h"

#include <csignal>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <iterator>
#include <limits>
#include <sys/resource.h>

#include "core/error.h"
#include "export/xml_payload.h"
#include "export/xml_validate.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Grid small_grid() {
  Grid grid;
  grid.origin = {-3.1, 20.0, 0.7};
  grid.pitch = {0.04, 0.08, 0.027};
  grid.size = {53, 21, 6};
  return grid;
}

BuildInfo small_build() {
  BuildInfo info = make_build(small_grid(), {"steel", "r\u00FCbber & <co> \"x\"\n\t", ""});
  info.plan.hatch = HatchLattice{0.3, 0.1, 1.0};
  info.materials[MaterialId{1}].density.reset();
  info.solids[SolidId{2}].bounds = {};
  info.policy = OverlapPolicy::average;
  info.turn = Eigen::AngleAxisd(0.7, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  return info;
}

std::vector<Layer> small_layers(const BuildInfo& info) {
  std::mt19937 random(21);
  std::vector<Layer> layers;
  for (std::int64_t k = 0; k < info.plan.grid.size[2]; ++k) layers.push_back(random_layer(info, k, random, k % 2 == 0));
  // Numbers whose bits are easily lost.
  layers[0].raster.segments.front().x_begin = -0.0;
  layers[0].raster.segments.front().x_end = std::numeric_limits<double>::denorm_min();
  layers[0].raster.segments[1].x_begin = 0.1 + 0.2;
  for (std::size_t i = 2; i < layers[0].raster.row_start[1]; ++i) {
    layers[0].raster.segments[i] = {1e17 + 64.0 * i, 1e17 + 64.0 * i + 16.0, MaterialId{0}, SolidId{0}};
  }
  layers[0].raster.segments[1].x_end = 1.7e17 / 3.0;
  std::fill(layers[3].raster.row_start.begin(), layers[3].raster.row_start.end(), 0);  // an empty layer
  layers[3].raster.segments.clear();
  return layers;
}

SliceReport small_report() {
  SliceReport report;
  report.layers = 6;
  report.rows = 126;
  report.rays = 126;
  report.segments = 77;
  report.cast = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  for (int i = 0; i < 3; ++i) {
    report.solids.push_back({1.0 / 3.0 + i, 0.1 * i, 0.01, i == 1, i == 1 ? "open" : "ok"});
    report.materials.push_back({2.0 / 3.0, 5.0 * i});
  }
  report.overlaps = {{SolidId{0}, SolidId{2}, 0.125, 4, 0.2}};
  report.interfaces = {{SolidId{0}, SolidId{1}, 1.0 / 7.0, 0.0, 0.0, 1e-7, 2}};
  report.open_gaps = {{SolidId{0}, SolidId{1}, 3.5, 0.3, 1e-3, 0.1, 4}};
  report.gaps = {{SolidId{1}, SolidId{2}, 1e-9, 1}};
  report.findings = {{Severity::warning, "a", "f", "#12", "what's <wrong>", "h"}, {Severity::note, "", "", "", "", ""}};
  return report;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void expect_same_info(const BuildInfo& a, const BuildInfo& b) {
  ASSERT_EQ(a.sources.size(), b.sources.size());
  for (std::size_t i = 0; i < a.sources.size(); ++i) {
    EXPECT_EQ(a.sources[i].path, b.sources[i].path);
    EXPECT_EQ(a.sources[i].schema, b.sources[i].schema);
    EXPECT_EQ(a.sources[i].unit, b.sources[i].unit);
    EXPECT_EQ(a.sources[i].unit_in_mm, b.sources[i].unit_in_mm);
    EXPECT_EQ(a.sources[i].sha256, b.sources[i].sha256);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (MaterialId id : a.materials.ids()) {
    EXPECT_EQ(a.materials[id].name, b.materials[id].name);
    EXPECT_EQ(a.materials[id].density, b.materials[id].density);
    EXPECT_EQ(a.materials[id].color, b.materials[id].color);
  }
  ASSERT_EQ(a.solids.size(), b.solids.size());
  for (SolidId id : a.solids.ids()) {
    EXPECT_EQ(a.solids[id].name, b.solids[id].name);
    EXPECT_EQ(a.solids[id].path, b.solids[id].path);
    EXPECT_EQ(a.solids[id].material, b.solids[id].material);
    EXPECT_EQ(a.solids[id].priority, b.solids[id].priority);
    EXPECT_EQ(a.solids[id].volume_exact, b.solids[id].volume_exact);
    EXPECT_EQ(a.solids[id].bounds.min(), b.solids[id].bounds.min());
    EXPECT_EQ(a.solids[id].bounds.max(), b.solids[id].bounds.max());
  }
  EXPECT_EQ(a.policy, b.policy);
  ASSERT_EQ(a.turn.has_value(), b.turn.has_value());
  if (a.turn) {
    EXPECT_EQ(*a.turn, *b.turn);
  }
}

void expect_same_plan(const LayerPlan& a, const LayerPlan& b) {
  EXPECT_EQ(a.grid.origin, b.grid.origin);
  EXPECT_EQ(a.grid.pitch, b.grid.pitch);
  EXPECT_EQ(a.grid.size, b.grid.size);
  ASSERT_EQ(a.layers.size(), b.layers.size());
  for (std::size_t i = 0; i < a.layers.size(); ++i) {
    EXPECT_EQ(a.layers[i].z_bottom, b.layers[i].z_bottom);
    EXPECT_EQ(a.layers[i].z_sample, b.layers[i].z_sample);
    EXPECT_EQ(a.layers[i].z_top, b.layers[i].z_top);
  }
  ASSERT_EQ(a.hatch.has_value(), b.hatch.has_value());
  if (!a.hatch) return;
  EXPECT_EQ(a.hatch->spacing, b.hatch->spacing);
  EXPECT_EQ(a.hatch->angle, b.hatch->angle);
  EXPECT_EQ(a.hatch->rotation, b.hatch->rotation);
}

void expect_same_report(const SliceReport& a, const SliceReport& b) {
  EXPECT_EQ(a.layers, b.layers);
  EXPECT_EQ(a.segments, b.segments);
  EXPECT_EQ(a.cast.rays, b.cast.rays);
  EXPECT_EQ(a.cast.iterations, b.cast.iterations);
  ASSERT_EQ(a.solids.size(), b.solids.size());
  for (SolidId id : a.solids.ids()) {
    EXPECT_EQ(a.solids[id].volume_sliced, b.solids[id].volume_sliced);
    EXPECT_EQ(a.solids[id].volume_exact, b.solids[id].volume_exact);
    EXPECT_EQ(a.solids[id].quadrature_bound, b.solids[id].quadrature_bound);
    EXPECT_EQ(a.solids[id].left_out, b.solids[id].left_out);
    EXPECT_EQ(a.solids[id].status, b.solids[id].status);
  }
  ASSERT_EQ(a.materials.size(), b.materials.size());
  for (MaterialId id : a.materials.ids()) EXPECT_EQ(a.materials[id].mass, b.materials[id].mass);
  ASSERT_EQ(a.overlaps.size(), b.overlaps.size());
  EXPECT_EQ(a.overlaps[0].volume, b.overlaps[0].volume);
  ASSERT_EQ(a.gaps.size(), b.gaps.size());
  EXPECT_EQ(a.gaps[0].second, b.gaps[0].second);
  ASSERT_EQ(a.findings.size(), b.findings.size());
  EXPECT_EQ(a.findings[0].what, b.findings[0].what);
  EXPECT_EQ(a.findings[1].severity, b.findings[1].severity);
}

class XmlSlices : public ::testing::TestWithParam<XmlPayload> {
 protected:
  /// Writes the small build and returns the file.
  fs::path write_sample() {
    const BuildInfo info = small_build();
    feed(*make_xml_sink(file_, GetParam()), info, small_layers(info), small_report());
    return file_;
  }

  TemporaryFolder folder_;
  fs::path file_ = folder_ / "slices.xml";
};

INSTANTIATE_TEST_SUITE_P(Payload, XmlSlices, ::testing::Values(XmlPayload::text, XmlPayload::binary),
                         [](const auto& p) { return p.param == XmlPayload::text ? "Text" : "Binary"; });

TEST_P(XmlSlices, ComeBackBitForBit) {
  const fs::path file = write_sample();
  CollectingSink sink;
  read_xml_slices(file, sink);
  const BuildInfo info = small_build();
  expect_same_info(sink.info, info);
  expect_same_plan(sink.info.plan, info.plan);
  const auto layers = small_layers(info);
  ASSERT_EQ(sink.layers.size(), layers.size());
  for (std::size_t k = 0; k < layers.size(); ++k) EXPECT_EQ(sink.layers[k], layers[k]) << k;
  EXPECT_TRUE(std::signbit(sink.layers[0].raster.segments[0].x_begin));
  EXPECT_TRUE(sink.finished);
  expect_same_report(sink.report, small_report());
}

TEST_P(XmlSlices, WrittenAgainGiveTheSameBytes) {
  const fs::path file = write_sample();
  read_xml_slices(file, *make_xml_sink(folder_ / "again.xml", GetParam()));
  EXPECT_EQ(text_of(file), text_of(folder_ / "again.xml"));
}

TEST_P(XmlSlices, XmllintFindsThemValidAsAStream) {
  const CommandResult result =
      run_command("xmllint --nonet --noout --stream --schema " + quoted(source_dir() / "schemas" / "slices.xsd") + " " +
                  quoted(write_sample()));
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("validates"));
}

TEST_P(XmlSlices, AreValidByOurOwnCheck) {
  const XmlValidation validation = validate_xml(write_sample());
  EXPECT_EQ(validation.schema, "slices.xsd");
  EXPECT_THAT(validation.findings, IsEmpty());
}

TEST_P(XmlSlices, KeepRowsLongerThanOneBlock) {
  Grid grid = small_grid();
  grid.size = {10, 2, 1};
  const BuildInfo info = make_build(grid, {"a"});
  Layer layer = make_layer(info, 0);
  for (int i = 0; i < 140000; ++i) layer.raster.segments.push_back({i + 0.25, i + 0.5, MaterialId{0}, SolidId{0}});
  layer.raster.row_start = {0, 0, 140000};
  feed(*make_xml_sink(file_, GetParam()), info, {layer});
  CollectingSink again;
  read_xml_slices(file_, again);
  EXPECT_EQ(again.layers.at(0), layer);
  EXPECT_THAT(validate_xml(file_).findings, IsEmpty());
}

TEST_P(XmlSlices, TruncatedAnywhereAreRefusedAndNeverFinish) {
  const std::string text = text_of(write_sample());
  for (std::size_t length = 0; length + 2 < text.size(); length += 1 + text.size() / 200) {
    std::ofstream(file_, std::ios::binary) << text.substr(0, length);
    CollectingSink sink;
    EXPECT_THROW(read_xml_slices(file_, sink), InputError) << length;
    EXPECT_FALSE(sink.finished);
  }
}

TEST_P(XmlSlices, WithAnyByteDamagedAreRefusedOrReadWithoutHarm) {
  const std::string text = text_of(write_sample());
  std::mt19937 random(99);
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string damaged = text;
    for (int i = 0; i < 3; ++i) damaged[random() % damaged.size()] = static_cast<char>(random());
    std::ofstream(file_, std::ios::binary) << damaged;
    CollectingSink sink;
    try {
      read_xml_slices(file_, sink);
    } catch (const InputError& error) {
      ++refused;
      EXPECT_THAT(error.where(), HasSubstr(file_.string()));
    }
  }
  EXPECT_GT(refused, 200);
}

TEST_P(XmlSlices, AKilledRunLeavesNothing) {
  const BuildInfo info = small_build();
  {
    const auto sink = make_xml_sink(file_, GetParam());
    sink->begin(info);
    sink->write(small_layers(info)[0]);
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_P(XmlSlices, AFullDiskIsAnErrorThatLeavesNothing) {
  const BuildInfo info = small_build();
  const auto layers = small_layers(info);
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{5000, old.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);
  EXPECT_THROW(feed(*make_xml_sink(file_, GetParam()), info, layers), ExportError);
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST(XmlSlices, SayHowTheAssemblyWasTurnedOnlyIfItWasAndRefuseWhatIsNoRotation) {
  const TemporaryFolder folder;
  BuildInfo info = small_build();
  const auto write = [&](const char* name) {
    feed(*make_xml_sink(folder / name, XmlPayload::text), info, small_layers(info), small_report());
    return text_of(folder / name);
  };
  std::string text = write("turned.xml");
  EXPECT_THAT(text, HasSubstr("version=\"1.2\""));
  const std::size_t at = text.find(" rotation=\"") + 11;
  text.replace(at, text.find(' ', at) - at, "0.5");
  std::ofstream(folder / "bent.xml", std::ios::binary) << text;
  CollectingSink sink;
  EXPECT_THROW(read_xml_slices(folder / "bent.xml", sink), InputError);
  info.turn.reset();
  EXPECT_THAT(write("plain.xml"), ::testing::Not(HasSubstr("orientation")));
}

TEST(XmlSlicesSink, RefusesTargetsThatAreNotPlainFiles) {
  const TemporaryFolder folder;
  std::ofstream(folder / "file") << "x";
  fs::create_symlink("/dev/full", folder / "link");
  const BuildInfo info = small_build();
  for (const fs::path& target : {folder.path(), folder / "file" / "slices.xml", fs::path("/dev/full"), folder / "link",
                                 fs::path("/proc/none/slices.xml"), fs::path("")}) {
    EXPECT_THROW(make_xml_sink(target)->begin(info), ExportError) << target;
  }
}

TEST(XmlSlicesSink, RefusesNumbersThatAreNotFiniteAndLayersOutOfOrder) {
  const TemporaryFolder folder;
  const BuildInfo info = small_build();
  auto layers = small_layers(info);
  for (const XmlPayload payload : {XmlPayload::text, XmlPayload::binary}) {
    const auto sink = make_xml_sink(folder / "a.xml", payload);
    sink->begin(info);
    sink->write(layers[2]);
    EXPECT_THROW(sink->write(layers[1]), ExportError);
    layers[4].raster.segments[0].x_end = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(sink->write(layers[4]), ExportError);
    layers[4].raster.segments[0].x_end = std::numeric_limits<double>::infinity();
    EXPECT_THROW(sink->write(layers[4]), ExportError);
  }
}

}  // namespace
}  // namespace lamella::test
