#include <gtest/gtest.h>

#include "export/png_stack.h"
#include "export/vdb/vdb_sink.h"
#include "export/xml_slices.h"
#include "tests/support/command.h"
#include "tests/support/layers.h"

namespace lamella::test {
namespace {

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

  const std::string part =
      "00.......\n00.......\n00.......\n00.......\n00.......\n00.......\n"
      "000000011\n000000011\n";
  const CommandResult result = run_command("/usr/bin/python3 " + quoted(source_dir() / "tests/export/orientation.py") +
                                           " " + quoted(folder.path()) + " 9 8");
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.output, "png\n" + part + "png-indexed\n" + part + "xml\n" + part + "vdb\n" + part);
}

}  // namespace
}  // namespace lamella::test
