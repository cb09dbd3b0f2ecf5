#include <gtest/gtest.h>

#include "export/grey_png_stack.h"
#include "export/mhd_file.h"
#include "export/nrrd_file.h"
#include "export/png_stack.h"
#include "export/polyjet_stack.h"
#include "export/sl1_archives.h"
#include "export/tiff_file.h"
#include "export/vdb/vdb_sink.h"
#include "export/vti_file.h"
#include "export/xml_slices.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

/// The same part in pixels and layers that these machines take.
void write_polyjet(const std::filesystem::path& folder) {
  Grid grid;
  grid.pitch = {25.4 / 600.0, 25.4 / 300.0, 0.027};
  grid.size = {9, 8, 30};
  const BuildInfo info = make_build(grid, {"steel", "marker"});
  std::vector<Layer> layers;
  for (std::int64_t k = 0; k < 30; ++k) {
    layers.push_back(layer_of_labels(info, k, [&](auto i, auto j, auto at) { return l_shape_label(grid, i, j, at); }));
  }
  feed(*make_polyjet_sink(folder), info, layers);
}

TEST(Orientation, EveryFormatShowsTheSameAsymmetricPart) {
  Grid grid;
  grid.origin = {-7.0, 3.0, 0.5};
  grid.pitch = {0.5, 0.25, 0.1};
  grid.size = {9, 8, 2};
  const BuildInfo info = make_build(grid, {"steel", "marker"});
  const auto label = [&](std::int64_t i, std::int64_t j, std::int64_t k) { return l_shape_label(grid, i, j, k); };
  const std::vector<Layer> layers = {layer_of_labels(info, 0, label), layer_of_labels(info, 1, label)};
  const TemporaryFolder folder;
  feed(*make_png_sink(folder / "png"), info, layers);
  feed(*make_indexed_png_sink(folder / "indexed"), info, layers);
  feed(*make_xml_sink(folder / "slices.xml", XmlPayload::text), info, layers);
  feed(*make_vdb_sink(folder / "a.vdb"), info, layers);
  feed(*make_grey_png_sink(folder / "grey"), info, layers);
  feed(*make_coverage_png_sink(folder / "coverage"), info, layers);
  feed(*make_sl1_sink(folder / "sl1"), info, layers);
  feed(*make_tiff_sink(folder / "a.tif"), info, layers);
  feed(*make_nrrd_sink(folder / "a.nrrd"), info, layers);
  feed(*make_mhd_sink(folder / "a.mhd"), info, layers);
  feed(*make_vti_sink(folder / "a.vti"), info, layers);
  write_polyjet(folder / "polyjet");

  const std::string part =
      "00.......\n00.......\n00.......\n00.......\n00.......\n00.......\n"
      "000000011\n000000011\n";
  const CommandResult result = run_command("/usr/bin/python3 " + quoted(source_dir() / "tests/export/orientation.py") +
                                           " " + quoted(folder.path()) + " 9 8");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  std::string expected;
  for (const char* name : {"png", "png-indexed", "xml", "vdb", "grey", "coverage", "polyjet", "sl1", "a.tif", "a.nrrd",
                           "a.mhd", "a.vti"}) {
    expected += name + ("\n" + part);
  }
  EXPECT_EQ(result.output, expected);
}

}  // namespace
}  // namespace lamella::test
