#include "materials/machine.h"

#include <algorithm>
#include <cmath>

#include "core/xml.h"
#include "materials/glob.h"

namespace lamella {

namespace {

/// Heights are typed as decimals: half a nanometre is their rounding, not a difference.
constexpr double kHeightRounding = 5e-7;  // mm

}  // namespace

const char* name_of(Technology technology) {
  switch (technology) {
    case Technology::material_jetting:
      return "material-jetting";
    case Technology::vat:
      return "vat";
    case Technology::extrusion:
      return "extrusion";
    case Technology::powder_bed:
      break;
  }
  return "powder-bed";
}

ToolChange Machine::change(ToolId from, ToolId to) const {
  if (from == to) return {from, to, 0.0, 0.0};
  for (const ToolChange& given : changes) {
    if (given.from == from && given.to == to) return given;
  }
  return {from, to, change_time, tools[to].purge};
}

bool Machine::can_hold(ToolId tool, const std::string& material) const {
  const std::vector<std::string>& globs = tools[tool].holds;
  return globs.empty() ||
         std::any_of(globs.begin(), globs.end(), [&](const std::string& glob) { return matches_glob(glob, material); });
}

RampedMotion Machine::depositing(ToolId tool, const MaterialSettings& material) const {
  const MachineTool& own = tools[tool];
  const std::optional<double> of_tool = own.acceleration ? own.acceleration : acceleration;
  return {material.speed.value_or(own.speed),
          material.acceleration.value_or(of_tool.value_or(RampedMotion().acceleration))};
}

RampedMotion Machine::traveling(ToolId tool) const {
  const MachineTool& own = tools[tool];
  for (const auto& stated : {own.travel_acceleration, travel_acceleration, own.acceleration, acceleration}) {
    if (stated) return {own.travel, *stated};
  }
  return {own.travel};
}

Interval Machine::layers_of(ToolId tool) const {
  const MachineTool& own = tools[tool];
  return {std::max(layer_min, own.layer_min.value_or(layer_min)),
          std::min(layer_max, own.layer_max.value_or(layer_max))};
}

MaterialSettings Machine::settings_of(const std::string& material) const {
  const auto found = std::find_if(settings.begin(), settings.end(),
                                  [&](const MaterialSettings& one) { return matches_glob(one.match, material); });
  return found == settings.end() ? MaterialSettings{} : *found;
}

Vec3 Machine::scale() const { return (Vec3::Ones() - shrink).cwiseInverse(); }

bool takes_height(const Interval& range, double height) {
  return height >= range.lo - kHeightRounding && height <= range.hi + kHeightRounding;
}

std::string layer_height_fault(const Machine& machine, double height) {
  if (!takes_height({machine.layer_min, machine.layer_max}, height)) {
    return "the machine builds layers of " + format_double(machine.layer_min) + " to " +
           format_double(machine.layer_max) + " mm";
  }
  if (machine.layer_step <= 0.0) return {};
  const double steps = (height - machine.layer_min) / machine.layer_step;
  if (std::abs(steps - std::round(steps)) * machine.layer_step <= kHeightRounding) return {};
  return "the machine builds layers of " + format_double(machine.layer_min) + " mm plus a multiple of " +
         format_double(machine.layer_step) + " mm";
}

}  // namespace lamella
