#include "slicing/failed_checks.h"

#include <gtest/gtest.h>

namespace lamella {
namespace {

Scene two_faces() {
  Scene scene;
  const SolidId solid = scene.solids.push_back({});
  scene.solids[solid].info.path = "housing/lid";
  for (const int entity : {17, 0}) {
    Face face;
    face.step_entity = entity;
    scene.faces.push_back(face);
  }
  scene.faces[FaceId{0}].name = "rim";
  return scene;
}

TEST(FailedChecks, NamesSolidFaceAndLayer) {
  FailedChecks checks;
  checks.add({Check::balance, SolidId{0}, FaceId{0}, 3}, 7, 0.75);
  checks.add({Check::balance, SolidId{0}, FaceId{0}, 2}, 9, 0.95);
  checks.add({Check::winding, SolidId{0}, FaceId{1}, 1, 0.25}, 9, 0.95);
  std::vector<Finding> findings;
  checks.report(two_faces(), findings);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].solid, "housing/lid");
  EXPECT_EQ(findings[0].face, "rim");
  EXPECT_EQ(findings[0].entity, "#17");
  EXPECT_NE(findings[0].what.find("layer 7 (z = 0.75 mm) and 1 more, rows: 5"), std::string::npos) << findings[0].what;
  EXPECT_NE(findings[1].what.find("layer 9 (z = 0.95 mm), rows: 1, over 0.25 mm at most"), std::string::npos)
      << findings[1].what;
  EXPECT_TRUE(findings[1].entity.empty());
}

TEST(FailedChecks, CountTwoLatticesOfALayerOnce) {
  FailedChecks checks;
  checks.add({Check::closure, SolidId{0}, {}, 1}, 4, 0.5);
  checks.add({Check::closure, SolidId{0}, {}, 1}, 4, 0.5);
  std::vector<Finding> findings;
  checks.report(two_faces(), findings);
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_NE(findings[0].what.find("layer 4 (z = 0.5 mm), rows: 2"), std::string::npos) << findings[0].what;
  EXPECT_TRUE(findings[0].face.empty());
}

TEST(FailedChecks, ReportIsBounded) {
  Scene scene = two_faces();
  FailedChecks checks;
  for (int i = 0; i < 50; ++i) scene.faces.push_back({});
  for (std::size_t i = 0; i < 50; ++i) checks.add({Check::arcs, SolidId{0}, FaceId{i}, 1}, 1, 0.1);
  std::vector<Finding> findings;
  checks.report(scene, findings);
  ASSERT_EQ(findings.size(), 21U);
  EXPECT_NE(findings.back().what.find("30 more"), std::string::npos);
}

}  // namespace
}  // namespace lamella
