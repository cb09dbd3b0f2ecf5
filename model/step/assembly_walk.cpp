#include "model/step/assembly_walk.h"

#include <BRep_Builder.hxx>
#include <Quantity_Color.hxx>
#include <TColStd_HSequenceOfExtendedString.hxx>
#include <TCollection_ExtendedString.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDataStd_TreeNode.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_MapOfShape.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFDoc.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_LayerTool.hxx>
#include <XCAFDoc_Material.hxx>
#include <XCAFDoc_MaterialTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <cmath>
#include <gp.hxx>
#include <gp_Ax2.hxx>
#include <map>

#include "model/step/text.h"

namespace lamella::step {
namespace {

/// What an assembly hands down to its parts.
struct Inherited {
  std::string path;
  TopLoc_Location place;
  std::optional<Color> color;
  std::string layer;
  int depth = 0;
};

std::string to_utf8(const TCollection_ExtendedString& text) {
  std::vector<char> buffer(static_cast<std::size_t>(text.LengthOfCString()) + 1);
  Standard_PCharacter begin = buffer.data();
  text.ToUTF8CString(begin);
  return clean_name(buffer.data());
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  return label.FindAttribute(TDataStd_Name::GetID(), name) ? to_utf8(name->Get()) : std::string();
}

/// The names with ".1", ".2" ... after those that come more than once.
std::vector<std::string> numbered(const std::vector<std::string>& names) {
  std::map<std::string, int> total;
  for (const std::string& name : names) ++total[name];
  std::map<std::string, int> seen;
  std::vector<std::string> result;
  for (const std::string& name : names) {
    result.push_back(total[name] == 1 ? name : name + "." + std::to_string(++seen[name]));
  }
  return result;
}

class AssemblyWalk {
 public:
  AssemblyWalk(const Handle(TDocStd_Document) & document, const EntityIndex& entities, const MaterialOf& material_of)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())),
        layers_(XCAFDoc_DocumentTool::LayerTool(document->Main())),
        entities_(entities),
        material_of_(material_of) {}

  Assembly run(std::span<const RootPlace> places) {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const RootPlace& place : places) {
      Inherited from;
      from.path = place.path;
      from.place = place.location;
      visit_all(roots, from);
    }
    return std::move(assembly_);
  }

 private:
  void visit_all(const TDF_LabelSequence& labels, const Inherited& from);
  void visit(const TDF_Label& instance, const TDF_Label& part, Inherited from);
  void add_part(const TDF_Label& part, const Inherited& from);
  void add_loose(const TopoDS_Shape& shape, const std::string& fallback, const SolidInfo& common);
  void note_face_colors(const TDF_Label& part);
  SolidSource source_of(const TopoDS_Shape& shape, const SolidInfo& common) const;
  std::optional<Color> color_of(const TDF_Label& label) const;
  std::optional<Color> common_face_color(const TopoDS_Shape& shape) const;
  std::string layer_of(const TDF_Label& label) const;
  void read_material(const TDF_Label& part, const TopoDS_Shape& shape, SolidInfo& info) const;

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  Handle(XCAFDoc_LayerTool) layers_;
  const EntityIndex& entities_;
  const MaterialOf& material_of_;
  Assembly assembly_;
};

TDF_Label referred(const TDF_Label& label) {
  TDF_Label part;
  return XCAFDoc_ShapeTool::GetReferredShape(label, part) ? part : label;
}

TopLoc_Location mirror_in_y() {
  gp_Trsf mirror;
  mirror.SetMirror(gp_Ax2(gp::Origin(), gp::DY()));
  return mirror;
}

void AssemblyWalk::visit_all(const TDF_LabelSequence& labels, const Inherited& from) {
  std::vector<std::string> names;
  for (const TDF_Label& label : labels) {
    std::string name = name_of(referred(label));
    if (name.empty()) name = name_of(label);
    names.push_back(path_component(name, "part"));
  }
  names = numbered(names);
  for (int i = 1; i <= labels.Length(); ++i) {
    Inherited child = from;
    (child.path += '/') += names[i - 1];
    visit(labels.Value(i), referred(labels.Value(i)), std::move(child));
  }
}

void AssemblyWalk::visit(const TDF_Label& instance, const TDF_Label& part, Inherited from) {
  if (++from.depth > kMaxAssemblyDepth) {
    throw InputError("the assembly is nested deeper than " + std::to_string(kMaxAssemblyDepth) + " levels",
                     from.path.substr(0, 200), "does it contain itself?");
  }
  // An instance's own style wins over the part's, the part's over what the assembly hands down.
  for (const TDF_Label& label : {part, instance}) {
    if (const auto color = color_of(label)) from.color = color;
    if (const std::string layer = layer_of(label); !layer.empty()) from.layer = layer;
  }
  if (instance != part) {
    const TopLoc_Location place = XCAFDoc_ShapeTool::GetLocation(instance);
    from.place = from.place * place;
    if (entities_.is_mirrored(place)) from.place = from.place * mirror_in_y();
  }
  if (!XCAFDoc_ShapeTool::IsAssembly(part)) return add_part(part, from);
  TDF_LabelSequence components;
  XCAFDoc_ShapeTool::GetComponents(part, components);
  visit_all(components, from);
}

std::optional<Color> AssemblyWalk::color_of(const TDF_Label& label) const {
  Quantity_Color color;
  for (const auto type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
    if (!colors_->GetColor(label, type, color)) continue;
    Color rgb{};
    color.Values(rgb[0], rgb[1], rgb[2], Quantity_TOC_sRGB);
    // The import keeps single precision; steps of 1/65535 hold every 8-bit and 16-bit colour exactly.
    constexpr double kSteps = 65535.0;
    for (double& channel : rgb) channel = std::round(channel * kSteps) / kSteps;
    return rgb;
  }
  return std::nullopt;
}

