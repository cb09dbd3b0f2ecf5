#include "datasets/generator/manifest.h"

#include <BRep_Tool.hxx>
#include <Geom_BSplineSurface.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <nlohmann/json.hpp>

namespace lamella::datasets {
namespace {

using nlohmann::ordered_json;

struct FaceCounts {
  int faces = 0, spline = 0, rational = 0, shells = 0;
};

FaceCounts count_faces(const TopoDS_Shape& shape) {
  FaceCounts counts;
  for (TopExp_Explorer e(shape, TopAbs_SHELL); e.More(); e.Next()) ++counts.shells;
  for (TopExp_Explorer e(shape, TopAbs_FACE); e.More(); e.Next()) {
    ++counts.faces;
    const auto surface = Handle(Geom_BSplineSurface)::DownCast(BRep_Tool::Surface(TopoDS::Face(e.Current())));
    if (surface.IsNull()) continue;
    ++counts.spline;
    if (surface->IsURational() || surface->IsVRational()) ++counts.rational;
  }
  return counts;
}

ordered_json truth_json(const Truth& truth) {
  return {{"volume", truth.value}, {"method", truth.method}, {"relative_bound", truth.bound}};
}

ordered_json solid_json(const Part& part, std::size_t id) {
  const FaceCounts counts = count_faces(part.shape);
  ordered_json solid{{"id", id},
                     {"name", part.name},
                     {"color", hex(part.material.color)},
                     {"step_material", part.material.name},
                     {"density", part.material.density},
                     {"priority", part.material.priority}};
  solid.update(truth_json(part.volume));
  solid.update({{"shells", counts.shells},
                {"faces", counts.faces},
                {"bspline_faces", counts.spline},
                {"rational_faces", counts.rational}});
  return solid;
}

ordered_json set_json(const DataSet& set) {
  ordered_json result{{"name", set.name},
                      {"file", set.name + "/" + set.name + ".step"},
                      {"description", set.description},
                      {"unit", set.unit},
                      {"materials", set.name + "/materials.xml"}};
  ordered_json solids = ordered_json::array(), overlaps = ordered_json::array();
  for (const int part : walk(set)) solids.push_back(solid_json(set.parts[part], solids.size()));
  for (const Overlap& o : set.overlaps) {
    ordered_json entry{{"solids", {o.first, o.second}}};
    entry.update(truth_json(o.volume));
    overlaps.push_back(entry);
  }
  result["solids"] = solids;
  result["overlaps"] = overlaps;
  return result;
}

}  // namespace

std::string manifest_json(const std::vector<DataSet>& sets) {
  ordered_json root{{"version", 1}, {"units", {{"volume", "mm^3"}, {"density", "g/cm^3"}}}};
  root["datasets"] = ordered_json::array();
  for (const DataSet& set : sets) root["datasets"].push_back(set_json(set));
  return root.dump(1) + "\n";
}

}  // namespace lamella::datasets
