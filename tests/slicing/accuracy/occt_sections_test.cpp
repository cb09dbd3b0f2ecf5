#include "tests/slicing/accuracy/occt_sections.h"

#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <gtest/gtest.h>

#include "core/geometry.h"
#include "tests/slicing/accuracy/compare_sections.h"
#include "tests/support/step_scenes.h"

namespace lamella::test {
namespace {

// The oracle itself against closed forms.
TEST(OcctSection, HasTheAreaOfClosedForms) {
  const OcctSection disc = occt_section(BRepPrimAPI_MakeSphere(5.0).Shape(), 3.0);
  EXPECT_TRUE(disc.is_whole);
  EXPECT_NEAR(disc.area, 16.0 * kPi, 1e-6);
  EXPECT_NEAR(disc.length, 8.0 * kPi, 1e-5);
  const OcctSection ring = occt_section(BRepPrimAPI_MakeTorus(10.0, 2.0).Shape(), 1.0);
  EXPECT_TRUE(ring.is_whole);
  EXPECT_NEAR(ring.area, 4.0 * kPi * 10.0 * std::sqrt(3.0), 1e-5);
  const OcctSection square = occt_section(BRepPrimAPI_MakeBox(gp_Pnt(100.0, 50.0, 0.0), 2.0, 3.0, 4.0).Shape(), 1.5);
  EXPECT_TRUE(square.is_whole);
  EXPECT_NEAR(square.area, 6.0, 1e-10);
  EXPECT_EQ(occt_section(BRepPrimAPI_MakeBox(1.0, 1.0, 1.0).Shape(), 3.0).area, 0.0);
}

class SectionsOfFiles : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(SectionsOfFiles, HaveOpenCascadesAreas) {
  const SectionComparison found = compare_sections(GetParam(), 6, 10.0);
  std::size_t compared = 0;
  for (const ComparedSection& section : found.sections) {
    if (!section.is_whole) continue;
    ++compared;
    // Within 1e-6 mm of border: arcs are good to 1e-7 mm, OpenCASCADE's ends of edges to about that of the file.
    EXPECT_LE(section.difference(), 1e-6 * section.length + 1e-9)
        << "solid " << section.solid << " z " << section.z << ": " << section.area << ", " << section.occt;
  }
  EXPECT_GT(compared, found.sections.size() / 2);
}

INSTANTIATE_TEST_SUITE_P(DataSets, SectionsOfFiles, ::testing::ValuesIn(dataset_files()),
                         [](const auto& file) { return test_name(file.param); });

}  // namespace
}  // namespace lamella::test
