#include "slicing/contact/contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "core/parallel.h"
#include "core/tolerances.h"
#include "model/bezier.h"
#include "model/evaluate.h"
#include "model/rational_form.h"
#include "model/trim.h"
#include "slicing/contact/alike_pairs.h"

namespace lamella {

namespace {

/// A face is looked at in pieces of this part of its size, and where its border runs or a gap ends in quarters of them.
constexpr double kPieceSize = 1.0 / 16.0;
constexpr int kBorderHalvings = 4;

/// Where solids touch, pieces are divided on until they are quadrics but for this part of their radius, or so often.
/// Rows can be held against them all the more closely.
constexpr double kPatchBend = 0.002;
constexpr int kPatchHalvings = 4;
constexpr int kMaxHalvings = 24;

/// Cosine of half a right angle: faces that lie along one another are all but parallel, and opposite.
constexpr double kOpposite = 0.7;
/// The same for pieces in parts of which faces may lie so.
constexpr double kNearlyOpposite = 0.5;

/// Solids whose boxes come within `reach`, found along x. The first has the higher rank.
std::vector<SolidPair> near_pairs(const IdVector<SolidId, SolidMeasure>& measures, const IdVector<SolidId, int>& rank,
                                  std::span<const SolidId> solids, double reach) {
  std::vector<SolidId> sorted(solids.begin(), solids.end());
  const auto lowest = [&](SolidId solid) { return measures[solid].bounds.min().x(); };
  std::sort(sorted.begin(), sorted.end(),
            [&](SolidId a, SolidId b) { return std::pair(lowest(a), a) < std::pair(lowest(b), b); });
  std::vector<SolidPair> pairs;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    const Box3& box = measures[sorted[i]].bounds;
    for (std::size_t j = i + 1; j < sorted.size() && lowest(sorted[j]) <= box.max().x() + reach; ++j) {
      if (box.exteriorDistance(measures[sorted[j]].bounds) > reach) continue;
      const bool is_first = rank[sorted[i]] > rank[sorted[j]];
      pairs.emplace_back(sorted[is_first ? i : j], sorted[is_first ? j : i]);
    }
  }
  return pairs;
}

/// Points of a patch at its corners, at the middles of its sides and in its middle: [i][j] with i along u.
using PatchPoints = std::array<std::array<Vec3, 3>, 3>;

PatchPoints points_of(const BezierPatch& patch, const Vec3& middle) {
  const auto corner = [&](int i, int j) -> Vec3 {
    const Vec4& pole = patch.net[static_cast<std::size_t>(i * (patch.degree_v + 1) + j)];
    return pole.head<3>() / pole.w();
  };
  const int m = patch.degree_u;
  const int n = patch.degree_v;
  const double u = patch.u.middle();
  const double v = patch.v.middle();
  return {{{corner(0, 0), evaluate_point(patch, patch.u.lo, v), corner(0, n)},
           {evaluate_point(patch, u, patch.v.lo), middle, evaluate_point(patch, u, patch.v.hi)},
           {corner(m, 0), evaluate_point(patch, patch.u.hi, v), corner(m, n)}}};
}

/// The halves of a patch, across its longer side.
std::pair<BezierPatch, BezierPatch> halved(const BezierPatch& patch, const PatchPoints& points) {
  const auto side = [](const Vec3& a, const Vec3& b, const Vec3& c) { return (a - b).norm() + (b - c).norm(); };
  const double along_u = side(points[0][1], points[1][1], points[2][1]);
  const double along_v = side(points[1][0], points[1][1], points[1][2]);
  return along_u >= along_v ? split_u(patch, patch.u.middle()) : split_v(patch, patch.v.middle());
}

/// Looks along the faces of one solid for another.
class PairSearch {
 public:
  /// `neighbors` are all solids that lie near the first one.
  PairSearch(const SolidDistances& distances, const SolidPair& pair, const Box3& other_bounds,
             std::span<const SolidId> neighbors, const ContactOptions& options)
      : distances_(distances),
        scene_(distances.scene()),
        pair_(pair),
        bounds_(other_bounds),
        neighbors_(neighbors),
        options_(options) {
    contact_.first = std::min(pair.first, pair.second);
    contact_.second = std::max(pair.first, pair.second);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    contact_.touching_z = contact_.gap_z = {kFar, -kFar};
    contact_.least_gap = kFar;
  }

