#include "model/step/placement_operator.h"

#include <STEPConstruct_Assembly.hxx>
#include <StepBasic_ProductDefinitionRelationship.hxx>
#include <StepGeom_CartesianTransformationOperator3d.hxx>
#include <StepGeom_Direction.hxx>
#include <StepRepr_CharacterizedDefinition.hxx>
#include <StepRepr_MappedItem.hxx>
#include <StepRepr_ProductDefinitionShape.hxx>
#include <StepRepr_RepresentationMap.hxx>
#include <StepRepr_ShapeRepresentationRelationshipWithTransformation.hxx>
#include <StepRepr_Transformation.hxx>
#include <StepShape_ContextDependentShapeRepresentation.hxx>
#include <StepShape_ShapeRepresentation.hxx>
#include <cmath>

#include "core/error.h"
#include "core/geometry.h"
#include "model/step/entity_label.h"

namespace lamella::step {
namespace {

using Operator = Handle(StepGeom_CartesianTransformationOperator3d);

Vec3 vector_of(const Handle(StepGeom_Direction) & direction, const Vec3& otherwise) {
  if (direction.IsNull() || direction->NbDirectionRatios() != 3) return otherwise;
  return {direction->DirectionRatiosValue(1), direction->DirectionRatiosValue(2), direction->DirectionRatiosValue(3)};
}

/// Without axis 2 the import's right-handed frame is what every writer means.
bool mirrors(const Operator& op) {
  if (!op->HasAxis2()) return false;
  const Vec3 x = vector_of(op->Axis1(), Vec3::UnitX()), y = vector_of(op->Axis2(), Vec3::UnitY());
  if (op->Axis3().IsNull()) return false;  // the import takes axis 1 x axis 2
  return x.cross(y).dot(vector_of(op->Axis3(), Vec3::UnitZ())) < 0.0;
}

/// Real files write 1 with the digits of their export.
bool scales(const Operator& op) { return op->HasScale() && !(std::abs(op->Scale() - 1.0) <= 1e-9); }

[[noreturn]] void refuse(const Handle(StepData_StepModel) & model, const Operator& op, const std::string& name,
                         const std::string& what) {
  throw InputError(what, name + ", " + label_of(model->IdentLabel(op)) + " CARTESIAN_TRANSFORMATION_OPERATOR_3D",
                   "export the part in its final shape, or place it without");
}

/// The operator that places a mapped item in a shape; null for pictures of it in drawings and notes.
Operator operator_of(const Handle(StepRepr_MappedItem) & item) {
  if (item.IsNull() || item->MappingSource().IsNull()) return {};
  const auto shape = Handle(StepShape_ShapeRepresentation)::DownCast(item->MappingSource()->MappedRepresentation());
  return shape.IsNull() ? Operator() : Operator::DownCast(item->MappingTarget());
}

Operator operator_of(const Handle(StepShape_ContextDependentShapeRepresentation) & placed) {
  if (placed.IsNull()) return {};
  const auto relation =
      Handle(StepRepr_RepresentationRelationshipWithTransformation)::DownCast(placed->RepresentationRelation());
  return relation.IsNull() ? Operator() : Operator::DownCast(relation->TransformationOperator().Value());
}

}  // namespace

std::vector<Handle(Standard_Transient)> mirrored_uses(const Handle(StepData_StepModel) & model,
                                                      const Interface_Graph& graph, const std::string& name) {
  std::vector<Handle(Standard_Transient)> uses;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const auto item = Handle(StepRepr_MappedItem)::DownCast(model->Value(i));
    const auto placed = Handle(StepShape_ContextDependentShapeRepresentation)::DownCast(model->Value(i));
    const Operator op = item.IsNull() ? operator_of(placed) : operator_of(item);
    if (op.IsNull()) continue;
    if (scales(op)) refuse(model, op, name, "an instance is scaled by " + std::to_string(op->Scale()));
    if (!mirrors(op)) continue;
    if (placed.IsNull()) refuse(model, op, name, "a mapped item is mirrored");
    if (STEPConstruct_Assembly::CheckSRRReversesNAUO(graph, placed)) {
      refuse(model, op, name, "a mirror placement is stated from the assembly to the part");
    }
    if (placed->RepresentedProductRelation().IsNull()) continue;
    const Handle(Standard_Transient) use =
        placed->RepresentedProductRelation()->Definition().ProductDefinitionRelationship();
    if (!use.IsNull()) uses.push_back(use);
  }
  return uses;
}

}  // namespace lamella::step
