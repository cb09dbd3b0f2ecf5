// Writes the volumes OpenCASCADE gives for the solids of STEP files, one line each: file, volume, its error estimate.
//   occt_volumes FILE... > occt_volumes.tsv
// BRepGProp with an explicit Eps: its default accuracy is off by up to 3.6 % on free-form faces.
#include <BRepGProp.hxx>
#include <GProp_GProps.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <cstdio>
#include <filesystem>

namespace {

constexpr double kEps = 1e-6;

bool write_volumes(const std::filesystem::path& path) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return false;
  reader.TransferRoots();
  for (TopExp_Explorer solid(reader.OneShape(), TopAbs_SOLID); solid.More(); solid.Next()) {
    GProp_GProps properties;
    const double error = BRepGProp::VolumeProperties(solid.Current(), properties, kEps, Standard_False, Standard_False);
    std::printf("%s\t%.17g\t%.2g\n", path.filename().c_str(), properties.Mass(), error);
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  for (int i = 1; i < argc; ++i) {
    if (!write_volumes(argv[i])) std::fprintf(stderr, "can't read %s\n", argv[i]);
  }
  return 0;
}