  Contact run() {
    for (const FaceId face : faces_of(scene_, pair_.first)) search(face);
    if (patches_.empty()) return std::move(contact_);
    // Nothing but geometry decides about the order.
    std::sort(patches_.begin(), patches_.end(), [](const ContactPatch& a, const ContactPatch& b) {
      const auto key = [](const ContactPatch& p) {
        return std::tuple(p.center.z(), p.center.y(), p.center.x(), p.radius);
      };
      return key(a) < key(b);
    });
    contact_.faces.assign(faces_.begin(), faces_.end());
    contact_.patches = std::make_shared<const std::vector<ContactPatch>>(std::move(patches_));
    return std::move(contact_);
  }

 private:
  /// A face's patch and what of it is asked for again and again.
  struct FaceSearch {
    FaceId id;
    const TrimRegion* region = nullptr;
    const RationalForm* form = nullptr;
    double piece_size = 0.0;  ///< mm
  };

  void search(FaceId id) {
    const RationalForm form = rational_form(scene_.faces[id].surface, scene_.faces[id].uv_bounds);
    Box3 box;
    for (const BezierPatch& patch : form.patches) box.extend(control_box(patch));
    if (box.isEmpty() || box.exteriorDistance(bounds_) > options_.reach) return;
    const TrimRegion region(scene_, id);
    if (region.boundary().empty()) return;
    const FaceSearch face{id, &region, &form, kPieceSize * box.sizes().norm()};
    for (const BezierPatch& patch : form.patches) divide(face, patch, 0, 0);
  }

  /// Leaves out pieces that are too far, keeps those that are small, halves the others across.
  void divide(const FaceSearch& face, const BezierPatch& patch, int depth, int border_depth) {
    const Box3 box = control_box(patch);
    if (box.exteriorDistance(bounds_) > options_.reach) return;
    const Vec3 middle = evaluate_point(patch, patch.u.middle(), patch.v.middle());
    const double radius = (box.max() - middle).cwiseMax(middle - box.min()).norm();
    if (!distances_.may_come_within(pair_.second, middle, options_.reach + radius)) return;
    const bool is_small = radius <= face.piece_size || depth >= kMaxHalvings;
    if (is_small && is_settled(face, patch, middle, radius, border_depth >= kBorderHalvings)) return;
    const auto [first, second] = halved(patch, points_of(patch, middle));
    divide(face, first, depth + 1, border_depth + (is_small ? 1 : 0));
    divide(face, second, depth + 1, border_depth + (is_small ? 1 : 0));
  }

  /// Measures a small piece, unless the border runs or a gap ends in it and it isn't the `last` that it is halved into.
  bool is_settled(const FaceSearch& face, const BezierPatch& patch, const Vec3& middle, double radius, bool last) {
    const Box2 uv = parameters_of(face, patch);
    const TrimRegion::Side side = face.region->classify(uv.center(), 0.5 * uv.sizes());
    if (side == TrimRegion::Side::outside) return true;
    if (side == TrimRegion::Side::on_boundary && !last) return false;
    const auto near = distances_.find(pair_.second, middle, options_.reach + (last ? 0.0 : radius));
    if (!near) return true;
    if (!last && is_at_rim(face, patch, middle, radius, *near)) return false;
    if (near->distance < options_.reach) measure(face, patch, middle, radius, *near);
    return true;
  }

  static Box2 parameters_of(const FaceSearch& face, const BezierPatch& patch) {
    Box2 uv;
    uv.extend(face.form->to_surface({patch.u.lo, patch.v.lo}));
    uv.extend(face.form->to_surface({patch.u.hi, patch.v.hi}));
    return uv;
  }

  /// Whether an interface or a gap may begin or end in a small piece, by how far the other face is from the middle and
  /// how it leans; from either side alike, or their areas would lean to one.
  [[nodiscard]] bool is_at_rim(const FaceSearch& face, const BezierPatch& patch, const Vec3& middle, double radius,
                               const NearPoint& near) const {
    const Vec3 normal = outward_normal(scene_, face.id, face.form->to_surface({patch.u.middle(), patch.v.middle()}));
    const Vec3 other = near.on_edge ? Vec3(-normal) : outward_normal(scene_, near.face, near.uv);
    if (normal.dot(other) > -kNearlyOpposite) return false;
    const double tolerance = touching_distance(scene_, face.id, near.face, options_.gap_tolerance);
    const double along = (near.point - middle).dot(normal);
    if (near.distance > tolerance && std::abs(along) < kNearlyOpposite * near.distance) return false;
    const double change = near.on_edge ? radius : (normal + other).norm() * radius;
    const auto is_crossed = [&](double limit) {
      return (near.distance - change < limit) != (near.distance + change < limit);
    };
    return is_crossed(tolerance) || (along > 0.0 && is_crossed(options_.reach));
  }

