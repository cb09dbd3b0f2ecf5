#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

#include "model/step/step_shapes.h"

namespace lamella {

/// Private to model/step. The shapes are placed as the scene's solids are.
struct StepShapes::Data {
  std::vector<TopoDS_Shape> shapes;
};

}  // namespace lamella
