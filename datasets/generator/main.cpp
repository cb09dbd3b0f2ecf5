#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <span>
#include <string_view>

#include "datasets/generator/catalog.h"
#include "datasets/generator/manifest.h"
#include "datasets/generator/materials_file.h"
#include "datasets/generator/step_file.h"
#include "datasets/generator/tray.h"

namespace lamella::datasets {
namespace {

constexpr const char* kUsage =
    "usage: lamella_datasets FOLDER\n"
    "       lamella_datasets --tray NAME --size X Y Z [--gap G] OUT.step\n";

constexpr const char* kHelp =
    "\n"
    "The first form writes FOLDER/<name>/<name>.step and materials.xml for every data set, and FOLDER/manifest.json.\n"
    "\n"
    "The second fills a build volume with copies of one data set, instances of one assembly, and writes OUT.step and,\n"
    "in the same folder, materials.xml. All copies are turned alike, in the way along the axes of which most fit.\n"
    "  --tray NAME    the data set\n"
    "  --size X Y Z   the build volume, mm\n"
    "  --gap G        the least distance between neighbours, mm (2); room that is left widens it\n"
    "\n"
    "Exit code 0: done, 1: usage, 4: an output could not be written.\n";

class UsageFault : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("can't write " + path.string());
}

void write_all(const std::filesystem::path& folder) {
  const std::vector<DataSet> sets = catalog();
  for (const DataSet& set : sets) {
    std::filesystem::create_directories(folder / set.name);
    write_step(set, folder / set.name / (set.name + ".step"));
    write_text(folder / set.name / "materials.xml", materials_xml(set));
  }
  write_text(folder / "manifest.json", manifest_json(sets));
}

double number(std::string_view option, std::string_view text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size())
    throw UsageFault(std::string(option) + ": '" + std::string(text) + "' is not a number");
  return value;
}

struct TrayRequest {
  std::string name;
  TrayOptions options;
  std::filesystem::path out;
};

TrayRequest read_tray_request(std::span<char* const> arguments) {
  TrayRequest request;
  bool has_size = false;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view option = arguments[i];
    const auto value = [&] {
      if (++i == arguments.size()) throw UsageFault("a value is missing behind " + std::string(option));
      return std::string_view(arguments[i]);
    };
    if (option == "--tray") {
      request.name = value();
    } else if (option == "--size") {
      for (double& size : request.options.size) size = number(option, value());
      has_size = true;
    } else if (option == "--gap") {
      request.options.gap = number(option, value());
    } else if (option.starts_with('-')) {
      throw UsageFault("unknown option " + std::string(option));
    } else if (!request.out.empty()) {
      throw UsageFault("more than one output: " + std::string(option));
    } else {
      request.out = option;
    }
  }
  if (request.name.empty() || !has_size || request.out.empty())
    throw UsageFault("a tray needs --tray NAME, --size X Y Z and OUT.step");
  return request;
}

Tray make_tray(const TrayRequest& request) {
  const std::optional<DataSet> unit = make_data_set(request.name);
  if (!unit) {
    std::string known;
    for (const std::string& name : catalog_names()) known += (known.empty() ? "" : ", ") + name;
    throw UsageFault("there is no data set '" + request.name + "'; there are " + known);
  }
  try {
    return make_tray(*unit, request.options);
  } catch (const std::invalid_argument& fault) {
    throw UsageFault(fault.what());
  }
}

void write_tray(const TrayRequest& request) {
  const Tray tray = make_tray(request);
  const std::filesystem::path folder = request.out.parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  write_step(tray.set, request.out);
  write_text(folder / "materials.xml", materials_xml(tray.set));
  const auto triple = [](const auto& values) -> std::ostream& {
    return std::cout << values[0] << " x " << values[1] << " x " << values[2];
  };
  std::cout << tray.count() << " copies, ";
  triple(tray.copies) << ", of ";
  triple(tray.part_size) << " mm, ";
  triple(tray.distance) << " mm apart; " << placed_parts(tray.set).size() << " solids\n";
}

void run(std::span<char* const> arguments) {
  if (arguments.size() == 1 && !std::string_view(arguments[0]).starts_with('-')) {
    write_all(arguments[0]);
  } else if (arguments.empty()) {
    throw UsageFault("a folder or a tray is needed");
  } else {
    write_tray(read_tray_request(arguments));
  }
}

}  // namespace
}  // namespace lamella::datasets

int main(int argc, char** argv) {
  using namespace lamella::datasets;
  const std::span<char* const> arguments(argv + 1, static_cast<std::size_t>(argc > 0 ? argc - 1 : 0));
  for (const std::string_view argument : arguments) {
    if (argument != "-h" && argument != "--help") continue;
    std::cout << kUsage << kHelp;
    return 0;
  }
  Message::DefaultMessenger()->ChangePrinters().Clear();
  try {
    run(arguments);
  } catch (const UsageFault& fault) {
    std::cerr << "lamella_datasets: error: " << fault.what() << '\n' << kUsage;
    return 1;
  } catch (const std::exception& error) {
    std::cerr << "lamella_datasets: error: " << error.what() << '\n';
    return 4;
  }
}
