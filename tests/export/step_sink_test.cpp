/// STEP files of layers as OpenCASCADE's document reader sees them: products, layers, colours, and the area that
/// each material fills on each layer, against the rows of the build.

#include <BRepAdaptor_Curve.hxx>
#include <BRepTools_WireExplorer.hxx>
#include <BRep_Tool.hxx>
#include <GeomAbs_CurveType.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TCollection_AsciiString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Iterator.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <array>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "export/step_entities.h"
#include "slicing/store/store.h"
#include "tests/support/command.h"

namespace lamella::test {
namespace {

using ::testing::HasSubstr;

/// What encloses a material on a layer.
struct Outline {
  double area = 0.0;    ///< mm^2, holes taken off
  double width = 0.0;   ///< mm: sum of the sides' lengths along x
  double length = 0.0;  ///< mm
  std::size_t loops = 0;
};

struct Product {
  std::size_t sets = 0;                       ///< parts of its shape
  std::vector<std::array<double, 3>> colors;  ///< of those that have one, sRGB
  std::set<std::string> layers;
  std::map<double, Outline> outlines;  ///< by height
};

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  std::string text(static_cast<std::size_t>(name->Get().LengthOfCString()), '\0');
  char* place = text.data();
  name->Get().ToUTF8CString(place);
  return text;
}

/// Adds a closed polygon, which comes as a spline of degree 1.
void add_edge(const TopoDS_Edge& edge, std::map<double, Outline>& outlines) {
  double first = 0.0;
  double last = 0.0;
  const Handle(Geom_BSplineCurve) curve = Handle(Geom_BSplineCurve)::DownCast(BRep_Tool::Curve(edge, first, last));
  ASSERT_FALSE(curve.IsNull());
  ASSERT_EQ(curve->Degree(), 1);
  Outline& outline = outlines[curve->Pole(1).Z()];
  ++outline.loops;
  for (int i = 1; i < curve->NbPoles(); ++i) {
    const gp_Pnt a = curve->Pole(i);
    const gp_Pnt b = curve->Pole(i + 1);
    ASSERT_EQ(a.Z(), b.Z());
    outline.area += 0.5 * (a.X() * b.Y() - b.X() * a.Y());
    outline.width += std::abs(b.X() - a.X());
    outline.length += a.Distance(b);
  }
  ASSERT_LT(curve->Pole(1).Distance(curve->Pole(curve->NbPoles())), 1e-12);
}

std::map<std::string, Product> read_products(const std::filesystem::path& file) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  STEPCAFControl_Reader reader;
  reader.SetLayerMode(true);
  reader.SetColorMode(true);
  std::map<std::string, Product> products;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  EXPECT_TRUE(reader.Transfer(document));
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  const auto layers = XCAFDoc_DocumentTool::LayerTool(document->Main());
  const auto colors = XCAFDoc_DocumentTool::ColorTool(document->Main());
  TDF_LabelSequence labels;
  shapes->GetFreeShapes(labels);
  for (const TDF_Label& label : labels) {
    Product& product = products[name_of(label)];
    for (TopoDS_Iterator set(shapes->GetShape(label)); set.More(); set.Next()) {
      ++product.sets;
      if (Quantity_Color color; colors->GetColor(set.Value(), XCAFDoc_ColorCurv, color)) {
        auto& rgb = product.colors.emplace_back();
        color.Values(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB);
      }
      Handle(TColStd_HSequenceOfExtendedString) of_set;
      if (!layers->GetLayers(set.Value(), of_set)) continue;
      for (const TCollection_ExtendedString& layer : *of_set)
        product.layers.insert(TCollection_AsciiString(layer).ToCString());
    }
    for (TopExp_Explorer edge(shapes->GetShape(label), TopAbs_EDGE); edge.More(); edge.Next())
      add_edge(TopoDS::Edge(edge.Current()), product.outlines);
  }
  return products;
}

