#include "slicing/plan/plan_times.h"

#include <cmath>

namespace lamella {

LayingTimes::LayingTimes(const Machine& machine, const IdVector<MaterialId, Material>& materials) : machine_(machine) {
  for (const Material& material : materials) {
    settings_.push_back(machine.settings_of(material.name));
    paces_.push_back(paces_of(machine, material.name));
  }
}

double LayingTimes::seconds(const LayerStatistics& layer, const MaterialStatistics& one, ToolId tool) const {
  switch (machine_.technology) {
    case Technology::material_jetting:
      return of_sweeps(layer, one, tool);
    case Technology::vat:
      return of_exposure(layer, one);
    case Technology::extrusion:
    case Technology::powder_bed:
      break;
  }
  return one.times.at(paces_[one.material].of_tool[tool.value()]);
}

/// Sweeps over the layer's box, of which every material takes its share of the area. The box is printed at full speed:
/// a sweep gains it before the box and loses it behind.
double LayingTimes::of_sweeps(const LayerStatistics& layer, const MaterialStatistics& one, ToolId tool) const {
  double area = 0.0;
  for (const MaterialStatistics& other : layer.materials) area += other.area;
  if (!(area > 0.0)) return 0.0;
  const double sweeps = std::ceil(layer.box.sizes().y() / machine_.swath);
  const RampedMotion motion = machine_.depositing(tool, settings_[one.material]);
  const double sweep = layer.box.sizes().x() / motion.speed + 2.0 * motion.speed / motion.acceleration + machine_.turn;
  return sweeps * sweep * one.area / area;
}

double LayingTimes::of_exposure(const LayerStatistics& layer, const MaterialStatistics& one) const {
  const MaterialSettings& own = settings_[one.material];
  return layer.index < static_cast<std::uint32_t>(machine_.first_layers) ? own.first_exposure : own.exposure;
}

std::optional<double> price_of(double volume, const std::optional<double>& price, PriceUnit per,
                               const std::optional<double>& density) {
  if (!price) return std::nullopt;
  if (per == PriceUnit::litre) return *price * volume * 1e-6;
  if (!density) return std::nullopt;
  return *price * volume * *density * 1e-6;  // mm^3 * g/cm^3 = 1e-6 kg
}

}  // namespace lamella
