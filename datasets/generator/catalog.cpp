#include "datasets/generator/catalog.h"

#include <array>

namespace lamella::datasets {
namespace {

struct Entry {
  const char* name;  ///< that of the data set
  DataSet (*make)();
};

constexpr std::array<Entry, 14> kEntries{{{"overmoulded_grip", overmoulded_grip},
                                          {"nested_spheres", nested_spheres},
                                          {"touching_boxes", touching_boxes},
                                          {"interpenetrating_bodies", interpenetrating_bodies},
                                          {"gradient_lens", gradient_lens},
                                          {"connector", connector},
                                          {"pcb_stack", pcb_stack},
                                          {"bone_screw", bone_screw},
                                          {"mould_insert", mould_insert},
                                          {"lattice_in_shell", lattice_in_shell},
                                          {"mirrored_brackets", mirrored_brackets},
                                          {"turbine_blade_16", turbine_blade_16},
                                          {"housing_102", housing_102},
                                          {"impeller_135", impeller_135}}};

}  // namespace

std::vector<std::string> catalog_names() {
  std::vector<std::string> names;
  for (const Entry& entry : kEntries) names.emplace_back(entry.name);
  return names;
}

std::optional<DataSet> make_data_set(const std::string& name) {
  for (const Entry& entry : kEntries) {
    if (name == entry.name) return entry.make();
  }
  return std::nullopt;
}

std::vector<DataSet> catalog() {
  std::vector<DataSet> sets;
  for (const Entry& entry : kEntries) sets.push_back(entry.make());
  return sets;
}

}  // namespace lamella::datasets
