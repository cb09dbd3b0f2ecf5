#include "model/face_integration.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/error.h"
#include "model/face_quadrature.h"

namespace lamella {

namespace {

constexpr int kMaxLevel = 8;
/// Surface evaluations one level of one face may take: about a second.
constexpr double kMaxCost = 2e7;
/// Where no more than this relative error is asked for, the first level is level 0.
constexpr double kCoarse = 1e-5;
/// Of the surface area: the |n| integrals only bound a quadrature error.
constexpr double kAbsNormalError = 3e-3;
/// Of the surface area, too: no result hangs on it, and what is reached is far better (docs/methods/measure.md).
constexpr double kAreaError = 1e-6;
/// Sums of products of lengths of this size carry rounding of a few ulp, which no refinement removes.
constexpr double kRounding = 1e-14;

struct Errors {
  double volume = 0.0;
  double area = 0.0;
  double abs_normal = 0.0;

  Errors& operator+=(const Errors& other) {
    volume += other.volume;
    area += other.area;
    abs_normal += other.abs_normal;
    return *this;
  }
};

Errors difference(const FaceIntegrals& a, const FaceIntegrals& b) {
  return {std::abs(a.flux - b.flux), std::abs(a.area - b.area),
          (a.abs_normal_area - b.abs_normal_area).cwiseAbs().maxCoeff()};
}

/// One face and what its integrals change by when either of the two levels is one lower.
class FaceEstimate {
 public:
  FaceEstimate(const Scene& scene, FaceId face, const Vec3& reference, QuadratureLevel level)
      : face_(face), quadrature_(scene, face), reference_(reference), level_(level) {
    update();
  }

  /// Raises the levels whose share of the error is above `allowed`; false if the work it may take is spent.
  bool refine(const Errors& allowed) {
    const bool outer = exceeds(outer_error_, allowed);
    const bool inner = exceeds(inner_error_, allowed);
    const QuadratureLevel finer{level_.outer + outer, level_.inner + inner};
    if (!(outer || inner) || std::max(finer.outer, finer.inner) > kMaxLevel || quadrature_.cost(finer) > kMaxCost) {
      return false;
    }
    level_ = finer;
    update();
    return true;
  }

  [[nodiscard]] FaceId face() const { return face_; }
  [[nodiscard]] const FaceIntegrals& value() const { return value_; }
  [[nodiscard]] Errors errors() const {
    Errors errors = outer_error_;
    errors += inner_error_;
    return errors;
  }

 private:
  static bool exceeds(const Errors& errors, const Errors& allowed) {
    return errors.volume > 0.5 * allowed.volume || errors.area > 0.5 * allowed.area ||
           errors.abs_normal > 0.5 * allowed.abs_normal;
  }

  void update() {
    value_ = quadrature_.integrate(reference_, level_);
    outer_error_ = difference(value_, quadrature_.integrate(reference_, {level_.outer - 1, level_.inner}));
    if (quadrature_.has_inner_levels()) {
      inner_error_ = difference(value_, quadrature_.integrate(reference_, {level_.outer, level_.inner - 1}));
    }
  }

  FaceId face_;
  FaceQuadrature quadrature_;
  Vec3 reference_;
  QuadratureLevel level_;
  FaceIntegrals value_;
  Errors outer_error_;
  Errors inner_error_;
};

class Integration {
 public:
  Integration(const Scene& scene, std::span<const FaceId> faces, double relative_error)
      : relative_error_(relative_error) {
    const Vec3 reference = middle_of(scene, faces);
    estimates_.reserve(faces.size());
    for (const FaceId face : faces) add(scene, face, reference);
    size_ = size_of(scene, faces);
  }

  SurfaceSums run() {
    for (int round = 0; round < kMaxLevel && !within(errors(), allowed()); ++round) {
      if (!refine_worst()) break;
    }
    SurfaceSums sums = sum();
    sums.volume_error = errors().volume;
    sums.unmeasured = unmeasured_;
    sums.converged = unmeasured_.empty() && within(errors(), allowed());
    return sums;
  }

