#pragma once

#include <TopoDS_Shape.hxx>
#include <optional>
#include <unordered_map>

#include "model/scene.h"
#include "model/step/entity_index.h"

/// Private to model/step: boundary representations into the scene.
namespace lamella::step {

/// One solid of one instance, placed in the machine frame.
struct SolidSource {
  TopoDS_Shape shape;  ///< a solid, a shell, or a compound of free faces
  SolidInfo info;
};

/// What faces look like, keyed by the shape without its place.
using FaceColors = std::unordered_map<const void*, Color>;

/// Appends the solid with all its topology to the scene. What can't be converted is left out, named in
/// `scene.findings`, and makes the solid's status `invalid`, or `empty` when no face is left.
void append_solid(Scene& scene, const SolidSource& source, const EntityIndex& entities, const FaceColors& colors);

/// The shape with a scaled placement worked into its geometry; the model's parameters are lengths and can't be scaled.
[[nodiscard]] TopoDS_Shape without_scaling(const TopoDS_Shape& shape);

}  // namespace lamella::step
