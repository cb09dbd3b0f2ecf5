#include "datasets/generator/assembly.h"

namespace lamella::datasets {
namespace {

void collect(const Node& node, std::vector<int>& parts) {
  if (node.part >= 0) parts.push_back(node.part);
  for (const Node& child : node.children) collect(child, parts);
}

}  // namespace

int DataSet::define(Part part) {
  parts.push_back(std::move(part));
  return static_cast<int>(parts.size()) - 1;
}

int DataSet::add(Part part) {
  Node node{part.name, 0, gp_Trsf(), {}};
  node.part = define(std::move(part));
  root.children.push_back(std::move(node));
  return root.children.back().part;
}

std::vector<int> walk(const DataSet& set) {
  std::vector<int> parts;
  collect(set.root, parts);
  return parts;
}

}  // namespace lamella::datasets