std::string AssemblyWalk::layer_of(const TDF_Label& label) const {
  const Handle(TColStd_HSequenceOfExtendedString) names = layers_->GetLayers(label);
  return names.IsNull() || names->IsEmpty() ? std::string() : to_utf8(names->First());
}

void AssemblyWalk::note_face_colors(const TDF_Label& part) {
  TDF_LabelSequence labels;
  XCAFDoc_ShapeTool::GetSubShapes(part, labels);
  for (const TDF_Label& label : labels) {
    const auto color = color_of(label);
    if (!color) continue;
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull() || shape.ShapeType() > TopAbs_FACE) continue;
    assembly_.colors.emplace(shape.TShape().get(), *color);
  }
}

std::optional<Color> AssemblyWalk::common_face_color(const TopoDS_Shape& shape) const {
  std::optional<Color> common;
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const auto color = assembly_.colors.find(it.Current().TShape().get());
    if (color == assembly_.colors.end() || (common && *common != color->second)) return std::nullopt;
    common = color->second;
  }
  return common;
}

void AssemblyWalk::read_material(const TDF_Label& part, const TopoDS_Shape& shape, SolidInfo& info) const {
  if (const auto raw = material_of_(entities_.product_definition(shape))) {
    info.step_material = raw->name;
    info.step_density = raw->density;
  }
  if (!info.step_material.empty()) return;
  Handle(TDataStd_TreeNode) node;
  Handle(XCAFDoc_Material) material;
  if (!part.FindAttribute(XCAFDoc::MaterialRefGUID(), node) || !node->HasFather()) return;
  if (!node->Father()->Label().FindAttribute(XCAFDoc_Material::GetID(), material)) return;
  if (!material->GetName().IsNull()) info.step_material = clean_name(material->GetName()->ToCString());
}

SolidSource AssemblyWalk::source_of(const TopoDS_Shape& shape, const SolidInfo& common) const {
  SolidSource source{shape, common};
  const EntityRef entity = entities_.item(shape);
  source.info.step_entity = entity.number;
  const auto own = assembly_.colors.find(shape.TShape().get());
  if (own != assembly_.colors.end()) {
    source.info.color = own->second;
  } else if (const auto color = common_face_color(shape)) {
    source.info.color = color;
  }
  const TDF_Label label = shapes_->FindShape(shape.Located(TopLoc_Location()), Standard_False);
  if (const std::string layer = label.IsNull() ? std::string() : layer_of(label); !layer.empty()) {
    source.info.layer = layer;
  }
  return source;
}

void AssemblyWalk::add_part(const TDF_Label& part, const Inherited& from) {
  const TopoDS_Shape bare = XCAFDoc_ShapeTool::GetShape(part);
  if (bare.IsNull()) return;
  note_face_colors(part);
  SolidInfo common;
  common.name = name_of(part);
  const std::string fallback = from.path.substr(from.path.rfind('/') + 1);
  common.path = from.path;
  common.color = from.color;
  common.layer = from.layer;
  read_material(part, bare, common);

  const TopoDS_Shape placed = bare.Moved(from.place, Standard_False);
  std::vector<TopoDS_Shape> solids;
  TopTools_MapOfShape seen;
  for (TopExp_Explorer it(placed, TopAbs_SOLID); it.More(); it.Next()) {
    if (seen.Add(it.Current())) solids.push_back(it.Current());
  }
  std::vector<std::string> names;
  for (const TopoDS_Shape& solid : solids) names.push_back(path_component(entities_.item(solid).name, "solid"));
  const std::vector<std::string> bodies = numbered(names);
  for (std::size_t i = 0; i < solids.size(); ++i) {
    SolidSource source = source_of(solids[i], common);
    const std::string own_name = entities_.item(solids[i]).name;
    if (!own_name.empty() && (solids.size() > 1 || common.name.empty())) source.info.name = own_name;
    if (source.info.name.empty()) source.info.name = fallback;
    if (solids.size() > 1 || (!own_name.empty() && own_name != common.name)) (source.info.path += '/') += bodies[i];
    assembly_.solids.push_back(std::move(source));
    if (assembly_.solids.size() > kMaxSolids)
      throw InputError("the assembly holds more than 2 million solids", from.path);
  }
  add_loose(placed, fallback, common);
}

void AssemblyWalk::add_loose(const TopoDS_Shape& shape, const std::string& fallback, const SolidInfo& common) {
  int count = 0;
  const auto add = [&](const TopoDS_Shape& piece, const std::string& word) {
    SolidSource source = source_of(piece, common);
    const std::string own_name = entities_.item(piece).name;
    if (source.info.name.empty()) source.info.name = own_name.empty() ? fallback : own_name;
    source.info.status = SolidStatus::open;
    source.info.closed = false;
    (source.info.path += '/') += path_component(own_name, word) + "." + std::to_string(++count);
    assembly_.loose.push_back(std::move(source));
  };
  for (TopExp_Explorer it(shape, TopAbs_SHELL, TopAbs_SOLID); it.More(); it.Next()) add(it.Current(), "shell");
  TopoDS_Compound faces;
  BRep_Builder builder;
  builder.MakeCompound(faces);
  bool any = false;
  for (TopExp_Explorer it(shape, TopAbs_FACE, TopAbs_SHELL); it.More(); it.Next()) {
    builder.Add(faces, it.Current());
    any = true;
  }
  if (any) add(faces, "faces");
}

}  // namespace

Assembly walk_assembly(const Handle(TDocStd_Document) & document, const EntityIndex& entities,
                       const MaterialOf& material_of, std::span<const RootPlace> places) {
  return AssemblyWalk(document, entities, material_of).run(places);
}

}  // namespace lamella::step
