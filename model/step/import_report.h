#pragma once

#include <StepData_StepModel.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_TransientProcess.hxx>
#include <string>
#include <vector>

#include "model/step/entity_index.h"
#include "model/step/raw_structure.h"

/// Private to model/step: what the import says about its own work.
namespace lamella::step {

/// A message of the import about one entity.
struct ImportRemark {
  int entity = 0;
  bool failure = false;
  std::string what;
};

/// Repairs and failures while shapes were made, in the order of the entities.
[[nodiscard]] std::vector<ImportRemark> transfer_remarks(const Handle(StepData_StepModel) & model,
                                                         const Handle(Transfer_TransientProcess) & process);

/// Entities whose attributes could not be read as the schema wants them.
[[nodiscard]] std::vector<RefusedEntity> refused_entities(const Handle(StepData_StepModel) & model);

/// What is wrong with a shape as it came out of the import.
struct ShapeFault {
  int face = 0;  ///< entity, 0 when it concerns the whole shape
  std::string what;
};

/// Checks the shape's topology against its geometry; at most one fault for each face.
[[nodiscard]] std::vector<ShapeFault> check_shape(const TopoDS_Shape& shape, const EntityIndex& entities);

}  // namespace lamella::step
