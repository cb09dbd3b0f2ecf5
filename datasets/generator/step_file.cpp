#include "datasets/generator/step_file.h"

#include <APIHeaderSection_MakeHeader.hxx>
#include <Interface_Static.hxx>
#include <STEPCAFControl_Controller.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelMap.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopLoc_Location.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "datasets/generator/step_text.h"

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
    materials_ = XCAFDoc_DocumentTool::MaterialTool(document_->Main());
    for (const Part& part : set.parts) part_labels_.push_back(add_part(part));
    for (const Node& node : set.shared) shared_labels_.push_back(add_assembly(node));
    add_assembly(set.root);
    shapes_->UpdateAssemblies();
  }

  [[nodiscard]] const Handle(TDocStd_Document) & handle() const { return document_; }

 private:
  TDF_Label add_part(const Part& part) {
    const TDF_Label label = shapes_->AddShape(part.shape, false);
    set_name(label, part.name);
    materials_->SetMaterial(label, text(part.material.name), text(part.material.name), part.material.density,
                            text("density measure"), text("POSITIVE_RATIO_MEASURE"));
    return label;
  }

  TDF_Label add_assembly(const Node& node) {
    const TDF_Label label = shapes_->NewShape();
    set_name(label, node.name);
    for (const Node& child : node.children) {
      set_name(shapes_->AddComponent(label, product_of(child), TopLoc_Location(child.placement)), child.name);
    }
    return label;
  }

  TDF_Label product_of(const Node& instance) {
    if (instance.part >= 0) return part_labels_[instance.part];
    return instance.shared >= 0 ? shared_labels_[instance.shared] : add_assembly(instance);
  }

  const DataSet& set_;
  Handle(TDocStd_Document) document_;
  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_MaterialTool) materials_;
  std::vector<TDF_Label> part_labels_;
  std::vector<TDF_Label> shared_labels_;
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

/// Colours of the parts in the order in which their shapes are written: that of their first use.
std::vector<Rgb> part_colors(const DataSet& set) {
  std::vector<Rgb> colors;
  std::vector<int> seen;
  for (const int part : walk(set)) {
    if (std::find(seen.begin(), seen.end(), part) != seen.end()) continue;
    seen.push_back(part);
    colors.push_back(set.parts[part].material.color);
  }
  return colors;
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
  writer.SetColorMode(false);  // the order of the colours it writes depends on addresses
  writer.SetMaterialMode(true);
  if (!writer.Transfer(document.handle(), STEPControl_AsIs)) throw std::runtime_error(set.name + ": transfer failed");
  set_header(writer.ChangeWriter(), set);
  if (writer.Write(path.c_str()) != IFSelect_RetDone) throw std::runtime_error("can't write " + path.string());
  std::string fixed = normalised(read_all(path));
  fixed = with_colors(fixed, part_colors(set));
  for (const Mirror& m : set.mirrored) fixed = with_mirrored_instance(fixed, m.instance, m.shift);
  std::ofstream out(path, std::ios::binary | std::ios::trunc);
  out << fixed;
  if (!out.flush()) throw std::runtime_error("can't write " + path.string());
}

}  // namespace lamella::datasets