/// Slices a data set and writes STEP in the same pass.
void slice(const std::string& name, const std::string& options, const TemporaryFolder& folder) {
  const std::filesystem::path set = datasets_dir() / name;
  const CommandResult run =
      run_lamella("slice " + quoted(set / (name + ".step")) + " --materials " + quoted(set / "materials.xml") + " -o " +
                  quoted(folder / "build") + " --step " + quoted(folder / "a.step") + " --quiet " + options);
  ASSERT_EQ(run.exit_code, 0) << run.errors;
}

void expect_layers_of(const std::string& name, const std::string& options) {
  const TemporaryFolder folder;
  slice(name, options, folder);
  const std::map<std::string, Product> products = read_products(folder / "a.step");
  const StoreReader build(folder / "build");
  const double pitch = build.info().plan.grid.pitch.y();
  const double chord_error = *build.info().plan.chord_error;
  std::size_t compared = 0;
  for (std::uint32_t k = 0; k < build.info().plan.layers.size(); ++k) {
    const Layer layer = build.read_layer(k);
    std::vector<double> by_rows(build.info().materials.size());
    for (const Segment& segment : layer.raster.segments)
      by_rows[segment.material.value()] += (segment.x_end - segment.x_begin) * pitch;
    for (const MaterialId material : build.info().materials.ids()) {
      const Product& product = products.at(build.info().materials[material].name);
      Outline outline;
      for (const auto& [z, found] : product.outlines)
        if (std::abs(z - layer.z_sample) < 2e-6) outline = found;
      // Midpoint sums are off by half a pitch times the variation of the width; rows know nothing of chords.
      const double bound = 0.5 * pitch * outline.width + 2.0 * chord_error * (outline.length + 1.0);
      EXPECT_NEAR(outline.area, by_rows[material.value()], bound) << "layer " << k;
      compared += outline.loops;
    }
  }
  EXPECT_GT(compared, 2 * build.info().plan.layers.size());
}

TEST(StepSink, OpenCascadeReadsTheAreaOfEveryMaterialOnEveryLayer) {
  expect_layers_of("interpenetrating_bodies", "--layer-height 1.3 --pitch 0.1");
  expect_layers_of("overmoulded_grip", "--layer-height 4 --pitch 0.2");
}

TEST(StepSink, OpenCascadeReadsColoursAndLayersOfEveryMaterial) {
  const TemporaryFolder folder;
  slice("nested_spheres", "--layer-height 3 --pitch 1", folder);
  const std::map<std::string, Product> products = read_products(folder / "a.step");
  const StoreReader build(folder / "build");
  ASSERT_EQ(products.size(), build.info().materials.size());
  for (const Material& material : build.info().materials) {
    const Product& product = products.at(material.name);
    ASSERT_GT(product.sets, 2u);
    EXPECT_EQ(product.colors.size(), product.sets);
    for (const auto& color : product.colors) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(color[c], material.color[c], 1e-4);
    }
    EXPECT_EQ(product.layers.size(), product.sets);
  }
  // Layers of 3 mm through a ball of 28 mm; the middle of the tenth lies above it.
  EXPECT_EQ(products.at("Borosilicate glass").layers.size(), 9u);
  EXPECT_EQ(products.at("Borosilicate glass").layers.count("layer 7"), 1u);
}

/// What encloses a material on a layer, of curves.
struct CurveArea {
  double area = 0.0;  ///< mm^2
  std::map<GeomAbs_CurveType, std::size_t> edges;
  double largest_gap = 0.0;  ///< mm, between an edge's end and the next one's begin
};

/// The integral of x dy - y dx over an edge, halved: Simpson's rule on pieces of what is smooth.
double swept_by(const BRepAdaptor_Curve& curve) {
  double sum = 0.0;
  std::vector<double> breaks;
  TColStd_Array1OfReal knots(1, curve.NbIntervals(GeomAbs_C2) + 1);
  curve.Intervals(knots, GeomAbs_C2);
  for (int i = knots.Lower(); i < knots.Upper(); ++i) {
    constexpr int kSteps = 200;
    const double step = (knots(i + 1) - knots(i)) / kSteps;
    for (int k = 0; k <= kSteps; ++k) {
      gp_Pnt p;
      gp_Vec v;
      curve.D1(knots(i) + k * step, p, v);
      const double weight = k == 0 || k == kSteps ? 1.0 : k % 2 == 1 ? 4.0 : 2.0;
      sum += weight * step / 3.0 * 0.5 * (p.X() * v.Y() - p.Y() * v.X());
    }
  }
  return sum;
}

