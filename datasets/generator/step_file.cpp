#include "datasets/generator/step_file.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelMap.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cstdio>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace lamella::datasets {
namespace {

Handle(TCollection_HAsciiString) text(const std::string& s) { return new TCollection_HAsciiString(s.c_str()); }

void set_name(const TDF_Label& label, const std::string& name) {
  TDataStd_Name::Set(label, TCollection_ExtendedString(name.c_str(), true));
}

/// The XCAF document of a data set.
class Document {
 public:
  explicit Document(const DataSet& set) : set_(set), document_(new TDocStd_Document("BinXCAF")) {
    shapes_ = XCAFDoc_DocumentTool::ShapeTool(document_->Main());
    colors_ = XCAFDoc_DocumentTool::ColorTool(document_->Main());
    materials_ = XCAFDoc_DocumentTool::MaterialTool(document_->Main());
    for (const Part& part : set.parts) part_labels_.push_back(add_part(part));
    add_assembly(set.root);
    shapes_->UpdateAssemblies();
  }

  [[nodiscard]] const Handle(TDocStd_Document) & handle() const { return document_; }

 private:
  TDF_Label add_part(const Part& part) {
    const TDF_Label label = shapes_->AddShape(part.shape, false);
    set_name(label, part.name);
    const auto& c = part.material.color;
    colors_->SetColor(label, Quantity_Color(c[0], c[1], c[2], Quantity_TOC_sRGB), XCAFDoc_ColorGen);
    materials_->SetMaterial(label, text(part.material.name), text(part.material.name), part.material.density,
                            text("density measure"), text("POSITIVE_RATIO_MEASURE"));
    return label;
  }

  TDF_Label add_assembly(const Node& node) {
    const TDF_Label label = shapes_->NewShape();
    set_name(label, node.name);
    for (const Node& child : node.children) {
      const TDF_Label target = child.part >= 0 ? part_labels_[child.part] : add_assembly(child);
      set_name(shapes_->AddComponent(label, target, TopLoc_Location(child.placement)), child.name);
    }
    return label;
  }

  const DataSet& set_;
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  Handle(XCAFDoc_MaterialTool) materials_;
  std::vector<TDF_Label> part_labels_;
};

void set_header(STEPControl_Writer& writer, const DataSet& set) {
  APIHeaderSection_MakeHeader header(writer.Model());
  header.SetName(text(set.name + ".step"));
  header.SetTimeStamp(text("2026-01-01T00:00:00"));
  header.SetAuthorValue(1, text("Lamella"));
  header.SetOrganizationValue(1, text("Lamella"));
  header.SetPreprocessorVersion(text("OpenCASCADE"));
  header.SetOriginatingSystem(text("Lamella data sets"));
  header.SetAuthorisation(text(""));
  header.SetDescriptionValue(1, text(set.description));
}

/// The UTF-8 sequence at `at`, which is moved past it.
unsigned code_point(const std::string& utf8, std::size_t& at) {
  const auto lead = static_cast<unsigned char>(utf8[at++]);
  const int more = lead >= 0xF0 ? 3 : lead >= 0xE0 ? 2 : 1;
  unsigned value = lead & (0x3Fu >> more);
  for (int i = 0; i < more; ++i) value = value << 6 | (static_cast<unsigned char>(utf8.at(at++)) & 0x3Fu);
  return value;
}

/// Runs of non-ASCII characters as \X2\....\X0\, four hex digits each (all our names lie in the basic plane).
std::string part21_text(const std::string& utf8) {
  std::string result;
  bool wide = false;
  for (std::size_t at = 0; at < utf8.size();) {
    const bool ascii = static_cast<unsigned char>(utf8[at]) < 0x80;
    if (ascii == wide) result += wide ? "\\X0\\" : "\\X2\\";
    wide = !ascii;
    if (ascii) {
      result += utf8[at++];
    } else {
      char digits[8];
      std::snprintf(digits, sizeof digits, "%04X", code_point(utf8, at));
      result += digits;
    }
  }
  return result;
}

std::string read_all(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

}  // namespace

void write_step(const DataSet& set, const std::filesystem::path& path) {
  STEPCAFControl_Controller::Init();
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", set.unit == "inch" ? "INCH" : "MM");
  Interface_Static::SetIVal("write.step.assembly", 1);
  const Document document(set);
  STEPCAFControl_Writer writer;
  writer.SetNameMode(true);
  writer.SetColorMode(true);
  writer.SetMaterialMode(true);
  if (!writer.Transfer(document.handle(), STEPControl_AsIs)) throw std::runtime_error(set.name + ": transfer failed");
  set_header(writer.ChangeWriter(), set);
  if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("can't write " + path.string());
  const std::string fixed = normalised(read_all(path));
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << fixed;
  if (!out.flush()) throw std::runtime_error("can't write " + path.string());
}

std::string normalised(const std::string& step_text) {
  static const std::regex grams(R"(DERIVED_UNIT_ELEMENT\((#\d+),3\.\))");
  static const std::regex centimetres(R"(DERIVED_UNIT_ELEMENT\((#\d+),2\.\))");
  const std::string fixed = std::regex_replace(step_text, grams, "DERIVED_UNIT_ELEMENT($1,1.)");
  return part21_text(std::regex_replace(fixed, centimetres, "DERIVED_UNIT_ELEMENT($1,-3.)"));
}

}  // namespace lamella::datasets
