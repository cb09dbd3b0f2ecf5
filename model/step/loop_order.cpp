#include "model/step/loop_order.h"

#include <limits>
#include <unordered_map>
#include <utility>

#include "model/evaluate.h"

namespace lamella::step {
namespace {

/// A half-edge's ends in space and in the face's parameters.
struct Ends {
  VertexId tail;
  VertexId head;
  Vec2 tail_uv;
  Vec2 head_uv;
};

Ends ends_of(const HalfEdge& half_edge, const Scene& scene) {
  const Edge& edge = scene.edges[half_edge.edge];
  Ends ends{edge.start, edge.end, evaluate<2>(half_edge.pcurve, half_edge.prange.lo).point,
            evaluate<2>(half_edge.pcurve, half_edge.prange.hi).point};
  if (!half_edge.forward) {
    std::swap(ends.tail, ends.head);
    std::swap(ends.tail_uv, ends.head_uv);
  }
  return ends;
}

/// Walks from head to tail through a wire's half-edges.
class LoopWalk {
 public:
  LoopWalk(const std::vector<HalfEdge>& wire, const Scene& scene) : used_(wire.size(), false) {
    for (const HalfEdge& half_edge : wire) {
      ends_.push_back(ends_of(half_edge, scene));
      leaving_[ends_.back().tail].push_back(ends_.size() - 1);
    }
  }

  [[nodiscard]] std::size_t count() const { return ends_.size(); }
  [[nodiscard]] bool used(std::size_t i) const { return used_[i]; }

  /// One chain from half-edge `first` until nothing follows or it is back at its beginning.
  [[nodiscard]] std::vector<std::size_t> chain_from(std::size_t first) {
    std::vector<std::size_t> chain;
    for (std::size_t i = first; i < count(); i = next_after(first, i)) {
      used_[i] = true;
      chain.push_back(i);
    }
    return chain;
  }

 private:
  /// The unused half-edge that leaves where `i` arrives, nearest in (u, v), the file's order deciding ties;
  /// count() when there is none or the way back to the beginning is nearer.
  [[nodiscard]] std::size_t next_after(std::size_t first, std::size_t i) const {
    const auto found = leaving_.find(ends_[i].head);
    if (found == leaving_.end()) return count();
    std::size_t best = count();
    double least = std::numeric_limits<double>::infinity();
    const auto offer = [&](std::size_t k) {
      const double distance = (ends_[k].tail_uv - ends_[i].head_uv).squaredNorm();
      if (distance < least) {
        least = distance;
        best = k;
      }
    };
    if (i + 1 < count() && !used_[i + 1] && ends_[i + 1].tail == ends_[i].head) offer(i + 1);
    for (const std::size_t k : found->second) {
      if (!used_[k]) offer(k);
    }
    const bool closes = ends_[first].tail == ends_[i].head;
    if (closes && (ends_[first].tail_uv - ends_[i].head_uv).squaredNorm() < least) return count();
    return best;
  }

  std::vector<Ends> ends_;
  std::vector<bool> used_;
  std::unordered_map<VertexId, std::vector<std::size_t>> leaving_;
};

}  // namespace

std::vector<std::vector<HalfEdge>> order_loops(std::vector<HalfEdge> wire, const Scene& scene) {
  LoopWalk walk(wire, scene);
  std::vector<std::vector<HalfEdge>> loops;
  for (std::size_t i = 0; i < walk.count(); ++i) {
    if (walk.used(i)) continue;
    std::vector<HalfEdge> loop;
    for (const std::size_t k : walk.chain_from(i)) loop.push_back(std::move(wire[k]));
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace lamella::step
