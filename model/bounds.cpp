#include "model/bounds.h"

#include "model/curve_extrema.h"
#include "model/face_extent.h"
#include "model/measure.h"

namespace lamella {

namespace {

Box3 border_of(const Scene& scene, const Face& face) {
  Box3 box;
  for (const LoopId loop : face.loops) {
    for (const HalfEdgeId id : scene.loops[loop].half_edges) {
      const Edge& edge = scene.edges[scene.half_edges[id].edge];
      if (edge.degenerate) {
        box.extend(scene.vertices[edge.start].point);
      } else {
        box.extend(exact_bounds(edge.curve, edge.range));
      }
    }
  }
  return box;
}

}  // namespace

FaceBounds face_bounds(const Scene& scene, FaceId id) {
  const Box3 border = border_of(scene, scene.faces[id]);
  const FaceExtent inside(scene, id);
  FaceBounds bounds{border, true};
  for (int axis = 0; axis < 3; ++axis) {
    Reach low;
    Reach high;
    if (!border.isEmpty()) {
      low.value = -border.min()[axis];
      high.value = border.max()[axis];
    }
    inside.raise(-Vec3::Unit(axis), low);
    inside.raise(Vec3::Unit(axis), high);
    bounds.box.min()[axis] = -low.value;
    bounds.box.max()[axis] = high.value;
    bounds.converged = bounds.converged && low.converged && high.converged;
  }
  return bounds.box.isEmpty() ? FaceBounds{{}, bounds.converged} : bounds;
}

Box3 exact_bounds(const Scene& scene, FaceId face) { return face_bounds(scene, face).box; }

}  // namespace lamella