  /// Area of a small piece, by two Gauss points along each parameter.
  [[nodiscard]] double area_of(const FaceSearch& face, const Box2& uv) const {
    const Vec2 aside = 0.5 / std::sqrt(3.0) * uv.sizes();
    double sum = 0.0;
    for (const double u : {-1.0, 1.0}) {
      for (const double v : {-1.0, 1.0}) {
        const Vec2 at = uv.center() + aside.cwiseProduct(Vec2(u, v));
        sum += evaluate(scene_.faces[face.id].surface, at).normal().norm();
      }
    }
    return 0.25 * sum * uv.sizes().prod();
  }

  void measure(const FaceSearch& face, const BezierPatch& patch, const Vec3& middle, double radius,
               const NearPoint& near) {
    const Box2 uv = parameters_of(face, patch);
    const Vec2 at = face.form->to_surface({patch.u.middle(), patch.v.middle()});
    if (face.region->classify(at) == TrimRegion::Side::outside) return;
    const Vec3 normal = outward_normal(scene_, face.id, at);
    if (!near.on_edge && !faces_it(normal, near)) return;
    const double tolerance = touching_distance(scene_, face.id, near.face, options_.gap_tolerance);
    const double area = area_of(face, uv);
    if (near.distance <= tolerance) {
      add_patches(face, patch, 0);
      faces_.insert({face.id, near.face});
      contact_.tolerance = std::max(contact_.tolerance, tolerance);
      contact_.box.extend(Box3(middle.array() - radius, middle.array() + radius));
      contact_.touching_area += area;
      contact_.largest_gap = std::max(contact_.largest_gap, near.distance);
      extend(contact_.touching_z, control_box(patch));
      return;
    }
    // What lies on the inner side overlaps, which is measured on the rows; what lies aside is beyond the other's
    // border.
    if ((near.point - middle).dot(normal) < kOpposite * near.distance) return;
    if (has_another_between(middle, normal, near.distance)) return;
    contact_.gap_area += area;
    contact_.gap_volume += area * near.distance;
    contact_.least_gap = std::min(contact_.least_gap, near.distance);
    contact_.widest_gap = std::max(contact_.widest_gap, near.distance);
    extend(contact_.gap_z, control_box(patch));
  }

  /// Whether a third solid begins in the gap, or fills it.
  [[nodiscard]] bool has_another_between(const Vec3& middle, const Vec3& normal, double distance) const {
    return std::any_of(neighbors_.begin(), neighbors_.end(), [&](SolidId solid) {
      if (solid == pair_.first || solid == pair_.second) return false;
      const auto near = distances_.find(solid, middle, distance);
      return near && (near->on_edge || faces_it(normal, *near));
    });
  }

  /// Half the second fundamental form, of vectors in space: d is taken to (u, v) by the first one's inverse.
  static Mat3 second_form(const SurfacePoint2& s, const Vec3& normal) {
    Eigen::Matrix2d first;
    first << s.du.squaredNorm(), s.du.dot(s.dv), s.du.dot(s.dv), s.dv.squaredNorm();
    if (!(std::abs(first.determinant()) > 0.0)) return Mat3::Zero();
    Eigen::Matrix<double, 2, 3> tangents;
    tangents << s.du.transpose(), s.dv.transpose();
    const Eigen::Matrix<double, 2, 3> to_uv = first.inverse() * tangents;
    Eigen::Matrix2d second;
    second << normal.dot(s.duu), normal.dot(s.duv), normal.dot(s.duv), normal.dot(s.dvv);
    const Mat3 form = 0.5 * to_uv.transpose() * second * to_uv;
    return form.allFinite() ? form : Mat3(Mat3::Zero());
  }

