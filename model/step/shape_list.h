#pragma once

#include <TopoDS_Shape.hxx>
#include <vector>

/// Private to model/step.
namespace lamella::step {

/// The import's shapes of a scene's solids, in their order, placed as they are.
struct ShapeList {
  std::vector<TopoDS_Shape> shapes;
};

}  // namespace lamella::step
