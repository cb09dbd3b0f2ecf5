#include "datasets/generator/assembly.h"

#include <cmath>
#include <cstdio>
#include <gp_Ax2.hxx>

namespace lamella::datasets {
namespace {

/// Where an instance is placed in the assembly that holds it.
gp_Trsf placement_of(const DataSet& set, const Node& node) {
  for (const Mirror& mirror : set.mirrored) {
    if (mirror.instance != node.name) continue;
    gp_Trsf image;
    image.SetMirror(gp_Ax2(gp_Pnt(0, 0, 0), gp_Dir(1, 0, 0)));
    gp_Trsf shift;
    shift.SetTranslation(gp_Vec(mirror.shift[0], mirror.shift[1], mirror.shift[2]));
    return shift * image;
  }
  return node.placement;
}

void collect(const DataSet& set, const Node& node, const gp_Trsf& placement, std::vector<PlacedPart>& parts) {
  if (node.part >= 0) parts.push_back({node.part, placement});
  const Node& assembly = node.shared >= 0 ? set.shared[static_cast<std::size_t>(node.shared)] : node;
  for (const Node& child : assembly.children) collect(set, child, placement * placement_of(set, child), parts);
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

std::vector<PlacedPart> placed_parts(const DataSet& set) {
  std::vector<PlacedPart> parts;
  collect(set, set.root, gp_Trsf(), parts);
  return parts;
}

std::vector<int> walk(const DataSet& set) {
  std::vector<int> parts;
  for (const PlacedPart& placed : placed_parts(set)) parts.push_back(placed.part);
  return parts;
}

}  // namespace lamella::datasets
