#include "bench/exact_peers.h"
#include "model/step/read_step.h"

namespace lamella::bench {

ExactModel read_model(const std::string& file) {
  const std::filesystem::path path = file;
  ExactModel model;
  model.scene = read_step(std::span(&path, 1));
  for (const SolidId solid : model.scene.solids.ids()) {
    if (model.scene.solids[solid].info.status != SolidStatus::ok) continue;
    model.solids.push_back(solid);
    for (const ShellId shell : model.scene.solids[solid].shells) {
      for (const FaceId face : model.scene.shells[shell].faces) model.bounds.extend(exact_bounds(model.scene, face));
    }
  }
  if (model.solids.empty()) throw InputError("no solid can be sliced", file);
  return model;
}

Lattice make_lattice(const Box3& bounds, std::int32_t rows, std::int32_t layers) {
  Lattice lattice;
  lattice.bounds = bounds;
  lattice.rows = rows;
  lattice.layers = layers;
  lattice.y0 = bounds.min().y();
  lattice.z0 = bounds.min().z();
  lattice.pitch_y = bounds.sizes().y() / rows;
  lattice.pitch_z = bounds.sizes().z() / layers;
  return lattice;
}

}  // namespace lamella::bench
