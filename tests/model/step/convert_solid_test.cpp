#include "model/step/convert_solid.h"

#include <BRepAlgoAPI_Cut.hxx>
#include <BRepBuilderAPI_MakeEdge.hxx>
#include <BRepBuilderAPI_MakeFace.hxx>
#include <BRepBuilderAPI_MakeWire.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepGProp.hxx>
#include <BRepPrimAPI_MakeBox.hxx>
#include <BRepPrimAPI_MakeCone.hxx>
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakePrism.hxx>
#include <BRepPrimAPI_MakeRevol.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <BRepPrimAPI_MakeTorus.hxx>
#include <BRepTools.hxx>
#include <GProp_GProps.hxx>
#include <GeomAPI_PointsToBSpline.hxx>
#include <Geom_BSplineCurve.hxx>
#include <TColgp_Array1OfPnt.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <gp_Pln.hxx>
#include <gtest/gtest.h>
#include <map>

#include "model/evaluate.h"
#include "model/measure.h"
#include "model/topology.h"

namespace lamella::step {
namespace {

TopoDS_Face spline_profile() {
  TColgp_Array1OfPnt points(1, 5);
  points(1) = gp_Pnt(2, 0, 0);
  points(2) = gp_Pnt(3, 0, 1);
  points(3) = gp_Pnt(2.5, 0, 2);
  points(4) = gp_Pnt(3.5, 0, 3);
  points(5) = gp_Pnt(2, 0, 4);
  const Handle(Geom_BSplineCurve) spline = GeomAPI_PointsToBSpline(points).Curve();
  BRepBuilderAPI_MakeWire wire(BRepBuilderAPI_MakeEdge(spline).Edge());
  wire.Add(BRepBuilderAPI_MakeEdge(gp_Pnt(2, 0, 4), gp_Pnt(2, 0, 0)).Edge());
  return BRepBuilderAPI_MakeFace(wire.Wire()).Face();
}

/// One solid for every kind of surface, closed faces, seams, poles, holes and a void among them.
std::map<std::string, TopoDS_Shape> solids() {
  std::map<std::string, TopoDS_Shape> result;
  result["box"] = BRepPrimAPI_MakeBox(gp_Pnt(1, 2, 3), gp_Pnt(4, 6, 8)).Shape();
  result["cylinder"] = BRepPrimAPI_MakeCylinder(2, 5).Shape();
  result["cone"] = BRepPrimAPI_MakeCone(2, 0, 5).Shape();
  result["sphere"] = BRepPrimAPI_MakeSphere(gp_Pnt(1, 2, 3), 2).Shape();
  result["torus"] = BRepPrimAPI_MakeTorus(5, 2).Shape();
  result["half torus"] = BRepPrimAPI_MakeTorus(5, 2, 2.0).Shape();
  result["extrusion"] = BRepPrimAPI_MakePrism(spline_profile(), gp_Vec(1, 4, 0)).Shape();
  result["revolution"] = BRepPrimAPI_MakeRevol(spline_profile(), gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1))).Shape();
  result["quarter turn"] = BRepPrimAPI_MakeRevol(spline_profile(), gp_Ax1(gp_Pnt(), gp_Dir(0, 0, 1)), 1.5).Shape();
  result["plate with holes"] =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(10, 10, 2).Shape(),
                      BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(4, 5, -1), gp::DZ()), 2, 5).Shape())
          .Shape();
  result["shell with void"] =
      BRepAlgoAPI_Cut(BRepPrimAPI_MakeSphere(5).Shape(), BRepPrimAPI_MakeBox(gp_Pnt(-1, -1, -1), 2, 2, 2).Shape())
          .Shape();
  return result;
}

std::map<std::string, gp_Trsf> placements() {
  std::map<std::string, gp_Trsf> result;
  result["as it is"] = gp_Trsf();
  gp_Trsf turned;
  turned.SetRotation(gp_Ax1(gp_Pnt(1, 1, 0), gp_Dir(1, -1, 3)), 1.1);
  turned.SetTranslationPart(gp_Vec(5, -7, 11));
  result["turned"] = turned;
  gp_Trsf mirrored;
  mirrored.SetMirror(gp_Ax2(gp_Pnt(0, 1, 2), gp_Dir(1, 2, -1)));
  result["mirrored"] = mirrored;
  result["mirrored and turned"] = turned * mirrored;
  gp_Trsf scaled;
  scaled.SetScale(gp_Pnt(1, 0, 0), 2.5);
  result["scaled"] = scaled;
  gp_Trsf point_mirrored;
  point_mirrored.SetMirror(gp_Pnt(1, 2, 3));
  result["mirrored at a point"] = point_mirrored;
  return result;
}

