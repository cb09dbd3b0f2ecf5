#include "slicing/reference/solid_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/tolerances.h"
#include "model/evaluate.h"
#include "slicing/reference/classic_solvers.h"
#include "slicing/reference/face_patches.h"

namespace lamella::reference {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Least radius of an edge's zone, relative to the solid: some hundred rounding errors of coordinates and parameters.
constexpr double kLeastZone = 1e-11;
/// Hits of one face and sense closer than this, relative to the solid, are copies of one root.
constexpr double kMergeRelative = 1e-9;
/// For the certified solver sub-patches are only refined to tighten their boxes: flat to this share of their diagonal.
constexpr double kBoxFlatness = 0.08;
constexpr int kBoxLevels = 4;
constexpr int kMaxRefineCrossing = 40;

RefineLimits limits_for(const ReferenceOptions& options) {
  RefineLimits limits;
  if (options.solver == Solver::certified) {
    limits.flatness = std::numeric_limits<double>::infinity();
    limits.relative_flatness = kBoxFlatness;
    limits.max_level = kBoxLevels;
  } else {
    limits.flatness = options.subdivision;
  }
  return limits;
}

/// Coarse box of a solid for scales: vertices and the middles of its edges and faces.
Box3 coarse_box(const Scene& scene, SolidId solid) {
  Box3 box;
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId id : scene.shells[shell].faces) {
      const Face& face = scene.faces[id];
      for (const double a : {0.0, 0.5, 1.0}) {
        for (const double b : {0.0, 0.5, 1.0}) {
          const Vec2 share(a, b);
          const Vec3 point =
              evaluate_point(face.surface, face.uv_bounds.min() + face.uv_bounds.sizes().cwiseProduct(share));
          if (point.allFinite()) box.extend(point);
        }
      }
    }
  }
  if (box.isEmpty()) box.extend(Vec3::Zero());
  return box;
}

double rounding_size(const Box3& box) {
  return std::max(box.min().cwiseAbs().maxCoeff(), box.max().cwiseAbs().maxCoeff()) * kEpsilon;
}

double zone_floor(const Box3& box) { return std::max(kLeastZone * box.diagonal().norm(), 64.0 * rounding_size(box)); }

}  // namespace

SolidModel::SolidModel(const Scene& scene, SolidId solid, const ReferenceOptions& options)
    : scene_(&scene), options_(options), zones_(scene, solid, zone_floor(coarse_box(scene, solid))) {
  const Box3 coarse = coarse_box(scene, solid);
  center_ = coarse.center();
  size_ = std::max(coarse.diagonal().norm(), 1e-12);
  const double rounding = rounding_size(coarse);
  accuracy_ = std::max(tolerance::kSolverRelative / kEpsilon, tolerance::kSolverUlps) * rounding;
  // Ten times this sideways leaves the least zone (closed_cast.cpp moves by the hundredth part sideways).
  smallest_step_ = std::max(1e-8 * size_, 1000.0 * zone_floor(coarse));
  merge_distance_ = std::max(kMergeRelative * size_, 100.0 * accuracy_);
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) add_face(face, options);
  }
  std::vector<Box3> boxes;
  boxes.reserve(patches_.size());
  for (const SubPatch& patch : patches_) boxes.push_back(control_box(patch.patch));
  tree_ = PatchTree(boxes, merge_distance_);
}

void SolidModel::add_face(FaceId id, const ReferenceOptions& options) {
  const auto number = static_cast<std::uint32_t>(faces_.size());
  const Face& face = scene_->faces[id];
  RationalForm form = face_form(face);
  RefineResult refined =
      refine(std::move(form.patches), limits_for(options), number, static_cast<std::uint32_t>(patches_.size()));
  form.patches.clear();
  capped_faces_ += refined.capped ? 1 : 0;
  std::move(refined.patches.begin(), refined.patches.end(), std::back_inserter(patches_));
  faces_.push_back({id, face.same_sense, std::move(form), TrimRegion(*scene_, id)});
}

bool SolidModel::meets_box(const Ray& ray) const {
  return !tree_.empty() && line_meets_box(ray, tree_.bounds().min(), tree_.bounds().max());
}

double SolidModel::find_crossings(const Ray& ray, CastScratch& scratch, CastCounters& counters) const {
  scratch.crossings.clear();
  scratch.passes.clear();
  zones_.find(ray, scratch.candidates, scratch.passes);
  double doubt = 0.0;
  for (const EdgePass& pass : scratch.passes) {
    if (pass.distance <= pass.zone.radius) doubt = std::max(doubt, pass.zone.radius);
  }
  // From the foot of the solid's centre: the rounding of F grows with the distance of the origin.
  const double shift = ray.direction.dot(center_ - ray.origin);
  const RayPlanes planes = make_ray_planes({ray.at(shift), ray.direction});
  scratch.candidates.clear();
  tree_.find(ray, scratch.candidates);
  for (const std::uint32_t index : scratch.candidates) {
    scratch.roots.clear();
    solve(planes, patches_[index], scratch, counters);
    for (const PatchRoot& root : scratch.roots) {
      doubt = std::max(doubt, add_crossing(planes, patches_[index], root, shift, scratch));
    }
  }
  std::sort(scratch.crossings.begin(), scratch.crossings.end(), [](const Crossing& a, const Crossing& b) {
    return std::tie(a.t, a.face, a.sense) < std::tie(b.t, b.face, b.sense);
  });
  if (options_.solver == Solver::certified) drop_copies(scratch.crossings);
  return doubt;
}

