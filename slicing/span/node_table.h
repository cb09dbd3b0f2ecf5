#pragma once

#include <cstdint>
#include <vector>

#include "slicing/span/face_model.h"

namespace lamella::span {

/// Where an edge piece crosses a layer.
struct Node {
  double t = 0.0;  ///< parameter of the edge's curve
  Vec2 xy = Vec2::Zero();
  double z = 0.0;
  double rate = 0.0;  ///< dt / dz
};

/// The nodes of one layer, each computed once and read by both faces of its edge.
class NodeTable {
 public:
  explicit NodeTable(const EdgePieces& edges);

  /// Forgets the nodes of the last layer; their parameters stay as first guesses.
  void start_layer(double z);
  [[nodiscard]] const Node& node(std::uint32_t piece);
  /// A node at another height, not kept.
  [[nodiscard]] Node node_at(std::uint32_t piece, double z) const;

 private:
  [[nodiscard]] Node cross(std::uint32_t piece, double z) const;

  const EdgePieces* edges_;
  double z_ = 0.0;
  std::uint32_t layer_ = 0;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> stamp_;
};

}  // namespace lamella::span