Scene convert(const TopoDS_Shape& shape) {
  Scene scene;
  for (TopExp_Explorer it(shape, TopAbs_SOLID); it.More(); it.Next()) {
    SolidSource source{it.Current(), {}};
    source.info.path = "/solid";
    append_solid(scene, source, EntityIndex(), FaceColors());
  }
  complete_topology(scene);
  return scene;
}

double volume_of(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-9);
  return properties.Mass();
}

TEST(ConvertSolid, KeepsVolumeAndOrientationUnderEveryPlacement) {
  for (const auto& [name, solid] : solids()) {
    const double volume = volume_of(solid);
    ASSERT_GT(volume, 0.0) << name;
    for (const auto& [word, trsf] : placements()) {
      SCOPED_TRACE(name + ", " + word);
      const Scene scene = convert(solid.Moved(TopLoc_Location(trsf), Standard_False));
      ASSERT_EQ(scene.solids.size(), 1U);
      const SolidInfo& info = scene.solids[SolidId{0}].info;
      EXPECT_EQ(info.status, SolidStatus::ok);
      EXPECT_TRUE(info.closed);
      EXPECT_TRUE(info.healed.empty()) << info.healed.front();
      for (const Finding& finding : scene.findings) ADD_FAILURE() << finding.what;
      const double factor = std::pow(std::abs(trsf.ScaleFactor()), 3);
      EXPECT_NEAR(measure_solid(scene, SolidId{0}).volume, factor * volume, 1e-6 * factor * volume);
    }
  }
}

TEST(ConvertSolid, HalfEdgesFollowTheOutwardNormalHeadToTail) {
  for (const auto& [name, solid] : solids()) {
    SCOPED_TRACE(name);
    const Scene scene = convert(solid);
    for (const LoopId loop : scene.loops.ids()) {
      const IdRange<HalfEdgeId> half_edges = scene.loops[loop].half_edges;
      ASSERT_FALSE(half_edges.empty());
      for (std::uint32_t i = 0; i < half_edges.count; ++i) {
        const HalfEdge& here = scene.half_edges[HalfEdgeId{half_edges.first.value() + i}];
        const HalfEdge& next = scene.half_edges[HalfEdgeId{half_edges.first.value() + (i + 1) % half_edges.count}];
        const auto end = [&scene](const HalfEdge& h, bool head) {
          const Edge& edge = scene.edges[h.edge];
          return h.forward == head ? edge.end : edge.start;
        };
        EXPECT_EQ(end(here, true), end(next, false));
        const Vec2 a = evaluate<2>(here.pcurve, here.forward ? here.prange.hi : here.prange.lo).point;
        const Vec2 b = evaluate<2>(next.pcurve, next.forward ? next.prange.lo : next.prange.hi).point;
        EXPECT_LT((a - b).norm(), 1e-7);
      }
    }
    // Every edge that is no pole is used twice, in opposite senses.
    std::map<EdgeId, int> balance;
    for (const HalfEdge& h : scene.half_edges) balance[h.edge] += h.forward ? 1 : -1;
    for (const auto& [edge, sum] : balance) EXPECT_TRUE(scene.edges[edge].degenerate || sum == 0);
  }
}

TEST(ConvertSolid, BoundsOfTheTrimsHoldThePcurves) {
  const Scene scene = convert(solids()["plate with holes"]);
  for (const FaceId face : scene.faces.ids()) {
    for (const LoopId loop : scene.faces[face].loops) {
      for (const HalfEdgeId id : scene.loops[loop].half_edges) {
        const HalfEdge& h = scene.half_edges[id];
        for (const double s : {0.0, 0.37, 1.0}) {
          const Vec2 uv = evaluate<2>(h.pcurve, h.prange.lo + s * h.prange.length()).point;
          EXPECT_LT(scene.faces[face].uv_bounds.exteriorDistance(uv), 1e-9);
        }
      }
    }
  }
}

TEST(ConvertSolid, PutsTheOuterShellFirst) {
  const Scene scene = convert(solids()["shell with void"]);
  const Solid& solid = scene.solids[SolidId{0}];
  ASSERT_EQ(solid.shells.count, 2U);
  EXPECT_EQ(scene.shells[solid.shells.first].faces.count, 1U) << "the sphere";
  EXPECT_TRUE(scene.shells[ShellId{solid.shells.first.value() + 1}].is_void);
}

TEST(ConvertSolid, NamesAFaceWithoutEnds) {
  const TopoDS_Shape infinite = BRepBuilderAPI_MakeFace(gp_Pln()).Shape();
  Scene scene;
  SolidSource source{infinite, {}};
  source.info.path = "/half space";
  append_solid(scene, source, EntityIndex(), FaceColors());
  ASSERT_EQ(scene.findings.size(), 1U);
  EXPECT_EQ(scene.findings[0].solid, "/half space");
  EXPECT_EQ(scene.solids[SolidId{0}].info.status, SolidStatus::empty);
}

}  // namespace
}  // namespace lamella::step
