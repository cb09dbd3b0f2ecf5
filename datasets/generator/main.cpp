#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "datasets/generator/catalog.h"
#include "datasets/generator/manifest.h"
#include "datasets/generator/materials_file.h"
#include "datasets/generator/step_file.h"

namespace {

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("can't write " + path.string());
}

}  // namespace

/// lamella_datasets FOLDER: writes FOLDER/<name>/<name>.step and materials.xml for every data set, and
/// FOLDER/manifest.json.
int main(int argc, char** argv) {
  using namespace lamella::datasets;
  if (argc != 2) {
    std::cerr << "usage: lamella_datasets FOLDER\n";
    return 1;
  }
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    const std::filesystem::path folder = argv[1];
    const std::vector<DataSet> sets = catalog();
    for (const DataSet& set : sets) {
      std::filesystem::create_directories(folder / set.name);
      write_step(set, folder / set.name / (set.name + ".step"));
      write_text(folder / set.name / "materials.xml", materials_xml(set));
    }
    write_text(folder / "manifest.json", manifest_json(sets));
  } catch (const std::exception& error) {
    std::cerr << "lamella_datasets: error: " << error.what() << '\n';
    return 4;
  }
}
