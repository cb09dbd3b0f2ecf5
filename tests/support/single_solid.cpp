#include "tests/support/single_solid.h"

#include <map>
#include <utility>

namespace lamella::test {

namespace {

/// Copies what a solid uses, in its order.
class Extraction {
 public:
  explicit Extraction(const Scene& from) : from_(from) {}

  Scene run(SolidId id) {
    to_.files = from_.files;
    Solid solid = from_.solids[id];
    const IdRange<ShellId> shells = solid.shells;
    solid.shells = {ShellId{0}, shells.count};
    to_.solids.push_back(std::move(solid));
    for (const ShellId shell : shells) copy_shell(shell);
    for (const auto& [old, fresh] : half_edges_) {
      HalfEdge& use = to_.half_edges[fresh];
      const auto twin = half_edges_.find(use.twin);
      use.twin = twin == half_edges_.end() ? HalfEdgeId{} : twin->second;
    }
    return std::move(to_);
  }

 private:
  void copy_shell(ShellId id) {
    Shell shell = from_.shells[id];
    const IdRange<FaceId> faces = shell.faces;
    shell.solid = SolidId{0};
    shell.faces.first = FaceId{to_.faces.size()};
    const ShellId made = to_.shells.push_back(shell);
    for (const FaceId face : faces) copy_face(face, made);
  }

  void copy_face(FaceId id, ShellId shell) {
    Face face = from_.faces[id];
    const IdRange<LoopId> loops = face.loops;
    face.shell = shell;
    face.loops.first = LoopId{to_.loops.size()};
    const FaceId made = to_.faces.push_back(std::move(face));
    for (const LoopId loop : loops) {
      const IdRange<HalfEdgeId> uses = from_.loops[loop].half_edges;
      const LoopId made_loop = to_.loops.push_back({made, {HalfEdgeId{to_.half_edges.size()}, uses.count}});
      for (const HalfEdgeId use : uses) copy_use(use, made_loop);
    }
  }

  void copy_use(HalfEdgeId id, LoopId loop) {
    HalfEdge use = from_.half_edges[id];
    use.loop = loop;
    const auto [known, is_new] = edges_.try_emplace(use.edge, EdgeId{to_.edges.size()});
    if (is_new) {
      Edge edge = from_.edges[use.edge];
      edge.start = copy_vertex(edge.start);
      edge.end = copy_vertex(edge.end);
      to_.edges.push_back(std::move(edge));
    }
    use.edge = known->second;
    half_edges_[id] = to_.half_edges.push_back(std::move(use));
  }

  VertexId copy_vertex(VertexId id) {
    const auto [known, is_new] = vertices_.try_emplace(id, VertexId{to_.vertices.size()});
    if (is_new) to_.vertices.push_back(from_.vertices[id]);
    return known->second;
  }

  const Scene& from_;
  Scene to_;
  std::map<HalfEdgeId, HalfEdgeId> half_edges_;
  std::map<EdgeId, EdgeId> edges_;
  std::map<VertexId, VertexId> vertices_;
};

}  // namespace

Scene single_solid(const Scene& scene, SolidId solid) { return Extraction(scene).run(solid); }

void delete_face(Scene& scene, FaceId face) {
  Shell& shell = scene.shells[scene.faces[face].shell];
  const FaceId last{std::size_t{shell.faces.first.value()} + shell.faces.count - 1};
  for (const LoopId loop : scene.faces[face].loops) {
    for (const HalfEdgeId use : scene.loops[loop].half_edges) {
      const HalfEdgeId twin = scene.half_edges[use].twin;
      if (twin.valid()) scene.half_edges[twin].twin = HalfEdgeId{};
    }
  }
  std::swap(scene.faces[face], scene.faces[last]);
  for (const FaceId moved : {face, last}) {
    for (const LoopId loop : scene.faces[moved].loops) scene.loops[loop].face = moved;
  }
  --shell.faces.count;
}

}  // namespace lamella::test
