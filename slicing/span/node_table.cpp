#include "slicing/span/node_table.h"

#include <cmath>

namespace lamella::span {

NodeTable::NodeTable(const EdgePieces& edges)
    : edges_(&edges), nodes_(edges.all().size()), stamp_(edges.all().size(), 0) {
  for (Node& node : nodes_) node.t = std::nan("");
}

void NodeTable::start_layer(double z) {
  z_ = z;
  ++layer_;
}

const Node& NodeTable::node(std::uint32_t piece) {
  if (stamp_[piece] != layer_) {
    nodes_[piece] = cross(piece, z_);
    stamp_[piece] = layer_;
  }
  return nodes_[piece];
}

Node NodeTable::node_at(std::uint32_t piece, double z) const { return cross(piece, z); }

Node NodeTable::cross(std::uint32_t piece, double z) const {
  const EdgePiece& edge_piece = edges_->all()[piece];
  const Node& known = nodes_[piece];
  const Crossing crossing =
      find_crossing(edges_->curve_of(edge_piece), edge_piece.range, z, known.t + (z - known.z) * known.rate);
  return {crossing.t, crossing.at.point.head<2>(), z, 1.0 / crossing.at.dt.z()};
}

}  // namespace lamella::span
