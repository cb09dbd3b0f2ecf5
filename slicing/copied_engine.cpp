#include "slicing/copied_engine.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

namespace lamella {

namespace {

/// A cluster is looked for a little beyond its bounds, which are exact to less.
constexpr double kMargin = 1e-3;  // mm

/// From the ids of the first copy to those of another.
struct Renaming {
  struct Solid {
    SolidId id;
    std::uint32_t face_shift = 0;  ///< to be added, in arithmetic modulo 2^32
  };
  SolidId first;              ///< the lowest id of the first copy's solids
  std::vector<Solid> solids;  ///< by id of the first copy's less `first`

  [[nodiscard]] SolidId renamed(SolidId id) const { return solids[id.value() - first.value()].id; }

  void rename(Span& span) const {
    const Solid& solid = solids[span.solid.value() - first.value()];
    span.solid = solid.id;
    span.face_in = FaceId{span.face_in.value() + solid.face_shift};
    span.face_out = FaceId{span.face_out.value() + solid.face_shift};
  }
};

FaceId first_face(const Scene& scene, SolidId solid) {
  return scene.shells[scene.solids[solid].shells.first].faces.first;
}

Renaming renaming_of(const Scene& scene, const Cluster& from, const Cluster& to) {
  const auto [lowest, highest] = std::minmax_element(from.solids.begin(), from.solids.end());
  Renaming renaming;
  renaming.first = *lowest;
  renaming.solids.resize(highest->value() - lowest->value() + 1);
  for (std::size_t i = 0; i < from.solids.size(); ++i) {
    renaming.solids[from.solids[i].value() - lowest->value()] = {
        to.solids[i], first_face(scene, to.solids[i]).value() - first_face(scene, from.solids[i]).value()};
  }
  return renaming;
}

/// Rows of one copy on one lattice.
struct Source {
  const SpanRows* rows = nullptr;
  std::size_t first_row = 0;           ///< of the lattice
  double shift = 0.0;                  ///< mm along the rows
  const Renaming* renaming = nullptr;  ///< nothing: ids are right as they are
};

/// Puts the rows of all sources into one, each row sorted as SpanRows are.
void merge_sources(std::span<const Source> sources, std::size_t row_count, SpanRows& out) {
  std::vector<std::uint64_t> cursor(row_count + 1, 0);
  for (const Source& source : sources) {
    for (std::size_t r = 0; r < source.rows->rows(); ++r)
      cursor[source.first_row + r + 1] += source.rows->row(r).size();
  }
  for (std::size_t r = 0; r < row_count; ++r) cursor[r + 1] += cursor[r];
  out.row_start.assign(cursor.begin(), cursor.end());
  out.spans.resize(cursor.back());
  for (const Source& source : sources) {
    for (std::size_t r = 0; r < source.rows->rows(); ++r) {
      for (Span span : source.rows->row(r)) {
        span.begin += source.shift;
        span.end += source.shift;
        if (source.renaming != nullptr) source.renaming->rename(span);
        out.spans[cursor[source.first_row + r]++] = span;
      }
    }
  }
  for (std::size_t r = 0; r < row_count; ++r) {
    sort_spans(std::span(out.spans).subspan(out.row_start[r], out.row_start[r + 1] - out.row_start[r]));
  }
}

/// One cluster, its copies and the engine for the first of them.
class CopiedPart {
 public:
  CopiedPart(const Scene& scene, CopiedCluster copied, const EngineMaker& make)
      : copied_(std::move(copied)), engine_(make(copied_.copies.front().solids)) {
    for (const Cluster& copy : copied_.copies) renamings_.push_back(renaming_of(scene, copied_.copies.front(), copy));
  }

  /// What was asked of the engine for a slab, and the answer.
  struct Cut {
    struct Place {
      std::size_t lattice = 0;  ///< of the slicer's request
      std::size_t copy = 0;
    };
    std::vector<LayerRequest> requests;
    std::vector<std::vector<Place>> places;  ///< per request, of each of its lattices
    std::vector<LayerSpans> spans;
  };

