#include "tests/model/step/step_files.h"

#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

namespace lamella::test {
namespace {

class Document {
 public:
  Document() {
    Message::DefaultMessenger()->ChangePrinters().Clear();
    XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document_);
  }
  ~Document() { XCAFApp_Application::GetApplication()->Close(document_); }
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  [[nodiscard]] TDF_Label main() const { return document_->Main(); }
  void write(const std::filesystem::path& path) {
    XCAFDoc_DocumentTool::ShapeTool(main())->UpdateAssemblies();
    STEPCAFControl_Writer writer;
    ASSERT_TRUE(writer.Transfer(document_));
    ASSERT_EQ(writer.Write(path.c_str()), IFSelect_RetDone);
  }

 private:
  Handle(TDocStd_Document) document_;
};

void set_name(const TDF_Label& label, const std::string& name) {
  TDataStd_Name::Set(label, TCollection_ExtendedString(name.c_str(), Standard_True));
}

}  // namespace

void write_step(const std::filesystem::path& path, const std::vector<Component>& components) {
  Document document;
  const auto shapes = XCAFDoc_DocumentTool::ShapeTool(document.main());
  if (components.size() == 1) {
    set_name(shapes->AddShape(components[0].shape, Standard_False), components[0].name);
  } else {
    const TDF_Label assembly = shapes->NewShape();
    set_name(assembly, "assembly");
    for (const Component& component : components) {
      const TDF_Label part = shapes->AddShape(component.shape.Located(TopLoc_Location()), Standard_False);
      set_name(part, component.name);
      shapes->AddComponent(assembly, part, component.shape.Location());
    }
  }
  document.write(path);
}

void write_part(const std::filesystem::path& path, const TopoDS_Shape& shape, const std::string& name,
                const std::vector<double>& rgb, const std::string& layer, const PartMaterial& material) {
  Document document;
  const TDF_Label part = XCAFDoc_DocumentTool::ShapeTool(document.main())->AddShape(shape, Standard_False);
  set_name(part, name);
  XCAFDoc_DocumentTool::ColorTool(document.main())
      ->SetColor(part, Quantity_Color(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB), XCAFDoc_ColorSurf);
  XCAFDoc_DocumentTool::LayerTool(document.main())->SetLayer(part, TCollection_ExtendedString(layer.c_str()));
  XCAFDoc_DocumentTool::MaterialTool(document.main())
      ->SetMaterial(part, new TCollection_HAsciiString(material.name.c_str()), new TCollection_HAsciiString(""),
                    material.density, new TCollection_HAsciiString("density measure"),
                    new TCollection_HAsciiString("POSITIVE_RATIO_MEASURE"));
  document.write(path);
}

std::string read_text(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "no " << from;
  for (; at != std::string::npos; at = text.find(from, at + to.size())) text.replace(at, from.size(), to);
  return text;
}

}  // namespace lamella::test
