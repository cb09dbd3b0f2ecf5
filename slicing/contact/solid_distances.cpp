#include "slicing/contact/solid_distances.h"

#include <map>
#include <mutex>
#include <utility>

#include "model/evaluate.h"

namespace lamella {

namespace {

std::vector<std::size_t> face_counts(const Scene& scene, SolidId solid) {
  std::vector<std::size_t> counts;
  for (const ShellId shell : scene.solids[solid].shells) counts.push_back(scene.shells[shell].faces.count);
  return counts;
}

/// Whether the faces of a solid have consecutive ids, shell by shell.
bool has_consecutive_faces(const Scene& scene, SolidId solid) {
  std::optional<std::uint32_t> next;
  for (const ShellId shell : scene.solids[solid].shells) {
    const IdRange<FaceId> faces = scene.shells[shell].faces;
    if (next && faces.first.value() != *next) return false;
    next = faces.first.value() + faces.count;
  }
  return next.has_value();
}

FaceId first_face(const Scene& scene, SolidId solid) {
  return scene.shells[scene.solids[solid].shells.first].faces.first;
}

}  // namespace

struct SolidDistances::Body {
  SolidId solid;
  std::once_flag once;
  std::optional<NearestPoint> query;
};

SolidDistances::SolidDistances(const Scene& scene) : scene_(scene) {
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> known;
  for (const SolidId solid : scene.solids.ids()) {
    const SolidInfo& info = scene.solids[solid].info;
    Place place;
    place.body = bodies_.size();
    if (info.instance && has_consecutive_faces(scene, solid)) {
      place.body = known.emplace(std::pair(info.file, info.instance->body), bodies_.size()).first->second;
    }
    if (place.body < bodies_.size()) {
      const SolidId other = bodies_[place.body]->solid;
      const Instance& from = *info.instance;
      const Instance& to = *scene.solids[other].info.instance;
      // q = from.turn^T (p - from.shift) in the body's own frame.
      place.turn = to.turn * from.turn.transpose();
      place.shift = to.shift - place.turn * from.shift;
      place.face_shift = first_face(scene, solid).value() - first_face(scene, other).value();
      place.is_moved = true;
      if (face_counts(scene, solid) != face_counts(scene, other))
        place = {bodies_.size(), Mat3::Identity(), Vec3::Zero(), 0, false};
    }
    if (place.body == bodies_.size()) {
      bodies_.push_back(std::make_unique<Body>());
      bodies_.back()->solid = solid;
    }
    places_.push_back(place);
  }
}

SolidDistances::~SolidDistances() = default;

const NearestPoint& SolidDistances::query_of(const Place& place) const {
  Body& body = *bodies_[place.body];
  std::call_once(body.once, [&] { body.query.emplace(scene_, faces_of(scene_, body.solid)); });
  return *body.query;
}

bool SolidDistances::may_come_within(SolidId solid, const Vec3& point, double within) const {
  const Place& place = places_[solid];
  return query_of(place).may_come_within(place.turn * point + place.shift, within);
}

std::optional<NearPoint> SolidDistances::find(SolidId solid, const Vec3& point, double within) const {
  const Place& place = places_[solid];
  if (!place.is_moved) return query_of(place).find(point, within);
  auto found = query_of(place).find(place.turn * point + place.shift, within);
  if (!found) return found;
  found->point = place.turn.transpose() * (found->point - place.shift);
  found->face = FaceId{found->face.value() + place.face_shift};
  return found;
}

Vec3 outward_normal(const Scene& scene, FaceId id, const Vec2& uv) {
  const Face& face = scene.faces[id];
  const Vec3 normal = evaluate(face.surface, uv).normal();
  const double length = normal.norm();
  if (!(length > 0.0)) return Vec3::Zero();
  return (face.same_sense ? 1.0 : -1.0) / length * normal;
}

}  // namespace lamella
