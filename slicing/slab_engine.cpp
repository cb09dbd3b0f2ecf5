#include "slicing/slab_engine.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "core/parallel.h"

namespace lamella {

namespace {

/// Rows a task: enough to hide what starting a task costs, few enough that threads end together.
constexpr std::int64_t kRowsPerTask = 32;

bool comes_before(const Span& a, const Span& b) {
  return std::tie(a.begin, a.end, a.solid) < std::tie(b.begin, b.end, b.solid);
}

/// A solid and the range it takes across the rows of a lattice.
struct Candidate {
  SolidId solid;
  Interval across;
};

Ray ray_of(const RowLattice& lattice, std::int64_t row, double z) {
  Ray ray;
  ray.origin << lattice.position(row) * lattice.across, z;
  ray.direction << lattice.along, 0.0;
  return ray;
}

/// Some consecutive rows of a lattice.
struct RowRange {
  std::int64_t first = 0;
  std::int64_t last = 0;  ///< one past
  SpanRows rows;
  CastCounters cast;
};

std::vector<RowRange> share_out(const RowLattice& lattice) {
  std::vector<RowRange> ranges;
  for (std::int64_t row = lattice.first_row; row < lattice.last_row; row += kRowsPerTask) {
    ranges.push_back({row, std::min(row + kRowsPerTask, lattice.last_row), {}, {}});
  }
  return ranges;
}

void append_rows(SpanRows& to, const SpanRows& from) {
  const std::uint64_t offset = to.spans.size();
  for (std::size_t r = 1; r < from.row_start.size(); ++r) to.row_start.push_back(offset + from.row_start[r]);
  to.spans.insert(to.spans.end(), from.spans.begin(), from.spans.end());
}

class RayEngine {
 public:
  RayEngine(CastFunction cast, std::vector<RayTarget> targets, Progress progress)
      : cast_(std::move(cast)), targets_(std::move(targets)), progress_(std::move(progress)) {}

  void operator()(std::span<const LayerRequest> slab, std::span<LayerSpans> out) const {
    for (std::size_t i = 0; i < slab.size(); ++i) {
      for (std::size_t k = 0; k < slab[i].lattices.size(); ++k) {
        out[i].cast += cut_lattice(slab[i].lattices[k], slab[i].z, out[i].lattices[k]);
      }
    }
  }

 private:
  CastCounters cut_lattice(const RowLattice& lattice, double z, SpanRows& out) const {
    const std::vector<Candidate> candidates = find_candidates(lattice, z);
    std::vector<RowRange> ranges = share_out(lattice);
    parallel_for_within(ranges.size(), [&](std::size_t i) { cut_range(lattice, z, candidates, ranges[i]); });
    CastCounters cast;
    for (const RowRange& range : ranges) {
      append_rows(out, range.rows);
      cast += range.cast;
    }
    return cast;
  }

  [[nodiscard]] std::vector<Candidate> find_candidates(const RowLattice& lattice, double z) const {
    std::vector<Candidate> candidates;
    for (const RayTarget& target : targets_) {
      if (!(target.bounds.min().z() <= z && z <= target.bounds.max().z())) continue;
      candidates.push_back({target.solid, lattice.range_of(target.bounds)});
    }
    return candidates;
  }

  void cut_range(const RowLattice& lattice, double z, const std::vector<Candidate>& candidates, RowRange& out) const {
    progress_.throw_if_cancelled();
    SolidCast found;
    for (std::int64_t row = out.first; row < out.last; ++row) {
      const Ray ray = ray_of(lattice, row, z);
      for (const Candidate& candidate : candidates) {
        if (!candidate.across.contains(lattice.position(row))) continue;
        cast_(ray, candidate.solid, found, out.cast);
        out.rows.spans.insert(out.rows.spans.end(), found.spans.begin(), found.spans.end());
      }
      sort_spans(std::span(out.rows.spans).subspan(out.rows.row_start.back()));
      out.rows.row_start.push_back(out.rows.spans.size());
    }
  }

  CastFunction cast_;
  std::vector<RayTarget> targets_;
  Progress progress_;
};

void merge_rows(const SpanRows& first, const SpanRows& second, SpanRows& out) {
  out.spans.reserve(first.spans.size() + second.spans.size());
  for (std::size_t r = 0; r < first.rows(); ++r) {
    const auto a = first.row(r);
    const auto b = second.row(r);
    std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out.spans), comes_before);
    out.row_start.push_back(out.spans.size());
  }
}

}  // namespace

void sort_spans(std::span<Span> row) {
  if (std::is_sorted(row.begin(), row.end(), comes_before)) return;
  // Unlike std::sort it stays within the row even where a NaN makes the order inconsistent.
  std::stable_sort(row.begin(), row.end(), comes_before);
}

SlabEngine make_ray_engine(CastFunction cast, std::vector<RayTarget> targets, const Progress& progress) {
  return {RayEngine(std::move(cast), std::move(targets), progress), {}, 1, {}};
}

SlabEngine join_engines(SlabEngine first, SlabEngine second) {
  SlabEngine joined;
  joined.slab_layers = std::max(first.slab_layers, second.slab_layers);
  joined.findings = [of_first = first.findings, of_second = second.findings] {
    std::vector<Finding> all = of_first ? of_first() : std::vector<Finding>();
    const std::vector<Finding> more = of_second ? of_second() : std::vector<Finding>();
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  joined.cut = [cut_first = std::move(first.cut), cut_second = std::move(second.cut)](
                   std::span<const LayerRequest> slab, std::span<LayerSpans> out) {
    std::vector<LayerSpans> a;
    std::vector<LayerSpans> b;
    make_layer_spans(slab, a);
    make_layer_spans(slab, b);
    cut_first(slab, a);
    cut_second(slab, b);
    for (std::size_t i = 0; i < slab.size(); ++i) {
      check_layer_spans(slab[i], a[i]);
      check_layer_spans(slab[i], b[i]);
      out[i].cast = a[i].cast;
      out[i].cast += b[i].cast;
      out[i].failed = std::move(a[i].failed);
      out[i].failed.insert(out[i].failed.end(), b[i].failed.begin(), b[i].failed.end());
      for (std::size_t k = 0; k < slab[i].lattices.size(); ++k) {
        merge_rows(a[i].lattices[k], b[i].lattices[k], out[i].lattices[k]);
      }
    }
  };
  return joined;
}

}  // namespace lamella
