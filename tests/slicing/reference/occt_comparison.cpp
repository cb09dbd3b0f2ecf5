#include "tests/slicing/reference/occt_comparison.h"

#include <BRepClass3d_SolidClassifier.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <TopoDS_Solid.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <span>

#include "model/evaluate.h"
#include "model/measure.h"
#include "model/step/read_step.h"
#include "tests/support/occt_solids.h"

namespace lamella::test {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Depths of OpenCASCADE's intersections, ascending; those that an edge shared by two faces gives twice are dropped.
std::vector<double> occt_depths(IntCurvesFace_ShapeIntersector& intersector, const Ray& ray, double same) {
  const gp_Lin line(gp_Pnt(ray.origin.x(), ray.origin.y(), ray.origin.z()),
                    gp_Dir(ray.direction.x(), ray.direction.y(), ray.direction.z()));
  intersector.Perform(line, -1e10, 1e10);
  struct Intersection {
    double t;
    bool enters;
  };
  std::vector<Intersection> found;
  for (int k = 1; intersector.IsDone() && k <= intersector.NbPnt(); ++k) {
    found.push_back({intersector.WParameter(k), intersector.Transition(k) == IntCurveSurface_In});
  }
  std::sort(found.begin(), found.end(), [](const Intersection& a, const Intersection& b) { return a.t < b.t; });
  const auto last = std::unique(found.begin(), found.end(), [same](const Intersection& a, const Intersection& b) {
    return b.t - a.t < same && a.enters == b.enters;
  });
  std::vector<double> depths;
  for (auto it = found.begin(); it != last; ++it) depths.push_back(it->t);
  return depths;
}

std::vector<double> ends(const std::vector<Span>& spans) {
  std::vector<double> result;
  for (const Span& span : spans) result.insert(result.end(), {span.begin, span.end});
  return result;
}

/// How far the end of a span may lie off: the tolerance across the surface, over |n.d|.
double allowance(const Scene& scene, const Hit& hit, const Ray& ray, double tolerance) {
  const Vec3 normal = evaluate(scene.faces[hit.face].surface, hit.uv).normal().normalized();
  return tolerance / std::max(1e-9, std::abs(normal.dot(ray.direction)));
}

bool agree(const Scene& scene, const SolidCast& cast, const std::vector<double>& occt, const Ray& ray,
           double tolerance) {
  if (occt.size() != cast.hits.size()) return false;
  for (std::size_t k = 0; k < occt.size(); ++k) {
    if (!(std::abs(occt[k] - cast.hits[k].t) <= allowance(scene, cast.hits[k], ray, tolerance))) return false;
  }
  return true;
}

bool inside(const std::vector<double>& depths, double t) {
  return (std::upper_bound(depths.begin(), depths.end(), t) - depths.begin()) % 2 == 1;
}

/// The longest interval that exactly one of the two has inside.
Interval longest_disputed(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> cuts = a;
  cuts.insert(cuts.end(), b.begin(), b.end());
  std::sort(cuts.begin(), cuts.end());
  Interval longest{0.0, 0.0};
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const Interval between{cuts[k], cuts[k + 1]};
    if (inside(a, between.middle()) != inside(b, between.middle()) && between.length() > longest.length()) {
      longest = between;
    }
  }
  return longest;
}

Kind kind_of(const std::vector<double>& engine, const std::vector<double>& occt) {
  if (occt.size() % 2 == 1) return Kind::odd_hits;
  if (occt.size() < engine.size()) return Kind::fewer_spans;
  return occt.size() > engine.size() ? Kind::more_spans : Kind::other_depth;
}

Dispute judge(BRepClass3d_SolidClassifier& classifier, SolidId solid, const Ray& ray, const SolidCast& cast,
              std::vector<double> occt, double tolerance) {
  const std::vector<double> engine = ends(cast.spans);
  Dispute dispute{solid, ray, kind_of(engine, occt), Verdict::boundary, 0.0, cast.spans, occt};
  const Interval disputed = longest_disputed(engine, occt);
  dispute.length = disputed.length();
  const Vec3 point = ray.at(disputed.middle());
  classifier.Perform(gp_Pnt(point.x(), point.y(), point.z()), tolerance);
  const TopAbs_State state = classifier.State();
  if (disputed.length() > 0.0 && (state == TopAbs_IN || state == TopAbs_OUT)) {
    const bool engine_right = inside(engine, disputed.middle()) == (state == TopAbs_IN);
    dispute.verdict = engine_right ? Verdict::engine : Verdict::occt;
  }
  return dispute;
}

Ray random_ray(const Box3& box, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::normal_distribution<double> normal;
  const Vec3 share(unit(random), unit(random), unit(random));
  const Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
  return {box.min() + box.sizes().cwiseProduct(share), direction};
}

}  // namespace

const char* kind_name(Kind kind) {
  static constexpr const char* kNames[kKinds] = {"odd number of hits", "fewer spans", "more spans", "other depth"};
  return kNames[static_cast<int>(kind)];
}

std::uint64_t OcctComparison::count(Kind kind, Verdict verdict) const {
  return static_cast<std::uint64_t>(std::count_if(disputes.begin(), disputes.end(), [&](const Dispute& dispute) {
    return dispute.kind == kind && dispute.verdict == verdict;
  }));
}

OcctComparison compare_with_occt(const std::filesystem::path& file, int rays_per_solid, std::uint32_t seed,
                                 double tolerance, double seconds_per_solid) {
  const Scene scene = read_step(std::span(&file, 1));
  const std::vector<TopoDS_Solid> solids = occt_solids(file);
  std::vector<SolidMeasure> measures;
  for (const SolidId id : scene.solids.ids()) measures.push_back(measure_solid(scene, id, 1e-4));
  const std::vector<int> partner = match_solids(measures, solids);
  const ReferenceEngine engine(scene, {}, {}, 1);

  OcctComparison result;
  std::mt19937 random(seed);
  for (const SolidId id : scene.solids.ids()) {
    const SolidInfo& info = scene.solids[id].info;
    if (partner[id.value()] < 0 || !info.closed) continue;
    result.tolerance = std::max({result.tolerance, tolerance, 2.0 * info.max_tolerance});
    const TopoDS_Solid& solid = solids[partner[id.value()]];
    IntCurvesFace_ShapeIntersector intersector;
    intersector.Load(solid, 1e-9);
    BRepClass3d_SolidClassifier classifier(solid);
    const double same = std::max(1e-6, 2.0 * info.max_tolerance);
    const Clock::time_point begin = Clock::now();
    for (int k = 0; k < rays_per_solid && seconds_since(begin) < seconds_per_solid; ++k) {
      const Ray ray = random_ray(measures[id.value()].bounds, random);
      SolidCast cast;
      Clock::time_point start = Clock::now();
      engine.cast(ray, Vec3::UnitZ(), id, cast, result.counters);
      result.engine_seconds += seconds_since(start);
      start = Clock::now();
      std::vector<double> occt = occt_depths(intersector, ray, same);
      result.occt_seconds += seconds_since(start);
      ++result.rays;
      result.met += !cast.spans.empty() || !occt.empty() ? 1 : 0;
      if (agree(scene, cast, occt, ray, result.tolerance)) {
        ++result.agreed;
      } else {
        result.disputes.push_back(judge(classifier, id, ray, cast, std::move(occt), tolerance));
      }
    }
  }
  return result;
}

}  // namespace lamella::test
