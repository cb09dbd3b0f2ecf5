/// STEP files of layers as OpenCASCADE's document reader sees them: products, layers, colours, and the area that
/// each material fills on each layer, against the rows of the build.

#include <BRep_Tool.hxx>
#include <Geom_BSplineCurve.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
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

TEST(StepEntities, WriteTextAsTheFormatWantsIt) {
  EXPECT_EQ(step_string("it's \\ \xC3\xBC"), "'it''s \\\\ \\X2\\00FC\\X0\\'");
  EXPECT_EQ(step_string("\xF0\x9F\x94\xA9\xFF\n"), "'\\X4\\0001F529\\X0\\\\X2\\FFFD\\X0\\\\X2\\000A\\X0\\'");
  EXPECT_EQ(step_real(12.0), "12.");
  EXPECT_EQ(step_real(-0.05), "-0.05");
}

}  // namespace
}  // namespace lamella::test
