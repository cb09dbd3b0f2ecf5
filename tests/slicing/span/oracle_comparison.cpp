#include "tests/slicing/span/oracle_comparison.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "model/evaluate.h"
#include "slicing/reference/reference_engine.h"
#include "tests/support/cut_scene.h"
#include "tests/support/single_solid.h"
#include "tests/support/span_sets.h"

namespace lamella::test {

namespace {

constexpr std::size_t kMaxExamples = 5;

double unit(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// One solid, prepared by both engines.
class SolidComparison {
 public:
  SolidComparison(const Scene& scene, SolidId solid, const OracleOptions& options, std::mt19937_64& random)
      : scene_(single_solid(scene, solid)),
        number_(solid.value()),
        options_(options),
        random_(random),
        engine_(scene_, all_solids(scene_), {1e-7, 1}),
        oracle_(scene_, {}, {}, 1),
        box_(solid_box(scene_, SolidId{0})) {}

  OracleTally run() {
    for (std::size_t i = 0; i < options_.slabs; ++i) compare_slab();
    return tally_;
  }

 private:
  void compare_slab() {
    const double distance = box_.sizes().z() / options_.layers_a_solid;
    const double reach = static_cast<double>(kSlabLayers - 1) * distance;
    const double first = box_.min().z() - 0.5 * reach + unit(random_) * box_.sizes().z();
    std::vector<LayerRequest> slab;
    for (std::size_t k = 0; k < kSlabLayers; ++k) slab.push_back({k, first + static_cast<double>(k) * distance, {}});
    for (std::size_t i = 0; i < options_.layers; ++i) {
      slab[random_() % kSlabLayers].lattices.push_back(draw_lattice());
    }
    std::vector<LayerSpans> layers(slab.size());
    engine_.cut(slab, layers);
    for (std::size_t k = 0; k < slab.size(); ++k) {
      tally_.unclosed += layers[k].cast.unclosed_rays;
      tally_.doubtful += layers[k].cast.uncertain_hits;
      for (std::size_t i = 0; i < slab[k].lattices.size(); ++i) {
        const RowLattice& lattice = slab[k].lattices[i];
        for (std::int64_t row = 0; row < lattice.last_row; ++row) {
          const auto spans = spans_of(layers[k].lattices[i], static_cast<std::size_t>(row), SolidId{0});
          compare_ray(ray_of(lattice, row, slab[k].z), spans);
        }
      }
    }
  }

  RowLattice draw_lattice() {
    const double angles[] = {0.0, 0.5 * kPi, 67.0 * kPi / 180.0, kTwoPi * unit(random_)};
    const auto rows = static_cast<std::int64_t>(options_.rows);
    return lattice_over(box_, angles[random_() % 4], rows, unit(random_));
  }

  void compare_ray(const Ray& ray, const std::vector<Interval>& spans) {
    SolidCast cast;
    CastCounters counters;
    oracle_.cast(ray, Vec3::UnitZ(), SolidId{0}, cast, counters);
    if (cast.spans.empty() && spans.empty()) return;
    ++tally_.solid_rays;
    if (agrees(ray, cast, spans)) {
      ++tally_.agree;
    } else if (is_in_zone(cast, counters)) {
      ++tally_.in_zone;
    } else if (grazes(ray, cast, spans)) {
      ++tally_.grazing;
    } else {
      ++tally_.differ;
      note(ray, cast, spans);
    }
  }

  bool agrees(const Ray& ray, const SolidCast& cast, const std::vector<Interval>& spans) {
    if (cast.spans.size() != spans.size()) return false;
    double worst = 0.0;
    for (std::size_t i = 0; i < spans.size(); ++i) {
      worst = std::max({worst, error_at(ray, cast, cast.spans[i].begin, spans[i].lo),
                        error_at(ray, cast, cast.spans[i].end, spans[i].hi)});
    }
    if (!(worst <= kOracleBound)) return false;
    tally_.worst = std::max(tally_.worst, worst);
    return true;
  }

  /// |x - exact| |n . d|, by the normal at the hit that the span's end came from.
  double error_at(const Ray& ray, const SolidCast& cast, double exact, double x) const {
    const auto hit = std::min_element(cast.hits.begin(), cast.hits.end(), [&](const Hit& a, const Hit& b) {
      return std::abs(a.t - exact) < std::abs(b.t - exact);
    });
    const double error = std::abs(x - exact);
    if (hit == cast.hits.end()) return error;
    const Vec3 normal = evaluate(scene_.faces[hit->face].surface, hit->uv).normal();
    const double facing = std::abs(normal.normalized().dot(ray.direction));
    return std::isfinite(facing) ? error * facing : error;
  }

  static bool is_in_zone(const SolidCast& cast, const CastCounters& counters) {
    if (counters.tolerance_rays + counters.repaired_rays + counters.unclosed_rays + counters.uncertain_hits > 0) {
      return true;
    }
    return std::any_of(cast.hits.begin(), cast.hits.end(),
                       [](const Hit& hit) { return (hit.flags & (kNearEdge | kTangent | kUncertain)) != 0; });
  }

  /// Whether the spans lie between what the oracle finds on the ray and on rays within the bound of it.
  bool grazes(const Ray& ray, const SolidCast& cast, const std::vector<Interval>& spans) const {
    std::vector<Interval> any = intervals(cast);
    std::vector<Interval> all = any;
    const Vec3 across = kOracleBound * Vec3::UnitZ().cross(ray.direction);
    const Vec3 up = kOracleBound * Vec3::UnitZ();
    for (const Vec3& aside : {Vec3(across + up), Vec3(across - up), Vec3(up - across), Vec3(-across - up)}) {
      SolidCast moved;
      CastCounters ignored;
      oracle_.cast({ray.origin + aside, ray.direction}, Vec3::UnitZ(), SolidId{0}, moved, ignored);
      any = united(any, intervals(moved));
      all = common(all, intervals(moved));
    }
    return longest(without(spans, grown(any, kOracleBound))) <= kOracleBound &&
           longest(without(grown(all, -kOracleBound), spans)) <= kOracleBound;
  }

  static std::vector<Interval> intervals(const SolidCast& cast) {
    std::vector<Interval> result;
    for (const Span& span : cast.spans) result.push_back({span.begin, span.end});
    return result;
  }

  void note(const Ray& ray, const SolidCast& cast, const std::vector<Interval>& spans) {
    if (tally_.examples.size() >= kMaxExamples) return;
    std::ostringstream text;
    text.precision(12);
    text << "solid " << number_ << " z " << ray.origin.z() << " direction " << ray.direction.head<2>().transpose()
         << " row " << Vec3::UnitZ().cross(ray.direction).dot(ray.origin) << " oracle" << text_of(intervals(cast))
         << " span engine" << text_of(spans);
    tally_.examples.push_back(text.str());
  }

  Scene scene_;
  std::uint32_t number_;
  const OracleOptions& options_;
  std::mt19937_64& random_;
  SpanEngine engine_;
  ReferenceEngine oracle_;
  Box3 box_;
  OracleTally tally_;
};

}  // namespace

OracleTally& OracleTally::operator+=(const OracleTally& other) {
  solid_rays += other.solid_rays;
  agree += other.agree;
  in_zone += other.in_zone;
  grazing += other.grazing;
  differ += other.differ;
  worst = std::max(worst, other.worst);
  unclosed += other.unclosed;
  doubtful += other.doubtful;
  examples.insert(examples.end(), other.examples.begin(), other.examples.end());
  return *this;
}

OracleTally compare_with_oracle(const Scene& scene, const OracleOptions& options) {
  std::mt19937_64 random(options.seed);
  std::vector<SolidId> solids = sound_solids(scene);
  for (std::size_t i = solids.size(); i > 1; --i) std::swap(solids[i - 1], solids[random() % i]);
  if (solids.size() > options.solids) solids.resize(options.solids);
  OracleTally tally;
  for (const SolidId solid : solids) tally += SolidComparison(scene, solid, options, random).run();
  return tally;
}

}  // namespace lamella::test
