#include <gtest/gtest.h>

#include "tests/export/volumes.h"

/// Readers that are heavy to install; without them these tests skip.
namespace lamella::test {
namespace {

TEST(VolumesForeign, VtkReadsTheSame) {
  if (run_command("pvpython --version").exit_code != 0) GTEST_SKIP() << "no pvpython (package paraview)";
  const std::string program =
      "pvpython --force-offscreen-rendering " + quoted(source_dir() / "tests/export/read_volume_paraview.py");
  for (const std::size_t materials : {2U, 256U}) {
    const BuildInfo info = make_build(small_grid(), names(materials));
    const auto layers = random_layers(info);
    for (const VolumeFormat& format : kFormats) {
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

/// Prints the lattice and each pixel's value of the picture that is the argument, as ImageJ has them.
constexpr const char* kMacro = R"(open(getArgument());
getVoxelSize(width, height, depth, unit);
getDimensions(nx, ny, channels, nz, frames);
print("pitch " + d2s(width, 9) + " " + d2s(height, 9) + " " + d2s(depth, 9));
print("unit " + unit);
print("size " + nx + " " + ny + " " + nz);
for (k = 1; k <= nz; k++) {
  setSlice(k);
  for (j = 0; j < ny; j++) {
    row = "row";
    for (i = 0; i < nx; i++) row = row + " " + getPixel(i, j);
    print(row);
  }
}
)";

TEST(VolumesForeign, ImageJReadsTheSame) {
  if (run_command("sh -c 'command -v imagej && command -v xvfb-run'").exit_code != 0) {
    GTEST_SKIP() << "no imagej or no xvfb-run (packages imagej, xvfb, xauth)";
  }
  for (const std::size_t materials : {2U, 256U}) {
    for (const bool raw : {false, true}) {
      const TemporaryFolder folder;
      const BuildInfo info = make_build(small_grid(), names(materials));
      const auto layers = random_layers(info);
      feed(*make_tiff_sink(folder / "a.tif", {.volume = {.is_raw = raw}}), info, layers);
      std::ofstream(folder / "read.ijm") << kMacro;
      const CommandResult result =
          run_command("xvfb-run -a imagej -b " + quoted(folder / "read.ijm") + " " + quoted(folder / "a.tif"));
      // The script that starts ImageJ returns 1 whatever happens.
      EXPECT_NE(result.output.find("pitch 0.040000000 0.080000000 0.027000000\nunit mm\nsize 53 21 6\n"),
                std::string::npos)
          << result.output.substr(0, 1000);
      std::istringstream stream(result.output);
      std::vector<std::uint16_t> labels;
      for (std::string line; std::getline(stream, line);) {
        if (!line.starts_with("row ")) continue;
        std::istringstream row(line.substr(4));
        labels.insert(labels.end(), std::istream_iterator<int>(row), {});
      }
      ASSERT_EQ(labels, expected_labels(info, layers, {0, 1, 2, 3, 4, 5})) << materials << raw;
    }
  }
}

}  // namespace
}  // namespace lamella::test
