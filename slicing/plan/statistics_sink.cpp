#include "slicing/plan/statistics_sink.h"

namespace lamella {

StatisticsSink::StatisticsSink(const Machine& machine) : machine_(machine) {
  options_.width = machine.width;
  options_.self_support = machine.self_support;
  options_.serpentine = !machine.gcode || machine.gcode->serpentine;
}

void StatisticsSink::begin(const BuildInfo& info) {
  info_ = info;
  options_.use_hatch = info.plan.hatch.has_value();
  options_.paces.clear();
  for (const Material& material : info.materials) options_.paces.push_back(paces_of(machine_, material.name).all);
  layers_.reserve(info.plan.layers.size());
}

void StatisticsSink::write(const Layer& layer) {
  // The first layer stands on the plate.
  layers_.push_back(
      measure_layer(layer, info_.plan.grid, info_.materials.size(), options_, below_ ? &*below_ : nullptr));
  credit_components(layer, info_.plan.grid, info_.materials, layers_.back());
  below_ = cover_of(layer.raster);
}

void StatisticsSink::finish(const SliceReport& report) { report_ = report; }

}  // namespace lamella
