#include "export/contour_interfaces.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "slicing/interface_policy.h"

namespace lamella {

namespace {

/// Heights nearer than this are one; corners lie on a grid a hundred times coarser.
constexpr double kSameHeight = 1e-8;  // mm

/// A side of a polygon that isn't level, from its lower to its upper end.
struct Edge {
  Vec2 low;
  Vec2 high;
  std::size_t part = 0;

  [[nodiscard]] double at(double y) const {
    const double t = (y - low.y()) / (high.y() - low.y());
    return low.x() + t * (high.x() - low.x());
  }
};

/// One end of a run: an edge, or a line between two.
struct End {
  const Edge* first = nullptr;
  const Edge* second = nullptr;
  double share = 0.0;  ///< of the second

  [[nodiscard]] double at(double y) const {
    if (share == 0.0) return first->at(y);
    if (share == 1.0) return second->at(y);
    return (1.0 - share) * first->at(y) + share * second->at(y);
  }
};

End on_edge(const Edge* edge) { return {edge, edge, 0.0}; }

/// What is covered without a break by parts of one priority and material, on the line in the middle of a band.
struct Run {
  int priority = 0;
  MaterialId material;
  double begin = 0.0;  ///< mm
  double end = 0.0;
  int best_rank = 0;
  End begin_at;
  End end_at;
  End keep_from;  ///< where it stays as it is, its own end
  End keep_to;
};

/// Where policy puts the interface of an overlap that begins with `first` and ends with `last`.
End interface_of(OverlapPolicy policy, const End& first, const End& last) {
  if (policy == OverlapPolicy::entry) return first;
  if (policy == OverlapPolicy::exit) return last;
  return {first.first, last.first, 0.5};
}

class BandSweep {
 public:
  BandSweep(std::span<const InterfacePart> parts, OverlapPolicy policy) : parts_(parts), policy_(policy) {
    for (std::size_t part = 0; part < parts.size(); ++part) {
      for (const auto& polygon : parts[part].polygons) add_edges(polygon, part);
    }
    std::sort(edges_.begin(), edges_.end(), [](const Edge& a, const Edge& b) { return a.low.y() < b.low.y(); });
    std::sort(heights_.begin(), heights_.end());
    heights_.erase(std::unique(heights_.begin(), heights_.end()), heights_.end());
  }

  std::vector<KeptArea> run() {
    std::size_t next = 0;
    for (std::size_t i = 0; i + 1 < heights_.size(); ++i) {
      const double low = heights_[i];
      std::erase_if(active_, [&](const Edge* edge) { return edge->high.y() <= low; });
      for (; next < edges_.size() && edges_[next].low.y() <= low; ++next) active_.push_back(&edges_[next]);
      double from = low;
      for (const double to : heights_within(low, heights_[i + 1])) {
        add_band(from, to);
        from = to;
      }
    }
    std::vector<KeptArea> kept;
    for (auto& [key, area] : kept_) kept.push_back({key.first, key.second, std::move(area)});
    return kept;
  }

 private:
  void add_edges(const std::vector<Vec2>& polygon, std::size_t part) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Vec2& a = polygon[i];
      const Vec2& b = polygon[(i + 1) % polygon.size()];
      heights_.push_back(a.y());
      if (a.y() < b.y()) edges_.push_back({a, b, part});
      if (b.y() < a.y()) edges_.push_back({b, a, part});
    }
  }

  /// Ends of the bands between two heights of corners: where edges cross, then the upper height.
  [[nodiscard]] std::vector<double> heights_within(double low, double high) const {
    std::vector<double> crossings;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      for (std::size_t j = i + 1; j < active_.size(); ++j) {
        const double below = active_[i]->at(low) - active_[j]->at(low);
        const double above = active_[i]->at(high) - active_[j]->at(high);
        if (!(below * above < 0.0)) continue;
        crossings.push_back(low + below / (below - above) * (high - low));
      }
    }
    crossings.push_back(high);
    std::sort(crossings.begin(), crossings.end());
    std::vector<double> heights;
    double last = low;
    for (const double y : crossings) {
      if (y - last < kSameHeight && y != high) continue;
      if (y == high && !heights.empty() && y - heights.back() < kSameHeight) heights.pop_back();
      heights.push_back(y);
      last = y;
    }
    return heights;
  }

  void add_band(double low, double high) {
    std::vector<Run> runs = runs_at(0.5 * (low + high));
    place_interfaces(runs);
    for (const Run& run : runs) {
      const double x0 = run.keep_from.at(low);
      const double x1 = run.keep_to.at(low);
      const double x2 = run.keep_to.at(high);
      const double x3 = run.keep_from.at(high);
      if (!(x0 <= x1 && x3 <= x2)) continue;
      kept_[{run.priority, run.material}].push_back({Vec2(x0, low), Vec2(x1, low), Vec2(x2, high), Vec2(x3, high)});
    }
  }

  /// Ascending by priority, material and begin.
  [[nodiscard]] std::vector<Run> runs_at(double y) const {
    std::vector<std::tuple<std::size_t, double, const Edge*>> crossed;
    for (const Edge* edge : active_) crossed.emplace_back(edge->part, edge->at(y), edge);
    std::sort(crossed.begin(), crossed.end(), [](const auto& a, const auto& b) {
      return std::pair(std::get<0>(a), std::get<1>(a)) < std::pair(std::get<0>(b), std::get<1>(b));
    });
    std::vector<Run> spans;
    for (std::size_t i = 0; i + 1 < crossed.size(); i += 2) {
      const auto& [part, begin, first] = crossed[i];
      const auto& [same, end, last] = crossed[i + 1];
      const InterfacePart& of = parts_[part];
      spans.push_back({of.priority, of.material, begin, end, of.rank, on_edge(first), on_edge(last), {}, {}});
    }
    return united(std::move(spans));
  }

  static std::vector<Run> united(std::vector<Run> spans) {
    std::sort(spans.begin(), spans.end(), [](const Run& a, const Run& b) {
      return std::tuple(a.priority, a.material, a.begin, a.end) < std::tuple(b.priority, b.material, b.begin, b.end);
    });
    std::vector<Run> runs;
    for (const Run& span : spans) {
      const bool joins = !runs.empty() && runs.back().priority == span.priority &&
                         runs.back().material == span.material && span.begin <= runs.back().end;
      if (!joins) {
        runs.push_back(span);
        continue;
      }
      Run& run = runs.back();
      run.best_rank = std::max(run.best_rank, span.best_rank);
      if (!(span.end > run.end)) continue;
      run.end = span.end;
      run.end_at = span.end_at;
    }
    return runs;
  }

  void place_interfaces(std::vector<Run>& runs) const {
    for (Run& run : runs) {
      run.keep_from = run.begin_at;
      run.keep_to = run.end_at;
    }
    visit_shared_overlaps(runs, [this](Run& left, Run& right) {
      left.keep_to = right.keep_from = interface_of(policy_, right.begin_at, left.end_at);
    });
  }

  std::span<const InterfacePart> parts_;
  OverlapPolicy policy_;
  std::vector<Edge> edges_;
  std::vector<double> heights_;
  std::vector<const Edge*> active_;
  std::map<std::pair<int, MaterialId>, std::vector<Trapezoid>> kept_;
};

}  // namespace

std::vector<KeptArea> share_overlaps(std::span<const InterfacePart> parts, OverlapPolicy policy) {
  return BandSweep(parts, policy).run();
}

}  // namespace lamella
