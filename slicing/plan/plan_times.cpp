#include "slicing/plan/plan_times.h"

#include <cmath>

#include "core/error.h"

namespace lamella {

namespace {

/// Sweeps over the layer's box; every material takes its share of the area.
void fill_sweeps(PlanLayer& layer, const Box2& box, const Machine& machine) {
  double area = 0.0;
  for (const PlanStep& step : layer.steps) area += step.statistics.area;
  if (!(area > 0.0)) return;
  const double sweeps = std::ceil(box.sizes().y() / machine.swath);
  for (PlanStep& step : layer.steps) {
    const double sweep = box.sizes().x() / machine.tools[step.tool].speed + machine.turn;
    step.time = sweeps * sweep * step.statistics.area / area;
  }
}

void fill_exposures(PlanLayer& layer, const Machine& machine, const std::vector<MaterialSettings>& settings) {
  for (PlanStep& step : layer.steps) {
    const MaterialSettings& own = settings[step.material.value()];
    const bool is_first = layer.index < static_cast<std::uint32_t>(machine.first_layers);
    step.time = is_first ? own.first_exposure : own.exposure;
  }
}

/// Tracks one beside the other. Without hatch rows there are as many as the width asks for, and of the way between the
/// raster rows as much less as there are fewer tracks than rows.
void fill_tracks(PlanLayer& layer, bool by_hatch, double pitch_y, const Machine& machine,
                 const std::vector<MaterialSettings>& settings) {
  for (PlanStep& step : layer.steps) {
    const MachineTool& tool = machine.tools[step.tool];
    const MaterialStatistics& s = step.statistics;
    const double length = by_hatch ? s.length : s.area / machine.width;
    const double travel = by_hatch ? s.travel : s.travel * std::min(1.0, pitch_y / machine.width);
    step.time = length / settings[step.material.value()].speed.value_or(tool.speed) + travel / tool.travel;
  }
}

}  // namespace

void fill_times(PlanLayer& layer, const Box2& box, bool by_hatch, double pitch_y, const Machine& machine,
                const std::vector<MaterialSettings>& settings) {
  switch (machine.technology) {
    case Technology::material_jetting:
      return fill_sweeps(layer, box, machine);
    case Technology::vat:
      return fill_exposures(layer, machine, settings);
    case Technology::extrusion:
    case Technology::powder_bed:
      return fill_tracks(layer, by_hatch, pitch_y, machine, settings);
  }
}

std::optional<double> price_of(double volume, const std::optional<double>& price, PriceUnit per,
                               const std::optional<double>& density) {
  if (!price) return std::nullopt;
  if (per == PriceUnit::litre) return *price * volume * 1e-6;
  if (!density) return std::nullopt;
  return *price * volume * *density * 1e-6;  // mm^3 * g/cm^3 = 1e-6 kg
}

}  // namespace lamella
