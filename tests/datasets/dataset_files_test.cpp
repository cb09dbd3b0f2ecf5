// The shipped STEP files, read with OpenCASCADE, against the manifest.
#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Common.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepGProp.hxx>
#include <BRep_Tool.hxx>
#include <GProp_GProps.hxx>
#include <GeomLib_IsPlanarSurface.hxx>
#include <Geom_BSplineSurface.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <set>

#include "tests/support/paths.h"

namespace lamella::test {
namespace {

using nlohmann::json;

const json& manifest() {
  static const json content = json::parse(std::ifstream(datasets_dir() / "manifest.json"));
  return content;
}

std::vector<std::string> names() {
  std::vector<std::string> result;
  for (const json& set : manifest()["datasets"]) result.push_back(set["name"]);
  return result;
}

struct ReadSolid {
  std::string name;
  TopoDS_Shape shape;
  std::string material;
  bool colored = false;
};

/// Solids in the order of the assembly walk, placed, with what hangs on their product.
class Walk {
 public:
  explicit Walk(const std::filesystem::path& path) : document_(new TDocStd_Document("BinXCAF")) {
    STEPCAFControl_Controller::Init();
    STEPCAFControl_Reader reader;
    reader.SetNameMode(true);
    reader.SetColorMode(true);
    reader.SetMatMode(true);
    if (reader.ReadFile(path.c_str()) != IFSelect_RetDone || !reader.Transfer(document_)) return;
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (int i = 1; i <= roots.Length(); ++i) visit(roots.Value(i), TopLoc_Location());
  }
  [[nodiscard]] const std::vector<ReadSolid>& solids() const { return solids_; }

 private:
  void visit(const TDF_Label& label, const TopLoc_Location& location) {
    TDF_LabelSequence parts;
    if (XCAFDoc_ShapeTool::GetComponents(label, parts)) {
      for (int i = 1; i <= parts.Length(); ++i) {
        TDF_Label target;
        XCAFDoc_ShapeTool::GetReferredShape(parts.Value(i), target);
        visit(target, location * XCAFDoc_ShapeTool::GetLocation(parts.Value(i)));
      }
      return;
    }
    add(label, location);
  }

  void add(const TDF_Label& label, const TopLoc_Location& location) {
    ReadSolid solid;
    Handle(TDataStd_Name) name;
    if (label.FindAttribute(TDataStd_Name::GetID(), name)) {
      const TCollection_ExtendedString& text = name->Get();
      std::string utf8(text.LengthOfCString(), '\0');
      Standard_PCharacter buffer = utf8.data();
      text.ToUTF8CString(buffer);
      solid.name = utf8;
    }
    Handle(TCollection_HAsciiString) material, description, density_name, density_type;
    double density = 0.0;
    TDF_Label material_label;
    Handle(TDataStd_TreeNode) node;
    if (label.FindAttribute(XCAFDoc::MaterialRefGUID(), node) && node->HasFather() &&
        XCAFDoc_DocumentTool::MaterialTool(document_->Main())
            ->GetMaterial(node->Father()->Label(), material, description, density, density_name, density_type))
      solid.material = material->ToCString();
    Quantity_Color color;
    const auto colors = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    for (const auto kind : {XCAFDoc_ColorGen, XCAFDoc_ColorSurf})
      solid.colored = solid.colored || colors->GetColor(label, kind, color);
    for (TopExp_Explorer e(XCAFDoc_ShapeTool::GetShape(label), TopAbs_SOLID); e.More(); e.Next()) {
      solid.shape = e.Current().Located(location * e.Current().Location());
      solids_.push_back(solid);
    }
  }

  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  std::vector<ReadSolid> solids_;
};

/// With Eps 1e-6 OpenCASCADE itself is off by 1e-5 on revolved splines; 1e-9 brings it near the closed forms.
double occt_volume(const TopoDS_Shape& shape) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties, 1e-9);
  return properties.Mass();
}

class DatasetFile : public testing::TestWithParam<std::string> {
 protected:
  static const json& entry() {
    for (const json& set : manifest()["datasets"])
      if (set["name"] == GetParam()) return set;
    throw std::logic_error("no such data set");
  }
  static std::vector<ReadSolid> read() { return Walk(datasets_dir() / entry()["file"].get<std::string>()).solids(); }
};

