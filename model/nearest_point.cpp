#include "model/nearest_point.h"

#include <cmath>
#include <deque>
#include <set>
#include <vector>

#include "model/near_parts.h"

namespace lamella {

struct NearestPoint::Data {
  // Deques, since what is in them stays where it is.
  std::deque<NearFace> faces;
  std::deque<NearPatch> patches;
  std::deque<NearEdge> edges;
  BoxTree patch_tree;
  BoxTree edge_tree;

  void add_face(const Scene& scene, FaceId id);
  void add_edges(const Scene& scene, FaceId id, std::set<EdgeId>& known);
};

void NearestPoint::Data::add_face(const Scene& scene, FaceId id) {
  NearFace& face = faces.emplace_back(scene, id);
  for (BezierPatch& patch : face.form.patches) patches.emplace_back(face, std::move(patch));
  face.form.patches.clear();
}

void NearestPoint::Data::add_edges(const Scene& scene, FaceId id, std::set<EdgeId>& known) {
  for (const LoopId loop : scene.faces[id].loops) {
    for (const HalfEdgeId half_edge : scene.loops[loop].half_edges) {
      const EdgeId edge = scene.half_edges[half_edge].edge;
      if (known.insert(edge).second) edges.emplace_back(scene, edge, id);
    }
  }
}

namespace {

template <class Items>
BoxTree tree_of(const Items& items) {
  std::vector<Box3> boxes;
  for (const auto& item : items) boxes.push_back(item.box());
  return BoxTree(boxes);
}

template <class Items>
void search(const BoxTree& tree, const Items& items, const Vec3& point, double& squared, NearPoint& best) {
  tree.search(point, squared, [&](std::uint32_t item, double) {
    items[item].search(point, squared, best);
    return squared;
  });
}

template <class Items>
bool has_within(const BoxTree& tree, const Items& items, const Vec3& point, double squared) {
  bool has = false;
  tree.search(point, squared, [&](std::uint32_t item, double limit) {
    has = items[item].may_come_within(point, squared);
    return has ? 0.0 : limit;
  });
  return has;
}

}  // namespace

NearestPoint::NearestPoint(const Scene& scene, std::span<const FaceId> faces) : data_(std::make_unique<Data>()) {
  std::set<EdgeId> known;
  for (const FaceId face : faces) {
    data_->add_face(scene, face);
    data_->add_edges(scene, face, known);
  }
  data_->patch_tree = tree_of(data_->patches);
  data_->edge_tree = tree_of(data_->edges);
}

NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;
NearestPoint& NearestPoint::operator=(NearestPoint&&) noexcept = default;

std::optional<NearPoint> NearestPoint::find(const Vec3& point, double within) const {
  NearPoint best;
  double squared = within * within;
  search(data_->patch_tree, data_->patches, point, squared, best);
  search(data_->edge_tree, data_->edges, point, squared, best);
  if (!best.face.valid()) return std::nullopt;
  best.distance = std::sqrt(squared);
  return best;
}

bool NearestPoint::may_come_within(const Vec3& point, double within) const {
  const double squared = within * within;
  return has_within(data_->patch_tree, data_->patches, point, squared) ||
         has_within(data_->edge_tree, data_->edges, point, squared);
}

Box3 NearestPoint::bounds() const {
  Box3 box;
  if (!data_->patch_tree.empty()) box.extend(data_->patch_tree.bounds());
  if (!data_->edge_tree.empty()) box.extend(data_->edge_tree.bounds());
  return box;
}

std::vector<FaceId> faces_of(const Scene& scene, SolidId solid) {
  std::vector<FaceId> faces;
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) faces.push_back(face);
  }
  return faces;
}

}  // namespace lamella
