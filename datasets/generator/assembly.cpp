#include "datasets/generator/assembly.h"

#include <cmath>
#include <cstdio>

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

std::string hex(const Rgb& color) {
  char buffer[8];
  std::snprintf(buffer, sizeof buffer, "#%02x%02x%02x", static_cast<int>(std::lround(color[0] * 255)),
                static_cast<int>(std::lround(color[1] * 255)), static_cast<int>(std::lround(color[2] * 255)));
  return buffer;
}

std::vector<int> walk(const DataSet& set) {
  std::vector<int> parts;
  collect(set.root, parts);
  return parts;
}

}  // namespace lamella::datasets
