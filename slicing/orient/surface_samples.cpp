#include "slicing/orient/surface_samples.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/parallel.h"
#include "model/bounds.h"
#include "model/evaluate.h"
#include "model/face_integration.h"
#include "model/trim.h"
#include "slicing/reference/reference_engine.h"

namespace lamella {

namespace {

constexpr double kOutward = 2e-5;  // of the solids' size

/// The fraction of i * golden ratio and its companion of two dimensions (Roberts 2018): points that fill a rectangle
/// evenly at any count.
Vec2 low_discrepancy(std::size_t i) {
  constexpr double kPlastic = 1.32471795724474602596;  // root of x^3 = x + 1
  const auto n = static_cast<double>(i + 1);
  return {std::fmod(0.5 + n / kPlastic, 1.0), std::fmod(0.5 + n / (kPlastic * kPlastic), 1.0)};
}

/// Samples of one face; none when its area can't be had.
std::vector<SurfaceSample> sample_face(const Scene& scene, FaceId id, double area, std::size_t count) {
  const Face& face = scene.faces[id];
  std::vector<SurfaceSample> samples;
  const TrimRegion region(scene, id);
  if (region.bounds().isEmpty() || !(area > 0.0)) return samples;
  const Vec2 lo = region.bounds().min();
  const Vec2 size = region.bounds().sizes();
  double weight = 0.0;
  // A narrow face fills little of its parameter box; after 200 tries a sample it counts as unsampled.
  for (std::size_t i = 0; i < 200 * count && samples.size() < count; ++i) {
    const Vec2 uv = lo + low_discrepancy(i).cwiseProduct(size);
    if (region.classify(uv) != TrimRegion::Side::inside) continue;
    const SurfacePoint at = evaluate(face.surface, uv);
    const Vec3 normal = at.normal();
    const double length = normal.norm();
    if (!(length > 0.0) || !at.point.allFinite()) continue;
    samples.push_back({at.point, (face.same_sense ? 1.0 : -1.0) / length * normal, length, id});
    weight += length;
  }
  for (SurfaceSample& sample : samples) sample.area *= area / weight;
  return samples;
}

class Sampler {
 public:
  Sampler(const Scene& scene, std::span<const SolidId> solids, const Progress& progress, int threads)
      : scene_(scene), solids_(solids), progress_(progress), threads_(threads) {
    for (const SolidId solid : solids) {
      for (const ShellId shell : scene.solids[solid].shells) {
        for (const FaceId face : scene.shells[shell].faces) faces_.push_back(face);
      }
    }
  }

  SurfaceSamples run(std::size_t count) {
    measure();
    double total = 0.0;
    for (const double area : areas_) total += area;
    std::vector<std::vector<SurfaceSample>> found(faces_.size());
    for_each("sampling the surface", faces_.size(), [&](std::size_t i) {
      constexpr double kLeast = 4.0;
      const double share = total > 0.0 ? areas_[i] / total : 0.0;
      found[i] =
          sample_face(scene_, faces_[i], areas_[i],
                      static_cast<std::size_t>(std::max(kLeast, std::round(share * static_cast<double>(count)))));
    });
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      if (found[i].empty()) result_.unsampled.push_back(faces_[i]);
      result_.samples.insert(result_.samples.end(), found[i].begin(), found[i].end());
    }
    if (solids_.size() > 1) leave_out_buried();
    for (const SurfaceSample& sample : result_.samples) result_.area += sample.area;
    return std::move(result_);
  }

 private:
  void for_each(const char* stage, std::size_t count, const std::function<void(std::size_t)>& body) {
    std::atomic<std::size_t> done{0};
    parallel_for(
        count,
        [&](std::size_t i) {
          progress_.throw_if_cancelled();
          body(i);
          progress_.report(stage, static_cast<double>(++done) / static_cast<double>(count));
        },
        threads_);
  }

  void measure() {
    areas_.resize(faces_.size());
    boxes_.resize(faces_.size());
    for_each("measuring faces", faces_.size(), [&](std::size_t i) {
      constexpr double kAreaError = 1e-6;
      const std::array<FaceId, 1> face{faces_[i]};
      const SurfaceSums sums = integrate_faces(scene_, face, kAreaError);
      areas_[i] = std::isfinite(sums.area) ? std::abs(sums.area) : 0.0;
      boxes_[i] = face_bounds(scene_, faces_[i]).box;
    });
  }

  void leave_out_buried() {
    IdVector<SolidId, Box3> boxes(scene_.solids.size());
    Box3 all;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      boxes[scene_.solid_of(faces_[i])].extend(boxes_[i]);
      all.extend(boxes_[i]);
    }
    if (all.isEmpty()) return;
    const double out = kOutward * all.diagonal().norm();
    const ReferenceEngine engine(scene_, solids_, {}, progress_, threads_);
    std::vector<char> is_buried(result_.samples.size(), 0);
    constexpr std::size_t kBatch = 64;
    for_each("finding the outside", (is_buried.size() + kBatch - 1) / kBatch, [&](std::size_t batch) {
      SolidCast cast;
      CastCounters counters;
      for (std::size_t i = batch * kBatch; i < std::min(is_buried.size(), (batch + 1) * kBatch); ++i) {
        const SurfaceSample& sample = result_.samples[i];
        const Ray ray{sample.point + out * sample.normal, sample.normal};
        const Vec3 up = sample.normal.unitOrthogonal();
        for (const SolidId solid : solids_) {
          if (solid == scene_.solid_of(sample.face) || !boxes[solid].contains(ray.origin)) continue;
          engine.cast(ray, up, solid, cast, counters);
          for (const Span& span : cast.spans) is_buried[i] |= span.begin <= 0.0 && 0.0 < span.end;
          if (is_buried[i]) break;
        }
      }
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < is_buried.size(); ++i) {
      if (is_buried[i]) {
        result_.buried_area += result_.samples[i].area;
      } else {
        result_.samples[kept++] = result_.samples[i];
      }
    }
    result_.samples.resize(kept);
  }

  const Scene& scene_;
  std::span<const SolidId> solids_;
  const Progress& progress_;
  int threads_;
  std::vector<FaceId> faces_;
  std::vector<double> areas_;
  std::vector<Box3> boxes_;
  SurfaceSamples result_;
};

}  // namespace

SurfaceSamples sample_surfaces(const Scene& scene, std::span<const SolidId> solids, std::size_t count,
                               const Progress& progress, int threads) {
  return Sampler(scene, solids, progress, threads).run(count);
}

}  // namespace lamella