  [[nodiscard]] Cut cut(std::span<const LayerRequest> slab) const {
    Cut cut;
    bool is_met = false;
    for (const LayerRequest& layer : slab) {
      LayerRequest& request = cut.requests.emplace_back(LayerRequest{layer.layer, layer.z, {}});
      auto& places = cut.places.emplace_back();
      const Box3& bounds = copied_.copies.front().bounds;
      if (layer.z < bounds.min().z() - kMargin || layer.z > bounds.max().z() + kMargin) continue;
      is_met = true;
      for (std::size_t k = 0; k < layer.lattices.size(); ++k) {
        for (std::size_t copy = 0; copy < copied_.copies.size(); ++copy) {
          const RowLattice lattice = lattice_of(layer.lattices[k], copy);
          if (lattice.first_row >= lattice.last_row) continue;
          request.lattices.push_back(lattice);
          places.push_back({k, copy});
        }
      }
    }
    make_layer_spans(cut.requests, cut.spans);
    if (!is_met) return cut;
    engine_.cut(cut.requests, cut.spans);
    for (std::size_t i = 0; i < cut.requests.size(); ++i) check_layer_spans(cut.requests[i], cut.spans[i]);
    count_lost_loops(cut);
    return cut;
  }

  /// Adds what belongs to one lattice of the slab's layer `i`.
  void add_sources(const Cut& cut, std::size_t i, std::size_t k, const RowLattice& lattice,
                   std::vector<Source>& sources) const {
    for (std::size_t n = 0; n < cut.places[i].size(); ++n) {
      const auto [of_lattice, copy] = cut.places[i][n];
      if (of_lattice != k) continue;
      sources.push_back({&cut.spans[i].lattices[n],
                         static_cast<std::size_t>(cut.requests[i].lattices[n].first_row - lattice.first_row),
                         lattice.along.dot(copied_.offsets[copy]), &renamings_[copy]});
    }
  }

  [[nodiscard]] bool has_contours() const { return engine_.contours != nullptr; }

  /// The first copy's loops, shifted to every copy.
  void add_contours(const Scene& scene, std::span<const LayerRequest> slab, double chord_error,
                    std::span<CutContours> out) const {
    std::vector<CutContours> first(slab.size());
    engine_.contours(slab, chord_error, first);
    for (std::size_t i = 0; i < slab.size(); ++i) {
      for (std::size_t copy = 0; copy < copied_.copies.size(); ++copy) {
        append_shifted(first[i].contours, copy, out[i].contours);
      }
      add_to_copies(scene, first[i].findings, out[i].findings);
    }
  }

  /// What the engine found, said of every copy.
  void add_findings(const Scene& scene, std::vector<Finding>& out) const {
    if (engine_.findings) add_to_copies(scene, engine_.findings(), out);
  }

 private:
  void append_shifted(const LayerContours& first, std::size_t copy, LayerContours& out) const {
    const auto base = static_cast<std::int32_t>(out.loops.size());
    std::vector<Vec2> polygon;
    for (std::size_t i = 0; i < first.loops.size(); ++i) {
      ContourLoop loop = first.loops[i];
      loop.solid = renamings_[copy].renamed(loop.solid);
      if (loop.parent >= 0) loop.parent += base;
      polygon.assign(first.polygon(i).begin(), first.polygon(i).end());
      for (Vec2& point : polygon) point += copied_.offsets[copy];
      std::vector<ContourCurve> curves = first.curves_of(i);
      for (ContourCurve& curve : curves) curve.shift(copied_.offsets[copy]);
      out.add(loop, polygon, curves);
    }
  }

  void add_to_copies(const Scene& scene, const std::vector<Finding>& found, std::vector<Finding>& out) const {
    for (const Cluster& copy : copied_.copies) {
      for (Finding finding : found) {
        for (std::size_t i = 0; i < copy.solids.size(); ++i) {
          if (finding.solid != scene.solids[copied_.copies.front().solids[i]].info.path) continue;
          finding.solid = scene.solids[copy.solids[i]].info.path;
          break;
        }
        out.push_back(std::move(finding));
      }
    }
  }

  /// The rows of `lattice` that may meet a copy, as the first copy sees them.
  [[nodiscard]] RowLattice lattice_of(const RowLattice& lattice, std::size_t copy) const {
    const Interval range = lattice.range_of(copied_.copies[copy].bounds);
    const auto row_at = [&](double across) { return (across - lattice.anchor) / lattice.spacing - 0.5; };
    const auto clamped = [&](double row) {
      return static_cast<std::int64_t>(
          std::clamp(row, static_cast<double>(lattice.first_row), static_cast<double>(lattice.last_row)));
    };
    RowLattice shifted = lattice;
    shifted.anchor -= lattice.across.dot(copied_.offsets[copy]);
    shifted.first_row = clamped(std::floor(row_at(range.lo - kMargin)));
    shifted.last_row = clamped(std::ceil(row_at(range.hi + kMargin)) + 1.0);
    return shifted;
  }

