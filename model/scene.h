#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/geometry.h"
#include "core/ids.h"
#include "model/curve.h"
#include "model/surface.h"

namespace lamella {

/// Red, green, blue in [0, 1], sRGB as displayed.
using Color = std::array<double, 3>;

struct Vertex {
  Vec3 point = Vec3::Zero();
  double tolerance = 0.0;  ///< mm, as stated by the reader
};

/// A shared edge: one 3D curve between two shared vertices, or a point (a pole, an apex) when `degenerate`.
struct Edge {
  Curve3 curve;    ///< meaningless when degenerate
  Interval range;  ///< parameters of `curve` at `start` and `end`, range.lo < range.hi
  VertexId start;
  VertexId end;            ///< equal to `start` for a closed or degenerate edge
  double tolerance = 0.0;  ///< mm: the edge may lie this far from its curve and pcurves
  bool degenerate = false;
  int step_entity = 0;  ///< #number in the STEP file, 0 if unknown
};

/// One use of an edge by a face. A seam edge has two, both in the same face.
struct HalfEdge {
  EdgeId edge;
  LoopId loop;
  bool forward = true;  ///< runs from the edge's start to its end
  Curve2 pcurve;        ///< in the (u, v) of the face's surface, parametrised along with the edge's curve
  Interval prange;      ///< pcurve parameters at the edge's range.lo and range.hi
  HalfEdgeId twin;      ///< the other use of the edge in the same shell, in the opposite sense; invalid if none
};

/// A closed chain of half-edges, material of the face on the left seen against the face's surface normal Su x Sv
/// when `Face::same_sense`, on the right when not (the half-edges follow the face's outward normal).
struct Loop {
  FaceId face;
  IdRange<HalfEdgeId> half_edges;
};

struct Face {
  ShellId shell;
  Surface surface;
  bool same_sense = true;  ///< the solid's outward normal is +(Su x Sv)
  IdRange<LoopId> loops;
  Box2 uv_bounds;          ///< box of the pcurves; periodic parameters are unwrapped, so it may leave [0, 2 pi]
  double tolerance = 0.0;  ///< mm
  int step_entity = 0;
  std::string name;
  std::optional<Color> color;
};

struct Shell {
  SolidId solid;
  IdRange<FaceId> faces;
  bool closed = false;   ///< every non-degenerate edge used twice in opposite senses
  bool is_void = false;  ///< bounds a cavity
  int step_entity = 0;
};

enum class SolidStatus {
  ok,
  open,     ///< a shell has free edges
  invalid,  ///< contradictory orientation, a missing surface, self-intersecting loops ...
  empty     ///< no face survived the import
};

/// Where a solid came from when it was read: all solids of a file with the same `body` are copies of one shape, as far
/// as they could be converted, and differ by where they are placed.
struct Instance {
  std::size_t body = 0;
  Mat3 turn = Mat3::Identity();  ///< p -> turn p + shift, from the shape's frame to the machine's
  Vec3 shift = Vec3::Zero();     ///< mm
};

struct SolidInfo {
  std::string name;      ///< product or body name, UTF-8
  std::string path;      ///< "/assembly/part.1/body", unique in the scene
  std::size_t file = 0;  ///< index in Scene::files
  std::optional<Color> color;
  std::string layer;                   ///< first layer, empty if none
  std::string step_material;           ///< empty if none
  std::optional<double> step_density;  ///< g/cm^3
  SolidStatus status = SolidStatus::ok;
  bool closed = true;
  std::vector<std::string> healed;  ///< what the import changed, one line each
  double max_tolerance = 0.0;       ///< mm, over edges and vertices
  int step_entity = 0;
  std::optional<Instance> instance;  ///< nothing where the reader doesn't know
};

struct Solid {
  IdRange<ShellId> shells;  ///< the outer shell first
  SolidInfo info;
};

struct SourceFile {
  std::string path;
  std::string schema;  ///< "AP203", "AP214", "AP242", or the file's own word
  std::string unit;    ///< length unit as the file has it
  double unit_in_mm = 1.0;
  std::string sha256;
};

/// Immutable geometry once built, in the machine frame, in mm. Every instance of a part has faces and edges of its
/// own. Faces of a shell, loops of a face and half-edges of a loop are contiguous and in the order of the file.
struct Scene {
  std::vector<SourceFile> files;
  IdVector<SolidId, Solid> solids;
  IdVector<ShellId, Shell> shells;
  IdVector<FaceId, Face> faces;
  IdVector<LoopId, Loop> loops;
  IdVector<HalfEdgeId, HalfEdge> half_edges;
  IdVector<EdgeId, Edge> edges;
  IdVector<VertexId, Vertex> vertices;
  std::vector<Finding> findings;

  [[nodiscard]] SolidId solid_of(FaceId face) const { return shells[faces[face].shell].solid; }
};

}  // namespace lamella