void add_loop_of_curves(const TopoDS_Shape& loop, CurveArea& out) {
  std::vector<std::pair<gp_Pnt, gp_Pnt>> ends;
  for (BRepTools_WireExplorer edge(TopoDS::Wire(loop)); edge.More(); edge.Next()) {
    const BRepAdaptor_Curve curve(edge.Current());
    ASSERT_EQ(edge.Current().Orientation(), TopAbs_FORWARD);
    ++out.edges[curve.GetType()];
    out.area += swept_by(curve);
    ends.emplace_back(curve.Value(curve.FirstParameter()), curve.Value(curve.LastParameter()));
  }
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const double gap = ends[i].second.Distance(ends[(i + 1) % ends.size()].first);
    out.largest_gap = std::max(out.largest_gap, gap);
  }
}

/// By material, then by height to 1e-5 mm.
std::map<std::string, std::map<long, CurveArea>> read_curves(const std::filesystem::path& file) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("MDTV-XCAF", document);
  STEPCAFControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  EXPECT_TRUE(reader.Transfer(document));
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  TDF_LabelSequence labels;
  shapes->GetFreeShapes(labels);
  std::map<std::string, std::map<long, CurveArea>> areas;
  for (const TDF_Label& label : labels) {
    auto& by_height = areas[name_of(label)];
    const auto place = [&](const TopoDS_Edge& edge) -> CurveArea& {
      const BRepAdaptor_Curve curve(edge);
      return by_height[std::lround(curve.Value(curve.FirstParameter()).Z() * 1e5)];
    };
    for (TopExp_Explorer wire(shapes->GetShape(label), TopAbs_WIRE); wire.More(); wire.Next()) {
      const TopExp_Explorer edge(wire.Current(), TopAbs_EDGE);
      add_loop_of_curves(wire.Current(), place(TopoDS::Edge(edge.Current())));
    }
    for (TopExp_Explorer edge(shapes->GetShape(label), TopAbs_EDGE, TopAbs_WIRE); edge.More(); edge.Next()) {
      CurveArea& area = place(TopoDS::Edge(edge.Current()));
      const BRepAdaptor_Curve curve(TopoDS::Edge(edge.Current()));
      ++area.edges[curve.GetType()];
      area.area += swept_by(curve);
    }
  }
  return areas;
}

/// Areas of a material's layers by its name, from the curves of a file sliced at a chord error.
std::map<std::string, std::map<long, CurveArea>> curves_at(const std::string& name, const std::string& chord_error,
                                                           const TemporaryFolder& folder) {
  slice(name, "--layer-height 1.3 --pitch 1 --curves --contours " + chord_error, folder);
  return read_curves(folder / "a.step");
}

TEST(StepSink, SectionsOfSpheresAreCirclesOfTheExactRadius) {
  const TemporaryFolder folder;
  const auto found = curves_at("nested_spheres", "0.3", folder);
  const StoreReader build(folder / "build");
  std::size_t compared = 0;
  for (const auto& [name, layers] : found) {
    for (const auto& [height, curves] : layers) {
      EXPECT_EQ(curves.edges.size(), 1U);
      EXPECT_EQ(curves.edges.count(GeomAbs_Circle), 1U);
    }
  }
  // The envelope is what its outer sphere holds and the shield's doesn't; both touch the bounds.
  const auto disc = [&](const char* path, double z) {
    for (const BuildSolid& solid : build.info().solids) {
      if (solid.path != path) continue;
      const double radius = 0.5 * solid.bounds.sizes().z();
      const double off = z - solid.bounds.center().z();
      return M_PI * std::max(0.0, radius * radius - off * off);
    }
    ADD_FAILURE() << path;
    return 0.0;
  };
  for (const LayerSpan& layer : build.info().plan.layers) {
    const double z = layer.z_sample;
    const double bubble = M_PI * std::max(0.0, 1.25 * 1.25 - z * z);  // in the envelope, at half its height
    const double area = disc("/Nested spheres/Envelope", z) - disc("/Nested spheres/Shield", z) - bubble;
    EXPECT_NEAR(found.at("Borosilicate glass").at(std::lround(z * 1e5)).area, area, 1e-8 * area) << z;
    ++compared;
  }
  EXPECT_GT(compared, 20U);
}

