#include "bench/model_occt.h"

#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <stdexcept>

namespace lamella::bench {

std::vector<TopoDS_Solid> occt_solids(const std::filesystem::path& file) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  STEPControl_Reader reader;
  Interface_Static::SetCVal("xstep.cascade.unit", "MM");
  if (reader.ReadFile(file.c_str()) != IFSelect_RetDone) throw std::runtime_error("OpenCASCADE can't read the file");
  reader.TransferRoots();
  std::vector<TopoDS_Solid> solids;
  for (TopExp_Explorer it(reader.OneShape(), TopAbs_SOLID); it.More(); it.Next()) {
    solids.push_back(TopoDS::Solid(it.Current()));
  }
  return solids;
}

}  // namespace lamella::bench
