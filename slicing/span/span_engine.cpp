#include "slicing/span/span_engine.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "core/parallel.h"
#include "slicing/span/contours.h"
#include "slicing/span/face_model.h"
#include "slicing/span/face_section.h"
#include "slicing/span/row_cast.h"

namespace lamella {

using namespace span;

namespace {

/// Events nearer than this are one feature seen through rounding; together they span at most kWidestCluster.
constexpr double kSameFeature = 1e-9;    // mm
constexpr double kWidestCluster = 1e-8;  // mm

/// A fit that keeps closer than this is as good as the arcs themselves.
constexpr double kFitWorthNaming = 1e-6;  // mm

/// One solid, prepared.
struct SolidSpans {
  SolidId id;
  EdgePieces edges;
  std::vector<FaceModel> faces;
  std::vector<Interval> clusters;  ///< ascending
  double low = 0.0;                ///< range of heights of its faces
  double high = 0.0;

  SolidSpans(const Scene& scene, SolidId solid) : id(solid), edges(scene, solid) {
    for (const ShellId shell : scene.solids[solid].shells) {
      for (const FaceId face : scene.shells[shell].faces) {
        faces.emplace_back(scene, face, edges);
        if (faces.back().events.empty()) faces.pop_back();
      }
    }
    if (faces.empty()) return;
    low = faces.front().events.front();
    high = faces.front().events.back();
    for (const FaceModel& face : faces) {
      low = std::min(low, face.events.front());
      high = std::max(high, face.events.back());
    }
    find_clusters();
  }

  /// The height at which a layer at z is cut. Between the heights of one feature as different faces have them (a
  /// horizontal edge whose vertices differ in the last bit) the section is noise: such a layer is cut at their upper
  /// end, as the half-open rule has it, in all faces alike.
  [[nodiscard]] double settled(double z) const {
    const auto above = std::upper_bound(clusters.begin(), clusters.end(), z,
                                        [](double height, const Interval& cluster) { return height < cluster.hi; });
    return above != clusters.end() && z >= above->lo ? above->hi : z;
  }

  void find_clusters() {
    std::vector<double> events;
    for (const FaceModel& face : faces) events.insert(events.end(), face.events.begin(), face.events.end());
    std::sort(events.begin(), events.end());
    for (std::size_t first = 0; first < events.size();) {
      std::size_t last = first;
      while (last + 1 < events.size() && events[last + 1] - events[last] <= kSameFeature &&
             events[last + 1] - events[first] <= kWidestCluster) {
        ++last;
      }
      if (events[last] > events[first]) clusters.push_back({events[first], events[last]});
      first = last + 1;
    }
  }

  /// Whether it may have a section at a height from `from` to `to`.
  [[nodiscard]] bool meets(double from, double to) const { return low <= to && from <= high; }
};

/// Adds a solid's loops to those of a layer.
void append_loops(const SectionContours& section, LayerContours& out) {
  const auto first = static_cast<std::int32_t>(out.loops.size());
  for (const SectionLoop& loop : section.loops) {
    out.add({section.solid, loop.parent < 0 ? -1 : first + loop.parent, loop.area}, loop.points, loop.curves);
  }
}

/// What is carried through a slab for one solid.
class SolidSlab {
 public:
  SolidSlab(const Scene& scene, const SolidSpans& solid, std::span<const double> heights, const TraceLimits& limits)
      : solid_(&solid), nodes_(solid.edges) {
    for (const double z : heights) heights_.push_back(solid.settled(z));
    const double from = heights_.front();
    const double to = heights_.back();
    for (const FaceModel& face : solid.faces) {
      if (face.events.front() <= to && from < face.events.back())
        faces_.emplace_back(scene, face, solid.edges, limits, heights_);
    }
  }

  void cut(std::size_t layer, Section& out) {
    const double z = heights_[layer];
    if (!solid_->meets(z, z)) return;
    nodes_.start_layer(z);
    for (FaceSection& face : faces_) face.cut(layer, nodes_, out);
  }

 private:
  const SolidSpans* solid_;
  std::vector<double> heights_;
  NodeTable nodes_;
  std::vector<FaceSection> faces_;
};

}  // namespace

struct SpanEngine::Data {
  const Scene* scene = nullptr;
  SpanOptions options;
  std::vector<std::unique_ptr<const SolidSpans>> solids;
  std::vector<Finding> findings;

  [[nodiscard]] TraceLimits limits() const {
    TraceLimits limits;
    limits.tolerance = options.tolerance;
    return limits;
  }

  /// Names faces that are not cut exactly, or whose changes of topology are not all known.
  void add_findings(const SolidSpans& solid) {
    for (const FaceModel& face : solid.faces) {
      const auto* fitted = std::get_if<FittedSurface>(&scene->faces[face.id].surface);
      if (face.complete && (fitted == nullptr || !(fitted->bound > kFitWorthNaming))) continue;
      Finding finding;
      finding.solid = scene->solids[solid.id].info.path;
      finding.entity = "#" + std::to_string(scene->faces[face.id].step_entity);
      if (!face.complete) {
        finding.what = "not all heights are known at which the section of this face changes its shape";
        finding.hint = "compare its layers with --engine reference";
      } else {
        finding.what = "the " + fitted->origin + " is sliced as a spline that lies within " +
                       std::to_string(fitted->bound) + " mm of it";
        finding.hint = "export it as a B-spline surface for more";
      }
      findings.push_back(std::move(finding));
    }
  }

