#include "datasets/generator/catalog.h"

namespace lamella::datasets {

std::vector<DataSet> catalog() {
  return {overmoulded_grip(), nested_spheres(), touching_boxes(), interpenetrating_bodies(), gradient_lens()};
}

}  // namespace lamella::datasets
