#include "model/step/loop_order.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

#include "model/evaluate.h"

namespace lamella::step {
namespace {

/// A polygon in (u, v) as half-edges over vertices of their own; `vertex_of[i]` names the vertex of corner i.
struct Polygon {
  Scene scene;
  std::vector<HalfEdge> wire;

  Polygon(const std::vector<Vec2>& corners, const std::vector<int>& vertex_of) {
    for (int i = 0; i <= *std::max_element(vertex_of.begin(), vertex_of.end()); ++i) scene.vertices.push_back({});
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const std::size_t next = (i + 1) % corners.size();
      Edge edge;
      edge.start = VertexId(static_cast<std::size_t>(vertex_of[i]));
      edge.end = VertexId(static_cast<std::size_t>(vertex_of[next]));
      HalfEdge half_edge;
      half_edge.prange = {0, 1};
      half_edge.pcurve = Line<2>{corners[i], corners[next] - corners[i]};
      half_edge.forward = i % 2 == 0;
      if (!half_edge.forward) {
        std::swap(edge.start, edge.end);
        half_edge.pcurve = Line<2>{corners[next], corners[i] - corners[next]};
      }
      half_edge.edge = scene.edges.push_back(edge);
      wire.push_back(half_edge);
    }
  }

  [[nodiscard]] bool is_chain(const std::vector<HalfEdge>& loop) const {
    const auto end = [](const HalfEdge& h, bool head) {
      return evaluate<2>(h.pcurve, (h.forward == head) ? h.prange.hi : h.prange.lo).point;
    };
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if ((end(loop[i], true) - end(loop[(i + 1) % loop.size()], false)).norm() > 1e-12) return false;
    }
    return true;
  }
};

TEST(LoopOrder, PutsAShuffledWireHeadToTail) {
  std::mt19937 random(5);
  for (int i = 0; i < 50; ++i) {
    Polygon polygon({{0, 0}, {2, 0}, {2, 1}, {1, 2}, {0, 1}}, {0, 1, 2, 3, 4});
    std::shuffle(polygon.wire.begin(), polygon.wire.end(), random);
    const auto loops = order_loops(polygon.wire, polygon.scene);
    ASSERT_EQ(loops.size(), 1U);
    EXPECT_EQ(loops[0].size(), 5U);
    EXPECT_TRUE(polygon.is_chain(loops[0]));
  }
}

TEST(LoopOrder, TellsASeamsTwoSidesApartByTheirParameters) {
  std::mt19937 random(6);
  // A full cylinder: both rims are closed edges, the seam is used at u = 0 and at u = 2 pi; two vertices only.
  for (int i = 0; i < 50; ++i) {
    Polygon cylinder({{0, 0}, {kTwoPi, 0}, {kTwoPi, 5}, {0, 5}}, {0, 0, 1, 1});
    std::shuffle(cylinder.wire.begin(), cylinder.wire.end(), random);
    const auto loops = order_loops(cylinder.wire, cylinder.scene);
    ASSERT_EQ(loops.size(), 1U);
    EXPECT_TRUE(cylinder.is_chain(loops[0]));
  }
}

TEST(LoopOrder, KeepsEveryHalfEdgeOfABrokenWire) {
  Polygon polygon({{0, 0}, {2, 0}, {2, 1}, {0, 1}}, {0, 1, 2, 3});
  polygon.wire.erase(polygon.wire.begin() + 1);
  std::size_t count = 0;
  for (const auto& loop : order_loops(polygon.wire, polygon.scene)) count += loop.size();
  EXPECT_EQ(count, 3U);
}

TEST(LoopOrder, PartsTwoLoopsThatTouchNowhere) {
  Polygon polygon({{0, 0}, {1, 0}, {1, 1}, {5, 5}, {6, 5}, {6, 6}}, {0, 1, 2, 3, 4, 5});
  const auto close = [&polygon](std::size_t edge, std::size_t corner, const Vec2& from, const Vec2& to) {
    HalfEdge& half_edge = polygon.wire[edge];
    Edge& stored = polygon.scene.edges[half_edge.edge];
    (half_edge.forward ? stored.end : stored.start) = VertexId{corner};
    half_edge.pcurve = half_edge.forward ? Line<2>{from, to - from} : Line<2>{to, from - to};
  };
  close(2, 0, {1, 1}, {0, 0});
  close(5, 3, {6, 6}, {5, 5});
  const auto loops = order_loops(polygon.wire, polygon.scene);
  ASSERT_EQ(loops.size(), 2U);
  EXPECT_TRUE(polygon.is_chain(loops[0]));
  EXPECT_TRUE(polygon.is_chain(loops[1]));
}

}  // namespace
}  // namespace lamella::step