  /// An engine counts rows and hits for every lattice that it is given, but a loop that its section lacks only once.
  /// What failed keeps the name of the first copy, with the count of all.
  void count_lost_loops(Cut& cut) const {
    for (LayerSpans& spans : cut.spans) {
      for (FailedCheck& failed : spans.failed) {
        if (failed.check != Check::loops) continue;
        spans.cast.uncertain_hits += (copied_.copies.size() - 1) * failed.count;
        failed.count *= copied_.copies.size();
      }
    }
  }

  CopiedCluster copied_;
  SlabEngine engine_;
  std::vector<Renaming> renamings_;
};

class CopiedEngine {
 public:
  CopiedEngine(const Scene& scene, std::span<const SolidId> solids, std::vector<CopiedCluster> copies,
               const EngineMaker& make) {
    std::vector<bool> is_copied(scene.solids.size(), false);
    for (CopiedCluster& copied : copies) {
      for (const Cluster& cluster : copied.copies) {
        for (const SolidId solid : cluster.solids) is_copied[solid.value()] = true;
      }
      parts_.emplace_back(scene, std::move(copied), make);
    }
    std::vector<SolidId> rest;
    std::copy_if(solids.begin(), solids.end(), std::back_inserter(rest),
                 [&](SolidId solid) { return !is_copied[solid.value()]; });
    if (!rest.empty()) rest_ = make(rest);
  }

  void cut(std::span<const LayerRequest> slab, std::span<LayerSpans> out) const {
    std::vector<LayerSpans> rest;
    make_layer_spans(slab, rest);
    if (rest_.cut) rest_.cut(slab, rest);
    std::vector<CopiedPart::Cut> cuts;
    for (const CopiedPart& part : parts_) cuts.push_back(part.cut(slab));
    std::vector<Source> sources;
    for (std::size_t i = 0; i < slab.size(); ++i) {
      if (rest_.cut) check_layer_spans(slab[i], rest[i]);
      out[i].cast = rest[i].cast;
      out[i].failed = std::move(rest[i].failed);
      for (const CopiedPart::Cut& cut : cuts) {
        const LayerSpans& spans = cut.spans[i];
        out[i].cast += spans.cast;
        out[i].failed.insert(out[i].failed.end(), spans.failed.begin(), spans.failed.end());
      }
      for (std::size_t k = 0; k < slab[i].lattices.size(); ++k) {
        const RowLattice& lattice = slab[i].lattices[k];
        sources.clear();
        if (rest_.cut) sources.push_back({&rest[i].lattices[k], 0, 0.0, nullptr});
        for (std::size_t p = 0; p < parts_.size(); ++p) parts_[p].add_sources(cuts[p], i, k, lattice, sources);
        merge_sources(sources, lattice.rows(), out[i].lattices[k]);
      }
    }
  }

  [[nodiscard]] bool has_contours() const {
    return (!rest_.cut || rest_.contours) &&
           std::all_of(parts_.begin(), parts_.end(), [](const CopiedPart& part) { return part.has_contours(); });
  }

  void add_contours(const Scene& scene, std::span<const LayerRequest> slab, double chord_error,
                    std::span<CutContours> out) const {
    if (rest_.cut) rest_.contours(slab, chord_error, out);
    for (const CopiedPart& part : parts_) part.add_contours(scene, slab, chord_error, out);
    for (CutContours& layer : out) sort_loops(layer.contours);
  }

  [[nodiscard]] std::vector<Finding> findings(const Scene& scene) const {
    std::vector<Finding> all;
    if (rest_.findings) all = rest_.findings();
    for (const CopiedPart& part : parts_) part.add_findings(scene, all);
    return all;
  }

 private:
  std::vector<CopiedPart> parts_;
  SlabEngine rest_;
};

}  // namespace

SlabEngine make_copied_engine(const Scene& scene, std::span<const SolidId> solids, std::vector<CopiedCluster> copies,
                              const EngineMaker& make) {
  if (copies.empty()) return make(solids);
  const auto engine = std::make_shared<const CopiedEngine>(scene, solids, std::move(copies), make);
  SlabEngine result;
  result.cut = [engine](std::span<const LayerRequest> slab, std::span<LayerSpans> out) { engine->cut(slab, out); };
  if (engine->has_contours()) {
    result.contours = [engine, &scene](std::span<const LayerRequest> slab, double chord_error,
                                       std::span<CutContours> out) {
      engine->add_contours(scene, slab, chord_error, out);
    };
  }
  result.findings = [engine, &scene] { return engine->findings(scene); };
  return result;
}

}  // namespace lamella
