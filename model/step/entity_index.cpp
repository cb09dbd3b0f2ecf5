#include "model/step/entity_index.h"

#include <StepBasic_ProductDefinition.hxx>
#include <StepGeom_Surface.hxx>
#include <StepRepr_RepresentationItem.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_Edge.hxx>
#include <StepShape_Face.hxx>
#include <StepShape_SolidModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_Binder.hxx>
#include <algorithm>
#include <optional>

#include "model/step/text.h"

namespace lamella::step {
namespace {

/// The kind of shape an entity stands for; nothing for entities that aren't of interest.
std::optional<TopAbs_ShapeEnum> kind_of(const Handle(Standard_Transient) & entity) {
  if (entity->IsKind(STANDARD_TYPE(StepShape_Face))) return TopAbs_FACE;
  if (entity->IsKind(STANDARD_TYPE(StepShape_ConnectedFaceSet))) return TopAbs_SHELL;
  if (entity->IsKind(STANDARD_TYPE(StepShape_SolidModel))) return TopAbs_SOLID;
  if (entity->IsKind(STANDARD_TYPE(StepShape_Edge))) return TopAbs_EDGE;
  if (entity->IsKind(STANDARD_TYPE(StepGeom_Surface))) return TopAbs_FACE;  // of a set of bare surfaces
  return std::nullopt;
}

}  // namespace

EntityIndex::EntityIndex(const Handle(StepData_StepModel) & model, const Handle(Transfer_TransientProcess) & process,
                         const std::vector<Handle(Standard_Transient)>& mirrored_uses) {
  for (const auto& use : mirrored_uses) {
    const Handle(Transfer_Binder) binder = process->Find(use);
    if (!binder.IsNull()) mirrored_.push_back(TransferBRep::ShapeResult(binder).Location());
  }
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const Handle(Standard_Transient) entity = process->Mapped(i);
    const Handle(Transfer_Binder) binder = process->MapItem(i);
    if (entity.IsNull() || binder.IsNull()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(binder);
    if (shape.IsNull()) continue;
    const int number = model->IdentLabel(entity);
    if (entity->IsKind(STANDARD_TYPE(StepBasic_ProductDefinition))) products_.emplace(key(shape), number);
    const auto kind = kind_of(entity);
    const auto item = Handle(StepRepr_RepresentationItem)::DownCast(entity);
    if (!kind || item.IsNull()) continue;
    const std::string name = item->Name().IsNull() ? std::string() : clean_name(item->Name()->ToCString());
    add_item(shape, *kind, {number, name});
  }
}

void EntityIndex::add_item(const TopoDS_Shape& result, TopAbs_ShapeEnum kind, const EntityRef& entity) {
  // The import may split a face or wrap a solid: everything of the entity's own kind below the result is its.
  for (TopExp_Explorer it(result, kind); it.More(); it.Next()) items_.emplace(key(it.Current()), entity);
}

EntityRef EntityIndex::item(const TopoDS_Shape& shape) const {
  const auto found = items_.find(key(shape));
  return found == items_.end() ? EntityRef{} : found->second;
}

bool EntityIndex::is_mirrored(const TopLoc_Location& place) const {
  return std::any_of(mirrored_.begin(), mirrored_.end(),
                     [&place](const TopLoc_Location& other) { return other.IsEqual(place); });
}

int EntityIndex::product_definition(const TopoDS_Shape& shape) const {
  const auto found = products_.find(key(shape));
  return found == products_.end() ? 0 : found->second;
}

}  // namespace lamella::step
