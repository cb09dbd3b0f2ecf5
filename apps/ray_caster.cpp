#include "apps/ray_caster.h"

#include <algorithm>
#include <cmath>

#include "model/project.h"
#include "slicing/slicer.h"

namespace lamella::apps {

namespace {

constexpr double kNearFace = 1e-6;  // mm; a hit lies this near its face, and no other part of the face does

bool is_horizontal(const Ray& ray) { return ray.direction.z() == 0.0; }

/// The side to which ties are decided: up for horizontal rays, as when slicing; any normal for the rest.
Vec3 up_of(const Ray& ray) {
  if (is_horizontal(ray)) return Vec3::UnitZ();
  const Vec3 aside = std::abs(ray.direction.x()) < 0.9 ? Vec3::UnitX() : Vec3::UnitY();
  return ray.direction.cross(aside).normalized();
}

/// A horizontal ray as a lattice of one row. The spacing has no meaning; it is chosen so that position() gives the
/// ray's offset without rounding: halves of two numbers within a factor of two subtract exactly (Sterbenz).
RowLattice lattice_of(const Ray& ray) {
  constexpr double kNearZero = 1e-3;  // mm; a spacing like it would make row numbers huge
  RowLattice lattice;
  lattice.along = ray.direction.head<2>();
  lattice.across = Vec2(-lattice.along.y(), lattice.along.x());
  const double offset = lattice.across.dot(ray.origin.head<2>());
  const double half = std::abs(offset) < kNearZero ? 0.5 : std::ldexp(1.0, std::ilogb(offset));
  lattice.spacing = 2.0 * half;
  lattice.first_row = offset < 0.0 ? -1 : 0;
  lattice.last_row = lattice.first_row + 1;
  lattice.anchor = offset < 0.0 ? offset + half : offset - half;
  return lattice;
}

}  // namespace

RayCaster::RayCaster(const Session& session, const Assembly& assembly, const EngineChoice& choice, OverlapPolicy policy)
    : session_(session), assembly_(assembly), choice_(choice), table_(assembly.table) {
  table_.policy = policy;
  rules_.table = &table_;
  rules_.rank = rank_solids(assembly.scene, table_, assembly.measures);
  for (const SolidId solid : assembly.scene.solids.ids()) {
    const Box3& bounds = assembly.measures[solid].bounds;
    const bool is_bounded = bounds.min().allFinite() && bounds.max().allFinite();
    const bool is_for_spans = is_sliceable(assembly.scene.solids[solid].info) && is_bounded;
    (is_for_spans ? closed_ : open_).push_back(solid);
  }
}

bool RayCaster::is_for_spans(const Ray& ray) const {
  return choice_.engine.value_or(EngineKind::span) == EngineKind::span && is_horizontal(ray);
}

void RayCaster::prepare(std::span<const Ray> rays) {
  const auto is_for = [this](const Ray& ray) { return is_for_spans(ray); };
  const Scene& scene = assembly_.scene;
  if (!span_engine_ && std::any_of(rays.begin(), rays.end(), is_for)) {
    SliceOptions options;
    options.threads = session_.threads();
    span_engine_.emplace();
    if (!closed_.empty()) span_engine_ = make_engine(scene, assembly_.measures, closed_, options, session_.progress());
    open_engine_ = std::make_unique<const ReferenceEngine>(scene, open_, choice_.reference, session_.progress(),
                                                           session_.threads());
  }
  if (!reference_ && !std::all_of(rays.begin(), rays.end(), is_for)) {
    reference_ =
        std::make_unique<const ReferenceEngine>(scene, choice_.reference, session_.progress(), session_.threads());
  }
}

RayResult RayCaster::cast(const Ray& ray) const {
  RayResult result;
  std::vector<SolidCast> casts;
  const bool by_spans = is_for_spans(ray);
  (by_spans ? open_engine_ : reference_)->cast_all(ray, up_of(ray), casts, result.counters);
  for (const SolidCast& cast : casts) add_cast(cast, result);
  if (by_spans && !closed_.empty()) add_spans(ray, result);
  std::stable_sort(result.hits.begin(), result.hits.end(), [](const Hit& a, const Hit& b) { return a.t < b.t; });
  std::stable_sort(result.spans.begin(), result.spans.end(),
                   [](const Span& a, const Span& b) { return a.solid < b.solid; });
  RowCombiner().combine(result.spans, rules_, result.segments);
  return result;
}

void RayCaster::add_cast(const SolidCast& cast, RayResult& result) const {
  result.hits.insert(result.hits.end(), cast.hits.begin(), cast.hits.end());
  result.spans.insert(result.spans.end(), cast.spans.begin(), cast.spans.end());
}

void RayCaster::add_spans(const Ray& ray, RayResult& result) const {
  const LayerRequest request{0, ray.origin.z(), {lattice_of(ray)}};
  std::vector<LayerSpans> out;
  make_layer_spans(std::span(&request, 1), out);
  span_engine_->cut(std::span(&request, 1), out);
  check_layer_spans(request, out.front());
  result.counters += out.front().cast;
  const double foot = request.lattices.front().along.dot(ray.origin.head<2>());
  const auto add_hit = [&](double t, SolidId solid, FaceId id, Sense sense) {
    Hit hit{t, solid, id, sense, 0, Vec2::Zero()};
    const Face& face = assembly_.scene.faces[id];
    hit.uv = project(face.surface, face.uv_bounds, ray.at(t), std::max(kNearFace, face.tolerance));
    result.hits.push_back(hit);
  };
  for (Span span : out.front().lattices.front().row(0)) {
    if (!span.face_out.valid()) continue;  // not closed, and counted so
    span.begin -= foot;
    span.end -= foot;
    result.spans.push_back(span);
    add_hit(span.begin, span.solid, span.face_in, Sense::entry);
    add_hit(span.end, span.solid, span.face_out, Sense::exit);
  }
}

}  // namespace lamella::apps
