#include <gmock/gmock.h>

#include "tests/apps/command_json.h"

namespace lamella::test {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;

/// Starts a long run, sends it `signals` once `ready` (a shell test) holds, and prints its exit code.
CommandResult interrupt(const std::string& arguments, const std::string& ready, const std::string& signals) {
  const TemporaryFolder folder;
  write_text(folder / "run.sh", quoted(lamella_binary()) + " " + arguments +
                                    " &\npid=$!\n"
                                    "for i in $(seq 600); do if " +
                                    ready + "; then break; fi; sleep 0.05; done\n" + signals +
                                    "\nwait $pid\necho exit $?\n");
  return run_command("bash " + quoted(folder / "run.sh"));
}

std::string long_run(const TemporaryFolder& folder) {
  return "slice " + quoted(datasets_dir() / "overmoulded_grip/overmoulded_grip.step") +
         " --pitch 0.02 --layer-height 0.02 -o " + quoted(folder / "build") + " --png " + quoted(folder / "png") +
         " --xml " + quoted(folder / "s.xml") + " --vdb " + quoted(folder / "v.vdb");
}

/// A shell test that holds once the first images are there.
std::string has_images(const TemporaryFolder& folder) {
  return "ls " + quoted(folder / "png") + "/*/*.png >/dev/null 2>&1";
}

TEST(Cancel, InTheMiddleLeavesNothingHalfWritten) {
  for (const std::string signal : {"INT", "TERM"}) {
    const TemporaryFolder folder;
    const CommandResult result = interrupt(long_run(folder), has_images(folder), "kill -" + signal + " $pid");
    EXPECT_THAT(result.output, HasSubstr("exit 130")) << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("lamella: error: cancelled"));
    EXPECT_THAT(files_below(folder.path()), Each(Not(HasSubstr(".part-"))));
    EXPECT_FALSE(std::filesystem::exists(folder / "build/build.xml"));
    EXPECT_FALSE(std::filesystem::exists(folder / "s.xml"));
    EXPECT_FALSE(std::filesystem::exists(folder / "v.vdb"));
  }
}

TEST(Cancel, IsJsonToo) {
  const TemporaryFolder folder;
  const CommandResult result = interrupt(long_run(folder) + " --json", has_images(folder), "kill -INT $pid");
  EXPECT_THAT(result.output, HasSubstr("\"code\":130"));
}

TEST(Cancel, AlsoStopsTheSearchForAnOrientation) {
  const TemporaryFolder folder;
  const CommandResult result = interrupt("orient " + quoted(datasets_dir() / "nested_spheres/nested_spheres.step") +
                                             " --gap 1e-9 --page " + quoted(folder / "page.html"),
                                         "sleep 1.5", "kill -INT $pid");
  EXPECT_THAT(result.output, HasSubstr("exit 130")) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("lamella: error: cancelled"));
  EXPECT_THAT(files_below(folder.path()), ::testing::IsEmpty());
}

/// A run whose adaptive layers take long to choose, its messages in a file.
std::string long_choice(const TemporaryFolder& folder) {
  return "slice " + quoted(datasets_dir() / "impeller_135/impeller_135.step") +
         " --pitch 1 --adaptive 0.05 --adaptive-range 0.002,1.2 --adaptive-step 0.002 -o " + quoted(folder / "build") +
         " --png " + quoted(folder / "png") + " --adaptive-chart " + quoted(folder / "chart.svg");
}

TEST(Cancel, WhileLayersAreChosenLeavesNothing) {
  for (const std::string stage : {"bounding normals", "choosing layers"}) {
    const TemporaryFolder messages;
    const TemporaryFolder folder;
    const std::string errors = quoted(messages / "errors.txt");
    const CommandResult result =
        interrupt(long_choice(folder) + " 2> " + errors, "grep -q '" + stage + "' " + errors, "kill -INT $pid");
    EXPECT_THAT(result.output, HasSubstr("exit 130")) << stage;
    const std::string said = contents(messages / "errors.txt");
    EXPECT_THAT(said, HasSubstr(stage));
    EXPECT_THAT(said, HasSubstr("lamella: error: cancelled"));
    EXPECT_THAT(said, Not(HasSubstr("slicing")));
    EXPECT_THAT(files_below(folder.path()), ::testing::IsEmpty()) << stage;
  }
}

TEST(Cancel, OfAnAccuracyStudyLeavesNothing) {
  const TemporaryFolder folder;
  const CommandResult result =
      interrupt("accuracy " + quoted(datasets_dir() / "nested_spheres/nested_spheres.step") +
                    " --deflections 0.002 -o " + quoted(folder / "page.html") + " --keep-stl " + quoted(folder / "stl"),
                "sleep 2", "kill -INT $pid");
  EXPECT_THAT(result.output, HasSubstr("exit 130")) << result.errors;
  EXPECT_THAT(result.errors, HasSubstr("tessellating"));
  EXPECT_THAT(files_below(folder.path()), ::testing::IsEmpty());
}

TEST(Progress, ALongRunSpeaksWithinItsFirstSecondAndNotTooOften) {
  const TemporaryFolder folder;
  const CommandResult result = interrupt(long_run(folder), "sleep 3", "kill -INT $pid");
  std::size_t lines = 0;
  for (std::size_t at = result.errors.find("lamella: info: "); at != std::string::npos;
       at = result.errors.find("lamella: info: ", at + 1)) {
    ++lines;
  }
  EXPECT_GE(lines, 2U) << result.errors;
  EXPECT_LE(lines, 8U) << result.errors;
  EXPECT_EQ(result.errors.find('\r'), std::string::npos);
}

}  // namespace
}  // namespace lamella::test
