#include "materials/machine.h"
#include "tests/support/schema_samples.h"

namespace lamella {
namespace {

namespace fs = std::filesystem;

TEST(MachineSchema, SchemaAndReaderJudgeTheSamplesAlike) {
  test::expect_samples_to_be_judged("machine", 4, 50, read_machine);
}

TEST(MachineSchema, TheShippedMachinesAreValid) {
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(test::datasets_dir() / "machines")) {
    EXPECT_TRUE(test::schema_accepts("machine", entry.path())) << entry.path();
    EXPECT_TRUE(test::reader_accepts(read_machine, entry.path())) << entry.path();
    ++count;
  }
  EXPECT_GE(count, 4U);
}

}  // namespace
}  // namespace lamella
