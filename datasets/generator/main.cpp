#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "datasets/generator/catalog.h"
#include "datasets/generator/manifest.h"
#include "datasets/generator/step_file.h"

/// lamella_datasets FOLDER: writes FOLDER/<name>/<name>.step for every data set, and FOLDER/manifest.json.
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
    }
    std::ofstream manifest(folder / "manifest.json");
    manifest << manifest_json(sets);
    if (!manifest.flush()) throw std::runtime_error("can't write " + (folder / "manifest.json").string());
  } catch (const std::exception& error) {
    std::cerr << "lamella_datasets: error: " << error.what() << '\n';
    return 4;
  }
}
