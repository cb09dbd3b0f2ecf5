#pragma once

#include <StepData_StepModel.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS_Shape.hxx>
#include <Transfer_TransientProcess.hxx>
#include <string>
#include <unordered_map>
#include <vector>

#include "model/step/entity_label.h"

/// Private to model/step: which STEP entity became which shape.
namespace lamella::step {

/// A STEP entity by its number in the file, with the name of the representation item (UTF-8, may be empty).
struct EntityRef {
  int number = 0;
  std::string name;
};

/// Finds, for faces, shells, solids and parts of the imported assembly, the entity each came from. Keyed by the shape
/// without its place, so all instances of a part share the entities.
class EntityIndex {
 public:
  EntityIndex() = default;
  /// `mirrored_uses` as in placement_operator.h.
  EntityIndex(const Handle(StepData_StepModel) & model, const Handle(Transfer_TransientProcess) & process,
              const std::vector<Handle(Standard_Transient)>& mirrored_uses);

  /// Entity of a face, shell or solid; number 0 when unknown.
  [[nodiscard]] EntityRef item(const TopoDS_Shape& shape) const;
  /// Number of the PRODUCT_DEFINITION whose shape this is; 0 when unknown.
  [[nodiscard]] int product_definition(const TopoDS_Shape& shape) const;
  /// Whether this place of an instance, as the import has made it, lacks a mirror image in the instance's own y. The
  /// import makes a new place for every use, and equality is that of the object, not of the numbers.
  [[nodiscard]] bool is_mirrored(const TopLoc_Location& place) const;

 private:
  using Key = const void*;
  [[nodiscard]] static Key key(const TopoDS_Shape& shape) { return shape.TShape().get(); }
  void add_item(const TopoDS_Shape& result, TopAbs_ShapeEnum kind, const EntityRef& entity);

  std::unordered_map<Key, EntityRef> items_;
  std::unordered_map<Key, int> products_;
  std::vector<TopLoc_Location> mirrored_;
};

}  // namespace lamella::step