void SolidModel::solve(const RayPlanes& planes, const SubPatch& patch, CastScratch& scratch,
                       CastCounters& counters) const {
  ++counters.candidates;
  project(patch, planes, scratch.nets);
  switch (options_.solver) {
    case Solver::certified:
      scratch.solver.solve(scratch.nets, accuracy_, scratch.roots, counters.iterations);
      break;
    case Solver::bisection:
      solve_by_bisection(scratch.nets, options_.tolerance, scratch.roots, counters.iterations);
      break;
    case Solver::newton:
      solve_by_newton(scratch.nets, options_.tolerance, scratch.roots, counters.iterations);
      break;
  }
}

/// Trim test in (u, v). Returns the doubt that it leaves.
double SolidModel::add_crossing(const RayPlanes& planes, const SubPatch& patch, const PatchRoot& root, double shift,
                                CastScratch& scratch) const {
  const FaceModel& face = faces_[patch.face];
  const Interval& u = patch.patch.u;
  const Interval& v = patch.patch.v;
  const Vec2 st(u.lo + u.length() * root.u, v.lo + v.length() * root.v);
  const Vec2 half_st(u.length() * root.half_u, v.length() * root.half_v);
  Crossing crossing;
  crossing.face = patch.face;
  crossing.uv = face.form.to_surface(st);
  crossing.sense = root.undecided ? Sense::edge : root.enters == face.same_sense ? Sense::entry : Sense::exit;
  Vec2 half = Vec2::Zero();
  if (root.undecided) half = 0.5 * (face.form.to_surface(st + half_st) - face.form.to_surface(st - half_st)).cwiseAbs();
  const TrimRegion::Side side = face.trim.classify(crossing.uv, half);
  if (side == TrimRegion::Side::outside) return 0.0;

  const Vec3 point = evaluate_point(patch.patch, st.x(), st.y());
  crossing.t = planes.depth(point) + shift;
  crossing.uv = face.trim.unwrap(crossing.uv, half);
  for (const EdgePass& pass : scratch.passes) {
    if ((pass.point - point).norm() <= std::max(pass.zone.stated, pass.zone.radius)) crossing.flags |= kNearEdge;
  }
  if (root.undecided) {
    crossing.flags |= kTangent;
    for (const Vec2& corner : {Vec2(-half_st), half_st, Vec2(half_st.x(), -half_st.y())}) {
      const Vec3 end = evaluate_point(patch.patch, st.x() + corner.x(), st.y() + corner.y());
      crossing.half_t = std::max(crossing.half_t, std::abs(planes.direction.dot(end - point)));
    }
  }
  scratch.crossings.push_back(crossing);
  return root.undecided || side == TrimRegion::Side::on_boundary ? smallest_step_ : 0.0;
}

/// A face does not meet itself, so two crossings of one face in one sense at one point are copies of one root, from two
/// sub-patches that share a border or from the two sides of a seam. Of copies the one that counts as inside is kept.
void SolidModel::drop_copies(std::vector<Crossing>& crossings) const {
  double reach = merge_distance_;
  for (const Crossing& crossing : crossings) reach = std::max(reach, 2.0 * crossing.half_t + merge_distance_);
  std::size_t kept = 0;
  for (const Crossing& crossing : crossings) {
    bool copy = false;
    for (std::size_t k = kept; k-- > 0 && crossing.t - crossings[k].t <= reach;) {
      Crossing& other = crossings[k];
      const double apart = crossing.t - other.t - crossing.half_t - other.half_t;
      if (apart > merge_distance_ || other.face != crossing.face || other.sense != crossing.sense) continue;
      other.half_t = std::max(other.half_t, crossing.half_t);
      other.flags |= crossing.flags;
      copy = true;
      break;
    }
    if (!copy) crossings[kept++] = crossing;
  }
  crossings.resize(kept);
}

bool SolidModel::refine_crossing(const Ray& ray, std::uint32_t face, Vec2& uv, double& t) const {
  const Surface& surface = scene_->faces[faces_[face].id].surface;
  const RayPlanes planes = make_ray_planes({ray.at(t), ray.direction});
  Vec2 at = uv;
  double best = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxRefineCrossing; ++step) {
    const SurfacePoint s = evaluate(surface, at);
    const Vec2 f(planes.n1.dot(s.point - planes.origin), planes.n2.dot(s.point - planes.origin));
    const double residual = f.cwiseAbs().maxCoeff();
    if (!(residual < 0.9 * best)) break;
    best = residual;
    uv = at;
    Eigen::Matrix2d jacobian;
    jacobian << planes.n1.dot(s.du), planes.n1.dot(s.dv), planes.n2.dot(s.du), planes.n2.dot(s.dv);
    const double determinant = jacobian.determinant();
    at.x() -= (f.x() * jacobian(1, 1) - f.y() * jacobian(0, 1)) / determinant;
    at.y() -= (f.y() * jacobian(0, 0) - f.x() * jacobian(1, 0)) / determinant;
    if (!at.allFinite()) break;
  }
  if (!(best <= 10.0 * accuracy_)) return false;
  t += planes.depth(evaluate_point(surface, uv));
  return true;
}

double SolidModel::steepness(const Ray& ray, const Crossing& crossing) const {
  const Vec3 normal = evaluate(scene_->faces[faces_[crossing.face].id].surface, crossing.uv).normal();
  const double length = normal.norm();
  return length > 0.0 ? std::abs(normal.dot(ray.direction)) / length : 0.0;
}

}  // namespace lamella::reference
