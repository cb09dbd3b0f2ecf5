#include <array>
#include <gmock/gmock.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

/// Written by slice and again by export.
constexpr std::array kFormats{"png", "png-indexed", "png-coverage", "xml", "vdb", "tiff", "sl1", "vti", "nrrd"};

/// A build that all tests of this file read.
class Export : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    // A build keeps no lines but those in the middle of pixels, so with more of them coverage would differ.
    std::string command =
        "slice " + boxes() + " --pitch 1 --layer-height 2 --coverage-rows 1 -o " + quoted(*folder_ / "build");
    for (const char* format : kFormats) command += " --" + std::string(format) + " " + quoted(*folder_ / format);
    const CommandResult result = run_lamella(command);
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  static void TearDownTestSuite() { delete folder_; }

  static std::string build() { return quoted(*folder_ / "build"); }
  static const TemporaryFolder& folder() { return *folder_; }

 private:
  static inline TemporaryFolder* folder_ = nullptr;
};

TEST_F(Export, GivesTheBytesThatSliceWrote) {
  for (const std::string format : kFormats) {
    const auto out = folder() / ("again-" + format);
    const CommandResult result =
        run_lamella("export " + build() + " --to " + format + " -o " + quoted(out) + " --json");
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const Json report = parse_output(result);
    expect_keys(report, {"format", "files"});
    EXPECT_EQ(report["format"], format);
    ASSERT_FALSE(report["files"].empty());
    for (const Json& file : report["files"]) {
      expect_keys(file, {"path", "bytes"});
      const std::filesystem::path path = file["path"].get<std::string>();
      EXPECT_EQ(std::filesystem::file_size(path), file["bytes"].get<std::uintmax_t>());
      if (format == "vdb") continue;  // holds a unique id of its own
      const auto first = std::filesystem::is_directory(out) ? folder() / format / std::filesystem::relative(path, out)
                                                            : folder() / format;
      EXPECT_EQ(contents(path), contents(first)) << path;
    }
  }
}

TEST_F(Export, NeverWritesOverTheBuild) {
  const auto before = contents_below(folder() / "build");
  for (const std::string place : {"build.xml", "run.json", "layers.h5", "layers/000000.h5", "layers/x.xml", "layers"}) {
    for (const std::string& verb : {"export " + build() + " --to xml", "view " + build(),
                                    "export " + build() + " --to sl1", "plan " + build() + " --machine m.xml"}) {
      const CommandResult result = run_lamella(verb + " -o " + quoted(folder() / "build" / place));
      EXPECT_EQ(result.exit_code, 1) << verb << ' ' << place;
      EXPECT_THAT(result.errors, HasSubstr("overwrite an input"));
    }
  }
  EXPECT_EQ(contents_below(folder() / "build"), before);
  // Beside its files there is room.
  EXPECT_EQ(run_lamella("export " + build() + " --to xml -o " + quoted(folder() / "build" / "slices.xml")).exit_code,
            0);
  std::filesystem::remove(folder() / "build" / "slices.xml");
}

TEST_F(Export, CoverageOfMoreLinesNeedsSlicing) {
  const CommandResult result =
      run_lamella("export " + build() + " --to png-coverage --coverage-rows 8 -o " + quoted(folder() / "more-lines"));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("slice with --png-coverage"));
  for (const char* wrong : {"0", "2.5", "65"}) {
    const CommandResult refused = run_lamella("slice " + boxes() + " --png-coverage " +
                                              quoted(folder() / "more-lines") + " --coverage-rows " + wrong);
    EXPECT_EQ(refused.exit_code, 1) << wrong;
  }
}

TEST_F(Export, AMetaImageIsTwoFiles) {
  const auto out = folder() / "labels.mhd";
  const CommandResult result = run_lamella("export " + build() + " --to mhd -o " + quoted(out) + " --json");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const Json report = parse_output(result);
  ASSERT_EQ(report["files"].size(), 2U);
  EXPECT_EQ(report["files"][1]["path"], (folder() / "labels.zraw").string());
}

TEST_F(Export, PolyjetPicturesOfAnotherLatticeAreExitCodeOneAndWriteNothing) {
  const auto out = folder() / "polyjet";
  const CommandResult result = run_lamella("export " + build() + " --to polyjet -o " + quoted(out));
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("--dpi 600,300"));
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(Export, ARangeOfTooFewPolyjetSlicesLeavesAnEarlierStack) {
  const auto fine = quoted(folder() / "fine");
  const CommandResult sliced =
      run_lamella("slice " + boxes() + " --dpi 600,300 --layer-height 0.027 -o " + fine + " --quiet");
  ASSERT_EQ(sliced.exit_code, 0) << sliced.errors;
  const auto out = folder() / "stack";
  const std::string command = "export " + fine + " --to polyjet -o " + quoted(out) + " --layers ";
  ASSERT_EQ(run_lamella(command + "20:50").exit_code, 0);
  const std::string before = contents(out / "layers.csv");
  const CommandResult refused = run_lamella(command + "50:79");
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.errors, HasSubstr("at least 30 slices, here are 29"));
  EXPECT_EQ(contents(out / "layers.csv"), before);
  EXPECT_TRUE(std::filesystem::exists(out / "layer_29.png"));
}

TEST_F(Export, LayerRangesAreHalfOpen) {
  const auto out = folder() / "range";
  const CommandResult result =
      run_lamella("export " + build() + " --to png-indexed -o " + quoted(out) + " --layers 1:3");
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  std::size_t images = 0;
  for (const std::string& name : files_below(out)) images += name.ends_with(".png") ? 1 : 0;
  EXPECT_EQ(images, 2U);
}

TEST_F(Export, ARangeBehindTheEndIsExitCodeOne) {
  const CommandResult result =
      run_lamella("export " + build() + " --to xml -o " + quoted(folder() / "x.xml") + " --layers 100000:");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.errors, HasSubstr("layers"));
}

TEST_F(Export, RefusesToWriteOverTheBuild) {
  const CommandResult result = run_lamella("export " + build() + " --to png -o " + build());
  EXPECT_EQ(result.exit_code, 1) << result.errors;
  EXPECT_TRUE(std::filesystem::exists(folder() / "build/build.xml"));
}

TEST_F(Export, AFolderThatIsNoBuildIsExitCodeTwo) {
  const CommandResult result =
      run_lamella("export " + quoted(folder() / "png") + " --to xml -o " + quoted(folder() / "y.xml"));
  EXPECT_EQ(result.exit_code, 2) << result.errors;
}

}  // namespace
}  // namespace lamella::test
