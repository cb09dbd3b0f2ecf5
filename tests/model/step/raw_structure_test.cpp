#include "model/step/raw_structure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace lamella::step {
namespace {

using ::testing::HasSubstr;

std::string file_of(const std::string& data) {
  return "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n" + data + "\nENDSEC;\nEND-ISO-10303-21;\n";
}

/// What the check says about the text; empty when it passes.
std::string complaint(const std::string& text) {
  try {
    const Part21 file(text);
    require_step_text(file, "part.step");
    require_acyclic(file, "part.step", {});
  } catch (const InputError& error) {
    return std::string(error.what()) + " (" + error.where() + ")";
  }
  return {};
}

TEST(RawStructure, NamesACircleOfShapes) {
  const std::string said =
      complaint(file_of("#1=PLANE('',#2);\n#2=OFFSET_SURFACE('',#3,1.,.F.);\n#3=OFFSET_SURFACE('',#2,1.,.F.);"));
  EXPECT_THAT(said, HasSubstr("#2 OFFSET_SURFACE -> #3 OFFSET_SURFACE -> #2"));
  EXPECT_THAT(said, HasSubstr("line 6"));
}

TEST(RawStructure, NamesAnAssemblyThatContainsItself) {
  const std::string said = complaint(file_of(
      "#1=PRODUCT_DEFINITION('','',$,$);#2=PRODUCT_DEFINITION('','',$,$);"
      "#3=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#1,#2,$);#4=NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#2,#1,$);"));
  EXPECT_THAT(said, HasSubstr("contains itself"));
}

TEST(RawStructure, LetsHarmlessCirclesPass) {
  EXPECT_EQ(complaint(file_of("#1=REPRESENTATION('density',(#1),$);")), "");
}

TEST(RawStructure, FollowsLongChainsWithoutRecursion) {
  std::string data;
  for (int i = 1; i < 300000; ++i) data += "#" + std::to_string(i) + "=OFFSET_CURVE(#" + std::to_string(i + 1) + ");\n";
  EXPECT_EQ(complaint(file_of(data)), "");
}

TEST(RawStructure, SaysWhatIsNoStepFile) {
  EXPECT_THAT(complaint("solid cube\nfacet normal 0 0 1\n"), HasSubstr("not a STEP file"));
  EXPECT_THAT(complaint(""), HasSubstr("not a STEP file"));
  EXPECT_THAT(complaint("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=A();\n"), HasSubstr("ends in the middle"));
  EXPECT_THAT(complaint("ISO-10303-21;\nDATA;\n#1=A('x',#2 ENDSEC;\nEND-ISO-10303-21;\n"), HasSubstr("line 3"));
  EXPECT_THAT(complaint(file_of("")), HasSubstr("no entity"));
  EXPECT_EQ(complaint("/* made by hand */\n" + file_of("#1=A();")), "");
}

TEST(RawStructure, ListsGeometryThatLacksWhatItIsMadeOfUpToTheFace) {
  const std::string text = file_of(
      "#1=VERTEX_POINT('',#9);#2=EDGE_CURVE('',#1,#1,$,.T.);#3=ORIENTED_EDGE('',*,*,#2,.T.);#4=EDGE_LOOP('',(#3));"
      "#5=FACE_BOUND('',#4,.T.);#6=ADVANCED_FACE('',(#5),#8,.T.);#7=CLOSED_SHELL('',(#6));#8=CARTESIAN_POINT($,(0.));");
  const Part21 file(text);
  std::vector<int> numbers;
  for (const RefusedEntity& entity : broken_geometry(file, {})) numbers.push_back(entity.number);
  EXPECT_EQ(numbers, (std::vector<int>{1, 2, 3, 4, 5, 6})) << "a shell is borne without a face";
}

TEST(RawStructure, ListsVerticesWithoutAPointInSpace) {
  const std::string text = file_of("#1=VERTEX_POINT('',#2);#2=CARTESIAN_POINT('',(0.,0.));");
  EXPECT_EQ(broken_geometry(Part21(text), {}).size(), 1U);
}

TEST(RawStructure, FindsCurvesAndColoursThatLackTheirParts) {
  const std::string text = file_of(
      "#1=PCURVE('',#9,#2);#2=DEFINITIONAL_REPRESENTATION('',(#8),#9);#9=PLANE('',$);"
      "#3=STYLED_ITEM('',(#4),$);#4=PRESENTATION_STYLE_ASSIGNMENT((#5));#5=SURFACE_STYLE_USAGE(.BOTH.,#8);");
  EXPECT_EQ(broken_geometry(Part21(text), {}).size(), 5U) << "the plane lacks nothing";
}

/// The reason for refusing entity #1 of the data, empty if it isn't refused.
std::string refusal(const std::string& data) {
  const std::string text = file_of(data);
  for (const RefusedEntity& entity : broken_geometry(Part21(text), {})) {
    if (entity.number == 1) return entity.reason;
  }
  return {};
}

TEST(RawStructure, FindsSplinesWhoseListsDontMatch) {
  const std::string point = "#2=CARTESIAN_POINT('',(0.,0.,0.));";
  const auto surface = [&](const std::string& net, const std::string& knots) {
    return refusal("#1=B_SPLINE_SURFACE_WITH_KNOTS('',1,1," + net + ",.UNSPECIFIED.,.F.,.F.,.F.," + knots +
                   ",.UNSPECIFIED.);" + point);
  };
  EXPECT_EQ(surface("((#2,#2),(#2,#2))", "(2,2),(2,2),(0.,1.),(0.,1.)"), "");
  EXPECT_THAT(surface("((#2,#2),(#2))", "(2,2),(2,2),(0.,1.),(0.,1.)"), HasSubstr("grid"));
  EXPECT_THAT(surface("((#2,#2),#2)", "(2,2),(2,2),(0.,1.),(0.,1.)"), HasSubstr("grid"));
  EXPECT_THAT(surface("((#2,#2),(#2,#2))", "(2,2),(2,2,2),(0.,1.),(0.,1.)"), HasSubstr("multiplicity"));
  const auto curve = [&](const std::string& lists, const std::string& weights) {
    return refusal("#1=(BOUNDED_CURVE()B_SPLINE_CURVE(1,(#2,#2),.UNSPECIFIED.,.F.,.F.)B_SPLINE_CURVE_WITH_KNOTS(" +
                   lists + ",.UNSPECIFIED.)RATIONAL_B_SPLINE_CURVE(" + weights + "));" + point);
  };
  EXPECT_EQ(curve("(2,2),(0.,1.)", "(1.,1.)"), "");
  EXPECT_THAT(curve("(2,2),(0.,1.)", "(1.)"), HasSubstr("weight"));
  EXPECT_THAT(curve("(2,2,2),(0.,1.)", "(1.,1.)"), HasSubstr("multiplicity"));
  EXPECT_THAT(curve("(),()", "(1.,1.)"), HasSubstr("empty"));
}

TEST(RawStructure, FindsPointsWithoutCoordinates) {
  EXPECT_THAT(refusal("#1=DIRECTION('',( ));"), HasSubstr("coordinates"));
  EXPECT_THAT(refusal("#1=CARTESIAN_POINT('',());"), HasSubstr("coordinates"));
  EXPECT_EQ(refusal("#1=CARTESIAN_POINT('()',(1.,2.));"), "");
}

TEST(RawStructure, FindsAProductsShapeThatLacksItsDefinition) {
  EXPECT_THAT(refusal("#1=SHAPE_DEFINITION_REPRESENTATION(#4,#2);#2=SHAPE_REPRESENTATION('',(),$);"), HasSubstr("#4"));
}

TEST(RawStructure, TakesTheImportsRefusalsForCausesButNotThoseOfNames) {
  const std::string text = file_of("#1=LINE('',#2,#2);#2=CARTESIAN_POINT($,(0.,0.,0.));");
  const Part21 file(text);
  EXPECT_TRUE(broken_geometry(file, {{2, "Parameter n0.1 (name) not a quoted String"}}).empty());
  EXPECT_EQ(broken_geometry(file, {{2, "Parameter n0.2 (coordinates) not a LIST"}}).size(), 2U) << "the line too";
}

std::string diagnosis(const std::string& data) {
  const std::string text = file_of(data);
  try {
    throw_nothing_readable(Part21(text), "part.step", {});
  } catch (const InputError& error) {
    return std::string(error.what()) + " (" + error.where() + ")";
  }
}

TEST(RawStructure, SaysWhatAFileHoldsInsteadOfSolids) {
  EXPECT_THAT(diagnosis("#7=TESSELLATED_SOLID('',(),$);"), HasSubstr("tessellated"));
  EXPECT_THAT(diagnosis("#7=TESSELLATED_SOLID('',(),$);"), HasSubstr("#7"));
  EXPECT_THAT(diagnosis("#7=OPERATION_SEQUENCE('',());"), HasSubstr("construction history"));
  EXPECT_THAT(diagnosis("#7=DOCUMENT_FILE('../../etc/passwd','','',$,'',$);"), HasSubstr("../../etc/passwd"));
  EXPECT_THAT(diagnosis("#7=MANIFOLD_SOLID_BREP('',#8);"), HasSubstr("without product structure and units"));
  EXPECT_THAT(diagnosis("#7=CARTESIAN_POINT('',(0.,0.,0.));"), HasSubstr("CARTESIAN_POINT"));
}

}  // namespace
}  // namespace lamella::step