  /// Calls visit(z, section) for each of the ascending heights, slab by slab; the section of a solid that isn't ours is
  /// empty.
  template <class Visit>
  void for_each_section(SolidId id, std::span<const double> heights, const Visit& visit) const {
    const auto solid = std::find_if(solids.begin(), solids.end(), [&](const auto& s) { return s->id == id; });
    TraceLimits as_pieces = limits();
    as_pieces.ellipses = false;
    Section section;
    for (std::size_t first = 0; first < heights.size(); first += kSlabLayers) {
      const auto layers = heights.subspan(first, std::min(kSlabLayers, heights.size() - first));
      std::optional<SolidSlab> slab;
      if (solid != solids.end()) slab.emplace(*scene, **solid, layers, as_pieces);
      for (std::size_t i = 0; i < layers.size(); ++i) {
        section.clear();
        if (slab) slab->cut(i, section);
        visit(layers[i], section);
      }
    }
  }
};

SpanEngine::SpanEngine(const Scene& scene, std::span<const SolidId> solids, const SpanOptions& options,
                       const Progress& progress)
    : data_(std::make_unique<Data>()) {
  data_->scene = &scene;
  data_->options = options;
  data_->solids.resize(solids.size());
  parallel_for(
      solids.size(),
      [&](std::size_t i) {
        progress.throw_if_cancelled();
        data_->solids[i] = std::make_unique<const SolidSpans>(scene, solids[i]);
      },
      options.threads);
  for (const auto& solid : data_->solids) data_->add_findings(*solid);
}

SpanEngine::~SpanEngine() = default;
SpanEngine::SpanEngine(SpanEngine&&) noexcept = default;

void SpanEngine::cut(std::span<const LayerRequest> slab, std::span<LayerSpans> out) const {
  if (slab.empty()) return;
  std::vector<SolidSlab> solids;
  std::vector<double> heights;
  for (const LayerRequest& request : slab) heights.push_back(request.z);
  for (const auto& solid : data_->solids) {
    if (solid->meets(heights.front(), heights.back())) {
      solids.emplace_back(*data_->scene, *solid, heights, data_->limits());
    }
  }
  RowCast rows(*data_->scene);
  Section section;
  for (std::size_t i = 0; i < slab.size(); ++i) {
    section.clear();
    for (SolidSlab& solid : solids) solid.cut(i, section);
    // A loop that could not be traced is missing on every row that it crosses: a doubt like that of a hit.
    out[i].cast.uncertain_hits += section.lost_loops.size();
    for (const FaceId face : section.lost_loops) {
      note_failed(out[i].failed, {Check::loops, data_->scene->solid_of(face), face, 1});
    }
    out[i].lattices.resize(slab[i].lattices.size());
    for (std::size_t k = 0; k < slab[i].lattices.size(); ++k) {
      rows.cast(section, slab[i].lattices[k], k, out[i]);
    }
  }
}

void SpanEngine::add_contours(std::span<const LayerRequest> slab, double chord_error,
                              std::span<CutContours> out) const {
  std::vector<double> heights;
  for (const LayerRequest& request : slab) heights.push_back(request.z);
  for (const auto& solid : data_->solids) {
    if (heights.empty() || !solid->meets(heights.front(), heights.back())) continue;
    std::size_t i = 0;
    data_->for_each_section(solid->id, heights, [&](double z, const Section& section) {
      const SectionContours contours = assemble_contours(*data_->scene, section, {solid->id, z, chord_error});
      append_loops(contours, out[i].contours);
      out[i].findings.insert(out[i].findings.end(), contours.findings.begin(), contours.findings.end());
      ++i;
    });
  }
}

SectionContours SpanEngine::contours(SolidId solid, double z, double chord_error) const {
  return contours(solid, std::span(&z, 1), chord_error).front();
}

std::vector<SectionContours> SpanEngine::contours(SolidId solid, std::span<const double> heights,
                                                  double chord_error) const {
  std::vector<SectionContours> result;
  data_->for_each_section(solid, heights, [&](double z, const Section& section) {
    result.push_back(assemble_contours(*data_->scene, section, {solid, z, chord_error}));
  });
  return result;
}

std::vector<double> SpanEngine::section_areas(SolidId solid, std::span<const double> heights) const {
  std::vector<double> areas;
  data_->for_each_section(solid, heights,
                          [&](double, const Section& section) { areas.push_back(section_area(section)); });
  return areas;
}

const std::vector<Finding>& SpanEngine::findings() const { return data_->findings; }

}  // namespace lamella
