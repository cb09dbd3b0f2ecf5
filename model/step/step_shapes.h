#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/ids.h"
#include "core/progress.h"
#include "model/triangle_mesh.h"

namespace lamella {

namespace step {
struct ShapeList;
}

/// How finely OpenCASCADE's mesher works, and when it is stopped.
struct TessellationOptions {
  double deflection = 0.1;  ///< mm, the largest distance from the surface that is asked for
  double angle = 0.5;       ///< radians between neighbouring pieces that is asked for; OpenCASCADE's usual value
  bool in_parallel = true;  ///< on all cores, else on one
  std::size_t max_triangles = std::numeric_limits<std::size_t>::max();
  double max_seconds = std::numeric_limits<double>::infinity();  ///< wall time
  double max_bytes = std::numeric_limits<double>::infinity();    ///< that the process may grow by
};

/// Triangles of some solids, or why there are none.
struct Tessellation {
  std::vector<TriangleMesh> solids;  ///< in the order asked for; empty when stopped
  std::size_t triangles = 0;
  std::size_t faces_without = 0;  ///< faces that the mesher gave up
  double seconds = 0.0;           ///< wall time of meshing alone
  std::string stopped;            ///< the limit that was met, empty when it was done
};

/// OpenCASCADE's own shapes of the solids of a scene, kept for the accuracy study, which compares direct slicing with
/// what everybody else slices. Nothing else may use them: the exact model is the scene.
class StepShapes {
 public:
  StepShapes();
  ~StepShapes();
  StepShapes(StepShapes&&) noexcept;
  StepShapes& operator=(StepShapes&&) noexcept;

  /// As many as the scene has solids, in the same order.
  [[nodiscard]] std::size_t size() const;

  /// Meshes the solids anew with BRepMesh_IncrementalMesh, copies once, and forgets its triangulation afterwards.
  /// Throws GeometryError when OpenCASCADE fails, Cancelled when asked. Not safe from several threads at once.
  [[nodiscard]] Tessellation tessellate(std::span<const SolidId> solids, const TessellationOptions& options,
                                        const Progress& progress = {});

  /// Where OpenCASCADE's IntCurvesFace_ShapeIntersector meets a solid on each of some rays: depths t in mm, ascending,
  /// as it finds them; intersections of one sense within 1e-6 mm, which an edge gives on both its faces, are one. It is
  /// slow, and misses and doubles some: an odd number is one of those. Throws as tessellate() does.
  [[nodiscard]] std::vector<std::vector<double>> intersect(SolidId solid, std::span<const Ray> rays,
                                                           const Progress& progress = {}) const;

  /// For the reader.
  [[nodiscard]] step::ShapeList& list() { return *list_; }

 private:
  std::unique_ptr<step::ShapeList> list_;
};

}  // namespace lamella
