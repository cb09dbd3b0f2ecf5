#include "model/step/import_report.h"

#include <BRepCheck_Analyzer.hxx>
#include <BRepCheck_ListIteratorOfListOfStatus.hxx>
#include <BRepCheck_Result.hxx>
#include <Interface_Check.hxx>
#include <Interface_ReportEntity.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <Transfer_Binder.hxx>

#include "model/step/text.h"

namespace lamella::step {
namespace {

const char* text_of(BRepCheck_Status status) {
  switch (status) {
    case BRepCheck_InvalidPointOnCurve:
    case BRepCheck_InvalidPointOnCurveOnSurface:
    case BRepCheck_InvalidPointOnSurface:
      return "a vertex lies off its edge or face";
    case BRepCheck_No3DCurve:
    case BRepCheck_Multiple3DCurve:
    case BRepCheck_Invalid3DCurve:
      return "an edge's curve is missing or invalid";
    case BRepCheck_NoCurveOnSurface:
    case BRepCheck_InvalidCurveOnSurface:
    case BRepCheck_InvalidCurveOnClosedSurface:
    case BRepCheck_InvalidSameRangeFlag:
    case BRepCheck_InvalidSameParameterFlag:
      return "an edge's curve and its image on the face don't agree";
    case BRepCheck_InvalidDegeneratedFlag:
    case BRepCheck_InvalidRange:
      return "an edge has an invalid range";
    case BRepCheck_FreeEdge:
    case BRepCheck_NotClosed:
    case BRepCheck_NotConnected:
      return "the boundary is not closed";
    case BRepCheck_InvalidMultiConnexity:
      return "an edge is shared by more than two faces";
    case BRepCheck_EmptyWire:
    case BRepCheck_RedundantEdge:
    case BRepCheck_RedundantWire:
    case BRepCheck_NoSurface:
    case BRepCheck_EmptyShell:
    case BRepCheck_RedundantFace:
      return "a loop, surface or shell is missing or doubled";
    case BRepCheck_SelfIntersectingWire:
    case BRepCheck_IntersectingWires:
      return "its loops cross themselves or each other";
    case BRepCheck_InvalidImbricationOfWires:
      return "its loops don't nest";
    case BRepCheck_UnorientableShape:
    case BRepCheck_BadOrientation:
    case BRepCheck_BadOrientationOfSubshape:
      return "its orientation contradicts itself";
    case BRepCheck_InvalidImbricationOfShells:
    case BRepCheck_EnclosedRegion:
      return "its shells don't nest";
    default:
      return "it is invalid";
  }
}

/// First fault that the analysis found in `part`, alone or as seen by `context`; null if there is none.
const char* first_fault(const BRepCheck_Analyzer& analyzer, const TopoDS_Shape& part, const TopoDS_Shape& context) {
  const Handle(BRepCheck_Result)& result = analyzer.Result(part);
  if (result.IsNull()) return nullptr;
  const auto worst = [](const BRepCheck_ListOfStatus& list) -> const char* {
    for (const BRepCheck_Status status : list) {
      if (status != BRepCheck_NoError) return text_of(status);
    }
    return nullptr;
  };
  if (const char* own = worst(result->Status())) return own;
  for (result->InitContextIterator(); result->MoreShapeInContext(); result->NextShapeInContext()) {
    if (!result->ContextualShape().IsSame(context)) continue;
    if (const char* seen = worst(result->StatusOnShape())) return seen;
  }
  return nullptr;
}

const char* fault_of_face(const BRepCheck_Analyzer& analyzer, const TopoDS_Shape& face) {
  if (const char* fault = first_fault(analyzer, face, face)) return fault;
  for (const TopAbs_ShapeEnum kind : {TopAbs_WIRE, TopAbs_EDGE, TopAbs_VERTEX}) {
    for (TopExp_Explorer it(face, kind); it.More(); it.Next()) {
      if (const char* fault = first_fault(analyzer, it.Current(), face)) return fault;
    }
  }
  return nullptr;
}

}  // namespace

std::vector<ImportRemark> transfer_remarks(const Handle(StepData_StepModel) & model,
                                           const Handle(Transfer_TransientProcess) & process) {
  std::vector<ImportRemark> remarks;
  for (int i = 1; i <= process->NbMapped(); ++i) {
    const Handle(Transfer_Binder) binder = process->MapItem(i);
    if (binder.IsNull()) continue;
    const Handle(Interface_Check) check = binder->Check();
    const int number = model->IdentLabel(process->Mapped(i));
    for (int k = 1; k <= check->NbFails(); ++k) remarks.push_back({number, true, clean_name(check->CFail(k))});
    for (int k = 1; k <= check->NbWarnings(); ++k) remarks.push_back({number, false, clean_name(check->CWarning(k))});
  }
  return remarks;
}

std::vector<RefusedEntity> refused_entities(const Handle(StepData_StepModel) & model) {
  std::vector<RefusedEntity> refused;
  for (int i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Interface_ReportEntity) report = model->ReportEntity(i);
    if (report.IsNull() || !report->Check()->HasFailed()) continue;
    const Handle(Interface_Check) check = report->Check();
    std::string reason = clean_name(check->CFail(1));
    // A missing name is complained about first, and hides what does harm.
    for (int k = 2; k <= check->NbFails() && is_about_a_name(reason); ++k) reason = clean_name(check->CFail(k));
    refused.push_back({model->IdentLabel(model->Value(i)), reason});
  }
  return refused;
}

std::vector<ShapeFault> check_shape(const TopoDS_Shape& shape, const EntityIndex& entities) {
  std::vector<ShapeFault> faults;
  try {
    const BRepCheck_Analyzer analyzer(shape);
    if (analyzer.IsValid()) return faults;
    for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
      if (const char* fault = fault_of_face(analyzer, it.Current())) {
        faults.push_back({entities.item(it.Current()).number, fault});
      }
    }
    for (const TopAbs_ShapeEnum kind : {TopAbs_SHELL, TopAbs_SOLID}) {
      for (TopExp_Explorer it(shape, kind); it.More(); it.Next()) {
        if (const char* fault = first_fault(analyzer, it.Current(), shape)) faults.push_back({0, fault});
      }
    }
    if (faults.empty()) faults.push_back({0, "it is invalid"});
  } catch (const Standard_Failure& failure) {
    faults.push_back({0, std::string("it can't be checked: ") + failure.GetMessageString()});
  }
  return faults;
}

}  // namespace lamella::step
