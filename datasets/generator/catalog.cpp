#include "datasets/generator/catalog.h"

namespace lamella::datasets {

std::vector<DataSet> catalog() {
  return {overmoulded_grip(), nested_spheres(),   touching_boxes(),    interpenetrating_bodies(),
          gradient_lens(),    connector(),        pcb_stack(),         bone_screw(),
          mould_insert(),     lattice_in_shell(), mirrored_brackets(), turbine_blade_16(),
          housing_102(),      impeller_135()};
}

}  // namespace lamella::datasets
