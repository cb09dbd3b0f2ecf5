#include "materials/compositions.h"

#include <map>
#include <tuple>

namespace lamella {

Compositions::Compositions(const Scene& scene, const MaterialTable& table) {
  // Copies of a body share a field; a solid of which the reader knows no body has one of its own.
  std::map<std::tuple<const FieldSource*, std::size_t, std::size_t>, std::size_t> known;
  for (const SolidId solid : scene.solids.ids()) {
    const Material& material = table.materials[table.assignments[solid].material];
    const SolidInfo& info = scene.solids[solid].info;
    Place place;
    if (material.is_graded() && material.field && info.status != SolidStatus::empty) {
      place = {material.components.size(), fields_.size(), part_frame(info)};
      if (info.instance) {
        place.field = known.emplace(std::tuple(material.field.get(), info.file, info.instance->body), fields_.size())
                          .first->second;
      }
      if (place.field == fields_.size()) fields_.push_back(material.field->bind(scene, solid));
    }
    places_.push_back(place);
  }
}

Compositions::Probe::Probe(const Compositions& compositions)
    : compositions_(compositions), probes_(compositions.fields_.size()) {}

void Compositions::Probe::start(SolidId solid) {
  const Place& place = compositions_.places_[solid];
  auto& probe = probes_[place.field];
  if (!probe) probe = compositions_.fields_[place.field]->probe();
  probe->start_points();
  probe_ = probe.get();
  frame_ = &place.frame;
}

void Compositions::Probe::start_row(SolidId solid, const RowPiece& piece) {
  start(solid);
  probe_->start_row({frame_->to_part(piece.origin), frame_->turn.transpose() * piece.along, piece.range});
}

double Compositions::Probe::sample(const Vec3& point, std::span<double> fractions) {
  return probe_->sample(frame_->to_part(point), fractions);
}

}  // namespace lamella