TEST_P(DatasetFile, HoldsTheSolidsOfTheManifestWithNameColourAndMaterial) {
  const auto solids = read();
  ASSERT_EQ(solids.size(), entry()["solids"].size());
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const json& expected = entry()["solids"][i];
    EXPECT_EQ(solids[i].name, expected["name"]);
    EXPECT_EQ(solids[i].material, expected["step_material"]);
    EXPECT_TRUE(solids[i].colored) << solids[i].name;
  }
}

TEST_P(DatasetFile, SolidsAreValidClosedAndTight) {
  for (const ReadSolid& solid : read()) {
    EXPECT_TRUE(BRepCheck_Analyzer(solid.shape).IsValid()) << solid.name;
    for (TopExp_Explorer e(solid.shape, TopAbs_SHELL); e.More(); e.Next())
      EXPECT_TRUE(BRep_Tool::IsClosed(e.Current())) << solid.name;
    for (TopExp_Explorer e(solid.shape, TopAbs_EDGE); e.More(); e.Next())
      EXPECT_LT(BRep_Tool::Tolerance(TopoDS::Edge(e.Current())), 1e-4) << solid.name;
  }
}

/// Middles of the chords of a wire's edges, with half the chord: balls that cover the wire.
std::vector<std::pair<gp_Pnt, double>> covering_balls(const TopoDS_Shape& wire) {
  constexpr int kChords = 64;
  std::vector<std::pair<gp_Pnt, double>> balls;
  for (TopExp_Explorer e(wire, TopAbs_EDGE); e.More(); e.Next()) {
    if (BRep_Tool::Degenerated(TopoDS::Edge(e.Current()))) continue;
    const BRepAdaptor_Curve curve(TopoDS::Edge(e.Current()));
    const double step = (curve.LastParameter() - curve.FirstParameter()) / kChords;
    for (int i = 0; i < kChords; ++i) {
      const gp_Pnt a = curve.Value(curve.FirstParameter() + i * step);
      const gp_Pnt b = curve.Value(curve.FirstParameter() + (i + 1) * step);
      balls.emplace_back(gp_Pnt(0.5 * (a.XYZ() + b.XYZ())), 0.51 * a.Distance(b));
    }
  }
  return balls;
}

bool apart(const TopoDS_Shape& a, const TopoDS_Shape& b) {
  const auto first = covering_balls(a), second = covering_balls(b);
  return std::none_of(first.begin(), first.end(), [&](const auto& p) {
    return std::any_of(second.begin(), second.end(),
                       [&](const auto& q) { return p.first.Distance(q.first) <= p.second + q.second; });
  });
}

/// BRepCheck doesn't see a hole that crosses its face's outline; this does.
TEST_P(DatasetFile, LoopsOfAFaceDontMeet) {
  for (const ReadSolid& solid : read()) {
    for (TopExp_Explorer f(solid.shape, TopAbs_FACE); f.More(); f.Next()) {
      std::vector<TopoDS_Shape> wires;
      for (TopExp_Explorer w(f.Current(), TopAbs_WIRE); w.More(); w.Next()) wires.push_back(w.Current());
      for (std::size_t i = 0; i < wires.size(); ++i)
        for (std::size_t k = 0; k < i; ++k) EXPECT_TRUE(apart(wires[i], wires[k])) << solid.name;
    }
  }
}

TEST_P(DatasetFile, VolumesAgreeWithTheExactOnes) {
  const auto solids = read();
  ASSERT_EQ(solids.size(), entry()["solids"].size());
  for (std::size_t i = 0; i < solids.size(); ++i) {
    const double exact = entry()["solids"][i]["volume"];
    EXPECT_NEAR(occt_volume(solids[i].shape) / exact, 1.0, 1e-6) << solids[i].name;
  }
}