/// Curves don't depend on how finely the loops were broken into chords, and end where they cross. Where solids touch,
/// which of them a stretch is of may depend on it.
void expect_same_at_any_chord_error(const std::string& name, double tolerance, GeomAbs_CurveType kind,
                                    bool has_same_edges) {
  const TemporaryFolder coarse_folder;
  const TemporaryFolder fine_folder;
  const auto coarse = curves_at(name, "0.1", coarse_folder);
  const auto fine = curves_at(name, "0.001", fine_folder);
  ASSERT_EQ(coarse.size(), fine.size());
  std::size_t compared = 0;
  std::size_t of_kind = 0;
  for (const auto& [material, layers] : fine) {
    ASSERT_EQ(coarse.at(material).size(), layers.size()) << material;
    for (const auto& [height, curves] : layers) {
      const CurveArea& other = coarse.at(material).at(height);
      EXPECT_NEAR(curves.area, other.area, tolerance) << material << ' ' << height;
      if (has_same_edges) {
        EXPECT_EQ(curves.edges, other.edges) << material << ' ' << height;
      }
      EXPECT_LE(std::max(curves.largest_gap, other.largest_gap), 1e-6) << material << ' ' << height;
      const auto found = curves.edges.find(kind);
      if (found != curves.edges.end()) of_kind += found->second;
      ++compared;
    }
  }
  EXPECT_GT(compared, 25U);
  EXPECT_GT(of_kind, 20U);
}

TEST(StepSink, CurvesOfOverlappingSolidsEndWhereTheyCross) {
  expect_same_at_any_chord_error("interpenetrating_bodies", 1e-8, GeomAbs_Circle, true);
}

TEST(StepSink, SplinesOfFreeFormSectionsHaveTheAreaOfTheExactSections) {
  expect_same_at_any_chord_error("overmoulded_grip", 2e-4, GeomAbs_BSplineCurve, false);
  const TemporaryFolder folder;
  const auto found = curves_at("overmoulded_grip", "0.1", folder);
  const StoreReader build(folder / "build");
  std::size_t compared = 0;
  for (std::uint32_t k = 0; k < build.info().plan.layers.size(); ++k) {
    const Layer layer = build.read_layer(k);
    std::map<std::string, double> exact;
    for (const ContourLoop& loop : layer.contours->loops)
      exact[build.info().materials[build.info().solids[loop.solid].material].name] += loop.area;
    for (const char* alone : {"PA6-GF30", "Steel S2"}) {  // nothing takes of these
      if (exact.count(alone) == 0) continue;
      const double area = found.at(alone).at(std::lround(layer.z_sample * 1e5)).area;
      EXPECT_NEAR(area, exact[alone], 1e-7 * (1.0 + exact[alone])) << alone << ' ' << layer.z_sample;
      ++compared;
    }
  }
  EXPECT_GT(compared, 10U);
}

TEST(StepEntities, WriteTextAsTheFormatWantsIt) {
  EXPECT_EQ(step_string("it's \\ \xC3\xBC"), "'it''s \\\\ \\X2\\00FC\\X0\\'");
  EXPECT_EQ(step_string("\xF0\x9F\x94\xA9\xFF\n"), "'\\X4\\0001F529\\X0\\\\X2\\FFFD\\X0\\\\X2\\000A\\X0\\'");
  EXPECT_EQ(step_real(12.0), "12.");
  EXPECT_EQ(step_real(-0.05), "-0.05");
  EXPECT_EQ(step_exact_real(-0.1), "-0.1");
  EXPECT_EQ(step_exact_real(3.0), "3.");
  EXPECT_EQ(step_exact_real(1e-7), "1.E-07");
  EXPECT_EQ(step_exact_real(1.0 / 3.0), "0.3333333333333333");
}

}  // namespace
}  // namespace lamella::test