 private:
  void add(const Scene& scene, FaceId face, const Vec3& reference) {
    try {
      FaceEstimate estimate(scene, face, reference, first_level());
      if (estimate.value().is_finite()) {
        estimates_.push_back(std::move(estimate));
        return;
      }
    } catch (const GeometryError&) {
      // Named by the caller: one bad face must not keep the other solids from being measured.
    }
    unmeasured_.push_back(face);
  }

  [[nodiscard]] QuadratureLevel first_level() const {
    return relative_error_ < kCoarse ? QuadratureLevel{1, 1} : QuadratureLevel{0, 0};
  }

  static double size_of(const Scene& scene, std::span<const FaceId> faces);

  [[nodiscard]] SurfaceSums sum() const {
    SurfaceSums sums;
    for (const FaceEstimate& face : estimates_) {
      sums.volume += face.value().flux;
      sums.area += std::abs(face.value().area);
      sums.abs_normal_area += face.value().abs_normal_area.cwiseAbs();
      if (face.value().area < 0.0) sums.contradictory.push_back(face.face());
    }
    return sums;
  }

  [[nodiscard]] Errors errors() const {
    Errors errors;
    for (const FaceEstimate& face : estimates_) errors += face.errors();
    return errors;
  }

  [[nodiscard]] Errors allowed() const {
    const SurfaceSums sums = sum();
    return {std::max(relative_error_ * std::abs(sums.volume), kRounding * sums.area * size_),
            std::max(relative_error_, kAreaError) * sums.area, kAbsNormalError * sums.area};
  }

  static bool within(const Errors& errors, const Errors& allowed) {
    return errors.volume <= allowed.volume && errors.area <= allowed.area && errors.abs_normal <= allowed.abs_normal;
  }

  /// Refines the faces that hold more than their share of an error; false if none can be refined further.
  bool refine_worst() {
    const double share = 1.0 / static_cast<double>(estimates_.size());
    const Errors all = allowed();
    const Errors limit{share * all.volume, share * all.area, share * all.abs_normal};
    bool refined = false;
    for (FaceEstimate& face : estimates_) refined = face.refine(limit) || refined;
    return refined;
  }

  double relative_error_;
  double size_ = 0.0;
  std::vector<FaceId> unmeasured_;
  std::vector<FaceEstimate> estimates_;
};

Box3 vertex_box(const Scene& scene, std::span<const FaceId> faces) {
  Box3 box;
  for (const FaceId face : faces) {
    for (const LoopId loop : scene.faces[face].loops) {
      for (const HalfEdgeId id : scene.loops[loop].half_edges) {
        const Edge& edge = scene.edges[scene.half_edges[id].edge];
        box.extend(scene.vertices[edge.start].point);
        box.extend(scene.vertices[edge.end].point);
      }
    }
  }
  return box;
}

double Integration::size_of(const Scene& scene, std::span<const FaceId> faces) {
  const Box3 box = vertex_box(scene, faces);
  return box.isEmpty() ? 0.0 : box.sizes().norm();
}

}  // namespace

Vec3 middle_of(const Scene& scene, std::span<const FaceId> faces) {
  const Box3 box = vertex_box(scene, faces);
  if (box.isEmpty() || !box.center().allFinite()) return Vec3::Zero();
  return box.center();
}

SurfaceSums integrate_faces(const Scene& scene, std::span<const FaceId> faces, double relative_error) {
  return Integration(scene, faces, relative_error).run();
}

double winding_number(const Scene& scene, std::span<const FaceId> faces, const Vec3& point) {
  constexpr double kGoodEnough = 0.02;
  double angle = 0.0;
  const double share = kGoodEnough / static_cast<double>(std::max<std::size_t>(faces.size(), 1));
  for (const FaceId face : faces) {
    const FaceQuadrature quadrature(scene, face);
    double value = quadrature.solid_angle(point, {0, 0});
    for (int level = 1; level <= kMaxLevel && quadrature.cost({level, level}) <= 0.1 * kMaxCost; ++level) {
      const double finer = quadrature.solid_angle(point, {level, level});
      const double change = std::abs(finer - value);
      value = finer;
      if (change <= 4.0 * kPi * share) break;
    }
    angle += value;
  }
  return angle / (4.0 * kPi);
}

}  // namespace lamella