TEST_P(DatasetFile, FaceCountsAgree) {
  const auto solids = read();
  ASSERT_EQ(solids.size(), entry()["solids"].size());
  for (std::size_t i = 0; i < solids.size(); ++i) {
    int faces = 0, spline = 0, rational = 0;
    for (TopExp_Explorer e(solids[i].shape, TopAbs_FACE); e.More(); e.Next()) {
      ++faces;
      const auto surface = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(e.Current())));
      spline += !surface.IsNull();
      rational += !surface.IsNull() && (surface->IsURational() || surface->IsVRational());
    }
    const json& expected = entry()["solids"][i];
    EXPECT_EQ(faces, expected["faces"]) << solids[i].name;
    EXPECT_EQ(spline, expected["bspline_faces"]) << solids[i].name;
    EXPECT_EQ(rational, expected["rational_faces"]) << solids[i].name;
  }
}

/// A second opinion on the overlaps; the booleans' own edges limit it to 1e-5.
TEST_P(DatasetFile, OverlapsAgreeWithCommonVolumes) {
  const auto solids = read();
  for (const json& overlap : entry()["overlaps"]) {
    const std::size_t a = overlap["solids"][0], b = overlap["solids"][1];
    ASSERT_LT(std::max(a, b), solids.size());
    const double common = occt_volume(BRepAlgoAPI_Common(solids[a].shape, solids[b].shape).Shape());
    EXPECT_NEAR(common / overlap["volume"].get<double>(), 1.0, 1e-5) << solids[a].name << " and " << solids[b].name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, DatasetFile, testing::ValuesIn(names()), [](const auto& set) { return set.param; });

struct FreeformCounts {
  int faces = 0, spline = 0, rational = 0, curved = 0;
};

FreeformCounts count_freeform(const std::string& name) {
  FreeformCounts counts;
  const Walk walk(datasets_dir() / name / (name + ".step"));
  for (const ReadSolid& solid : walk.solids()) {
    for (TopExp_Explorer e(solid.shape, TopAbs_FACE); e.More(); e.Next()) {
      ++counts.faces;
      const auto surface = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(e.Current())));
      if (surface.IsNull()) continue;
      ++counts.spline;
      counts.rational += surface->IsURational() || surface->IsVRational();
      counts.curved += !GeomLib_IsPlanarSurface(surface, 1e-6).IsPlanar();
    }
  }
  return counts;
}

TEST(FreeformModels, HaveThePapersNumbersOfSurfacesMostCurvedAndAThirdRational) {
  for (const auto& [name, faces] : {std::pair{"turbine_blade_16", 16}, {"housing_102", 102}, {"impeller_135", 135}}) {
    const FreeformCounts counts = count_freeform(name);
    EXPECT_EQ(counts.faces, faces) << name;
    EXPECT_EQ(counts.spline, faces) << name;
    EXPECT_GE(3 * counts.rational, faces) << name;
    EXPECT_GT(2 * counts.curved, faces) << name;
  }
}

TEST(Manifest, DemoHasCurvedFacesAVoidAndAnOverlapInSeveralMaterials) {
  for (const json& set : manifest()["datasets"]) {
    if (set["name"] != "overmoulded_grip") continue;
    std::set<std::string> materials;
    int voids = 0, splines = 0;
    for (const json& solid : set["solids"]) {
      materials.insert(solid["step_material"].get<std::string>());
      voids += solid["shells"].get<int>() - 1;
      splines += solid["bspline_faces"].get<int>();
    }
    EXPECT_GE(materials.size(), 5u);
    EXPECT_GE(voids, 2);
    EXPECT_GE(splines, 1);
    EXPECT_GE(set["overlaps"].size(), 3u);
    return;
  }
  FAIL() << "no overmoulded_grip";
}

TEST(Manifest, AtLeastTenAssembliesTwoOfThemInInchAndAllSmall) {
  int inch = 0;
  std::uintmax_t bytes = 0;
  for (const json& set : manifest()["datasets"]) {
    inch += set["unit"] == "inch";
    bytes += std::filesystem::file_size(datasets_dir() / set["file"].get<std::string>());
  }
  EXPECT_GE(manifest()["datasets"].size(), 13u);
  EXPECT_GE(inch, 2);
  EXPECT_LT(bytes, 5'000'000u);
}

}  // namespace
}  // namespace lamella::test
