#include "materials/material_rules.h"
#include "tests/support/schema_samples.h"

namespace lamella {
namespace {

TEST(MaterialsSchema, SchemaAndReaderJudgeTheSamplesAlike) {
  test::expect_samples_to_be_judged("materials", 4, 40, read_material_rules);
}

}  // namespace
}  // namespace lamella
