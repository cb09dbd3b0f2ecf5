#include "tests/support/occt_solids.h"

#include <BRepBndLib.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cmath>

namespace lamella::test {

namespace {

Box3 occt_box(const TopoDS_Solid& solid) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(solid, box, Standard_False, Standard_False);
  Vec3 lo;
  Vec3 hi;
  box.Get(lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z());
  return {lo, hi};
}

double corner_distance(const Box3& a, const Box3& b) {
  return std::max((a.min() - b.min()).norm(), (a.max() - b.max()).norm());
}

double occt_volume(const TopoDS_Solid& solid) {
  GProp_GProps properties;
  BRepGProp::VolumeProperties(solid, properties, 1e-4);
  return properties.Mass();
}

}  // namespace

std::vector<TopoDS_Solid> occt_solids(const std::filesystem::path& file) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader reader;
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) return {};
  reader.TransferRoots();
  std::vector<TopoDS_Solid> solids;
  for (TopExp_Explorer it(reader.OneShape(), TopAbs_SOLID); it.More(); it.Next()) {
    solids.push_back(TopoDS::Solid(it.Current()));
  }
  return solids;
}

std::vector<int> match_solids(const std::vector<SolidMeasure>& measures, const std::vector<TopoDS_Solid>& solids) {
  std::vector<Box3> boxes;
  std::vector<double> volumes;
  for (const TopoDS_Solid& solid : solids) {
    boxes.push_back(occt_box(solid));
    volumes.push_back(occt_volume(solid));
  }
  std::vector<bool> taken(solids.size(), false);
  std::vector<int> result;
  for (const SolidMeasure& measure : measures) {
    int best = -1;
    double least = 1e-2;
    for (std::size_t k = 0; k < solids.size(); ++k) {
      const double distance = corner_distance(measure.bounds, boxes[k]) / measure.bounds.diagonal().norm() +
                              std::abs(measure.volume - volumes[k]) / measure.volume;
      if (taken[k] || !(distance < least)) continue;
      least = distance;
      best = static_cast<int>(k);
    }
    if (best >= 0) taken[best] = true;
    result.push_back(best);
  }
  return result;
}

}  // namespace lamella::test