  /// A piece that touches, in parts that are nearly quadrics.
  void add_patches(const FaceSearch& face, const BezierPatch& patch, int depth) {
    ContactPatch out;
    const PatchPoints points = points_of(patch, evaluate_point(patch, patch.u.middle(), patch.v.middle()));
    out.center = points[1][1];
    const Vec2 uv = face.form->to_surface({patch.u.middle(), patch.v.middle()});
    out.normal = outward_normal(scene_, face.id, uv);
    out.form = second_form(evaluate2(scene_.faces[face.id].surface, uv), out.normal);
    // The border's corners and middles are where a small piece is farthest from its middle and its tangent plane.
    for (const auto& row : points) {
      for (const Vec3& point : row) {
        const Vec3 aside = point - out.center;
        out.radius = std::max(out.radius, aside.norm());
        out.bend = std::max(out.bend, std::abs(out.normal.dot(aside) - aside.dot(out.form * aside)));
      }
    }
    if (depth == kPatchHalvings || out.bend <= kPatchBend * out.radius) {
      patches_.push_back(out);
      return;
    }
    const auto [first, second] = halved(patch, points);
    add_patches(face, first, depth + 1);
    add_patches(face, second, depth + 1);
  }

  /// Whether the other face looks at this one. Faces side by side, and walls of one and the other that run on in one
  /// plane, don't.
  [[nodiscard]] bool faces_it(const Vec3& normal, const NearPoint& near) const {
    return normal.dot(outward_normal(scene_, near.face, near.uv)) < -kOpposite;
  }

  static void extend(Interval& range, const Box3& box) {
    range = {std::min(range.lo, box.min().z()), std::max(range.hi, box.max().z())};
  }

  const SolidDistances& distances_;
  const Scene& scene_;
  SolidPair pair_;
  const Box3& bounds_;
  std::span<const SolidId> neighbors_;
  const ContactOptions& options_;
  Contact contact_;
  std::vector<ContactPatch> patches_;
  std::set<FaceId> faces_;
};

/// The contact of a pair that is like the one that was searched. Faces of the solids of both are numbered alike.
Contact moved(const Scene& scene, const Contact& contact, const SolidPair& from, const SolidPair& to) {
  Contact out = contact;
  std::tie(out.first, out.second) = std::minmax(to.first, to.second);
  const auto first_face = [&](SolidId solid) {
    return scene.shells[scene.solids[solid].shells.first].faces.first.value();
  };
  for (FaceId& face : out.faces) {
    const SolidId solid = scene.solid_of(face);
    const SolidId renamed = solid == from.first ? to.first : to.second;
    face = FaceId{face.value() + first_face(renamed) - first_face(solid)};
  }
  std::sort(out.faces.begin(), out.faces.end());
  out.offset = shift_between(scene, from.first, to.first);
  if (out.patches) out.box.translate(out.offset);
  return out;
}

}  // namespace

double touching_distance(const Scene& scene, FaceId a, FaceId b, const std::optional<double>& gap_tolerance) {
  if (gap_tolerance) return *gap_tolerance;
  return std::max({tolerance::kMinGap, scene.faces[a].tolerance, scene.faces[b].tolerance});
}

std::vector<Contact> find_contacts(const SolidDistances& distances, const IdVector<SolidId, SolidMeasure>& measures,
                                   const IdVector<SolidId, int>& rank, std::span<const SolidId> solids,
                                   const ContactOptions& options, const Progress& progress) {
  const std::vector<SolidPair> pairs = near_pairs(measures, rank, solids, options.reach);
  const std::vector<AlikePairs> alike = find_alike_pairs(distances.scene(), pairs);
  std::map<SolidId, std::vector<SolidId>> neighbors;
  for (const auto& [first, second] : pairs) {
    neighbors[first].push_back(second);
    neighbors[second].push_back(first);
  }
  std::vector<Contact> found(alike.size());
  parallel_for(
      alike.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        const SolidPair& pair = pairs[alike[i].first];
        const Box3& bounds = measures[pair.second].bounds;
        found[i] = PairSearch(distances, pair, bounds, neighbors.at(pair.first), options).run();
      },
      options.threads);
  std::vector<Contact> contacts;
  for (std::size_t i = 0; i < alike.size(); ++i) {
    if (!found[i].patches && !(found[i].gap_area > 0.0)) continue;
    for (const std::size_t other : alike[i].like) {
      contacts.push_back(moved(distances.scene(), found[i], pairs[alike[i].first], pairs[other]));
    }
    contacts.push_back(std::move(found[i]));
  }
  std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  return contacts;
}

}  // namespace lamella
