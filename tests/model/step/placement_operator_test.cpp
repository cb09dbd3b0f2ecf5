#include <BRepPrimAPI_MakeBox.hxx>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <regex>

#include "core/error.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "tests/model/step/step_files.h"
#include "tests/support/paths.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

class PlacementOperator : public ::testing::Test {
 protected:
  /// Two instances of a box of x 1-2, y 1-3, z 1-4; the second is placed by an operator with these
  /// attributes after the names, and #900001 to #900004 as +x, +y, -y, +z, #900005 as the origin.
  [[nodiscard]] std::filesystem::path file_with(const std::string& attributes) const {
    const TopoDS_Shape box = BRepPrimAPI_MakeBox(gp_Pnt(1, 1, 1), gp_Pnt(2, 3, 4)).Shape();
    test::write_step(folder_ / "plain.step", {{box, "box"}, {box, "box"}});
    std::string text = test::read_text(folder_ / "plain.step");
    const std::regex placement(R"((#\d+) = ITEM_DEFINED_TRANSFORMATION\([^;]*;)");
    std::smatch last;
    for (std::sregex_iterator it(text.begin(), text.end(), placement), end; it != end; ++it) last = *it;
    const std::string statement = last[1].str() + " = CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',''," + attributes +
                                  ");\n#900001 = DIRECTION('',(1.,0.,0.));\n#900002 = DIRECTION('',(0.,1.,0.));\n"
                                  "#900003 = DIRECTION('',(0.,-1.,0.));\n#900004 = DIRECTION('',(0.,0.,1.));\n"
                                  "#900005 = CARTESIAN_POINT('',(0.,0.,0.));";
    text.replace(static_cast<std::size_t>(last.position()), static_cast<std::size_t>(last.length()), statement);
    test::write_text(folder_ / "placed.step", text);
    return folder_ / "placed.step";
  }

  [[nodiscard]] static Scene read(const std::filesystem::path& path) { return read_step({&path, 1}); }

  test::TemporaryFolder folder_;
};

// The import makes the same place of both, since it takes axes 1 and 3 only.
TEST_F(PlacementOperator, AMirrorImageInYOfAPartInPlaceIsReadAsOne) {
  const Scene scene = read(file_with("#900001,#900003,#900005,1.,#900004"));
  ASSERT_EQ(scene.solids.size(), 2U);
  const Box3 left = measure_solid(scene, SolidId{0}).bounds, right = measure_solid(scene, SolidId{1}).bounds;
  EXPECT_NEAR((left.min() - Vec3(1, 1, 1)).norm() + (left.max() - Vec3(2, 3, 4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((right.min() - Vec3(1, -3, 1)).norm() + (right.max() - Vec3(2, -1, 4)).norm(), 0.0, 1e-12);
  EXPECT_NEAR(measure_solid(scene, SolidId{1}).volume, 6.0, 1e-12);
}

TEST_F(PlacementOperator, ARightHandedOneIsAPlacementLikeAnyOther) {
  const Scene scene = read(file_with("#900004,#900001,#900005,1.,#900002"));  // x y z become z x y
  ASSERT_EQ(scene.solids.size(), 2U);
  const Box3 bounds = measure_solid(scene, SolidId{1}).bounds;
  EXPECT_NEAR((bounds.min() - Vec3(1, 1, 1)).norm() + (bounds.max() - Vec3(3, 4, 2)).norm(), 0.0, 1e-12);
}

// Without its placement the part would lie at the origin, and nothing would show it.
TEST_F(PlacementOperator, APlacementThatLacksAPartIsRefusedByName) {
  std::string text = test::read_text(file_with("#900001,#900002,#900005,1.,#900004"));
  const std::regex link(R"((REPRESENTATION_RELATIONSHIP\('[^']*','[^']*',#\d+,)#\d+)");
  test::write_text(folder_ / "broken.step", std::regex_replace(text, link, "$1#999999"));
  try {
    (void)read(folder_ / "broken.step");
    ADD_FAILURE() << "read without a placement";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("placement"));
    EXPECT_THAT(error.where(), ::testing::ContainsRegex("#[0-9]+"));
  }
}

// The import leaves out the factor.
TEST_F(PlacementOperator, AScaledInstanceIsRefusedByName) {
  try {
    (void)read(file_with("#900001,#900002,#900005,2.,#900004"));
    FAIL() << "read as if it weren't scaled";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("scaled by 2"));
    EXPECT_THAT(error.where(), HasSubstr("CARTESIAN_TRANSFORMATION_OPERATOR_3D"));
  }
}

}  // namespace
}  // namespace lamella
