#include "slicing/accuracy/choose_lattice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/xml.h"

namespace lamella::accuracy {

namespace {

/// Integrals of |n| are known within 1 % (model/measure.h).
constexpr double kAreaSlack = 1.01;
/// Quotients that are whole numbers but for rounding.
constexpr double kWhole = 1.0 + 1e-12;

/// What quadrature needs to know of a solid: parts of its area seen along y and z.
struct Seen {
  double y = 0.0;  ///< A_y / A
  double z = 0.0;  ///< A_z / A
};

std::vector<Seen> seen_parts(const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids) {
  std::vector<Seen> seen;
  for (const SolidId solid : solids) {
    const SolidMeasure& measure = measures[solid];
    if (!(measure.area > 0.0) || !measure.abs_normal_area.allFinite()) continue;
    seen.push_back({kAreaSlack * measure.abs_normal_area.y() / measure.area,
                    kAreaSlack * measure.abs_normal_area.z() / measure.area});
  }
  return seen;
}

double surface_bound(const Vec3& pitch) { return 0.5 * pitch.norm(); }

double offset_bound(const Vec3& pitch, const std::vector<Seen>& seen) {
  double largest = 0.0;
  for (const Seen& solid : seen) largest = std::max(largest, pitch.y() * solid.y + pitch.z() * solid.z);
  return largest;
}

/// Rounded down to two digits.
double round_down(double value) {
  // Units are whole powers of ten, which doubles hold where the power isn't negative: divide by those.
  const double digits = 1.0 - std::floor(std::log10(value));
  const double power = std::pow(10.0, std::abs(digits));
  const double scaled = digits >= 0.0 ? value * power : value / power;
  const double whole = std::floor(scaled * kWhole);  // 0.01 is 10 thousandths but for rounding
  return digits >= 0.0 ? whole / power : whole * power;
}

Vec3 equal_pitch(double accuracy, const std::vector<Seen>& seen) {
  double pitch = 2.0 * accuracy / std::sqrt(3.0);
  for (const Seen& solid : seen) pitch = std::min(pitch, accuracy / (solid.y + solid.z));
  return Vec3::Constant(round_down(pitch));
}

/// The largest layer height within both bounds, not more than `most`; zero or less if there is none.
double largest_height(double accuracy, const Vec2& raster, const std::vector<Seen>& seen, double most) {
  const double left = accuracy * accuracy - 0.25 * raster.squaredNorm();
  double height = left > 0.0 ? std::min(most, 2.0 * std::sqrt(left)) : 0.0;
  for (const Seen& solid : seen) {
    if (solid.z > 0.0) height = std::min(height, (accuracy - raster.y() * solid.y) / solid.z);
  }
  return height;
}

Vec3 machine_pitch(double accuracy, const std::vector<Seen>& seen, const Machine& machine) {
  double height = largest_height(accuracy, machine.pitch, seen, machine.layer_max);
  if (machine.layer_step > 0.0 && height >= machine.layer_min) {
    const double steps = std::floor((height - machine.layer_min) / machine.layer_step * kWhole);
    height = machine.layer_min + steps * machine.layer_step;
  }
  const Vec3 finest(machine.pitch.x(), machine.pitch.y(), machine.layer_min);
  if (height >= machine.layer_min) return {finest.x(), finest.y(), height};
  const double reached = std::max(surface_bound(finest), offset_bound(finest, seen));
  throw UsageError(
      "the machine can't reach an accuracy of " + format_double(accuracy) + " mm", "--accuracy",
      "with its pitch and thinnest layers it reaches " + format_double(std::ceil(reached * 1e6) / 1e6) + " mm");
}

double file_tolerance(const Scene& scene, std::span<const SolidId> solids) {
  double most = 0.0;
  for (const SolidId solid : solids) most = std::max(most, scene.solids[solid].info.max_tolerance);
  return most;
}

void require_accuracy(double accuracy) {
  if (accuracy > 0.0 && std::isfinite(accuracy)) return;
  throw UsageError("the accuracy must be positive and finite", "--accuracy", "give a length in mm");
}

AdaptiveShare share_of_machine(double accuracy, std::optional<double> deviation, const Machine& machine) {
  const double raster = 0.5 * machine.pitch.norm();
  const double left = accuracy - raster;
  const auto up = [](double value) { return format_double(std::ceil(value * 1e6) / 1e6) + " mm"; };
  if (!(left > 0.0)) {
    throw UsageError("the machine can't reach an accuracy of " + format_double(accuracy) + " mm", "--accuracy",
                     "its pitch alone takes " + up(raster) + ", and layers take more");
  }
  if (deviation && *deviation > left) {
    throw UsageError("layers that deviate by " + format_double(*deviation) +
                         " mm and the machine's pitch don't reach " + format_double(accuracy) + " mm",
                     "--adaptive",
                     "with its pitch they reach " + up(raster + *deviation) + "; --adaptive auto takes what is left");
  }
  return {machine.pitch, deviation.value_or(round_down(left))};
}

}  // namespace

AdaptiveShare share_accuracy(double accuracy, std::optional<double> deviation, const Machine* machine) {
  require_accuracy(accuracy);
  if (machine != nullptr) return share_of_machine(accuracy, deviation, *machine);
  const double layers = deviation.value_or(round_down(0.5 * accuracy));
  if (!(layers < accuracy)) {
    throw UsageError("layers that deviate by " + format_double(layers) + " mm leave nothing of an accuracy of " +
                         format_double(accuracy) + " mm to the pitch",
                     "--adaptive", "give less than --accuracy, or --adaptive auto");
  }
  return {Vec2::Constant(round_down(std::sqrt(2.0) * (accuracy - layers))), layers};
}

LatticeChoice adaptive_guarantee(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                 std::span<const SolidId> solids, double accuracy, const Vec2& pitch, double thickest,
                                 double deviation) {
  LatticeChoice choice;
  choice.wanted = accuracy;
  choice.pitch = {pitch.x(), pitch.y(), thickest};
  choice.surface_bound = 0.5 * pitch.norm() + deviation;
  choice.offset_bound = offset_bound(choice.pitch, seen_parts(measures, solids));
  choice.file_tolerance = file_tolerance(scene, solids);
  return choice;
}

LatticeChoice choose_lattice(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                             std::span<const SolidId> solids, double accuracy, const Machine* machine) {
  require_accuracy(accuracy);
  const std::vector<Seen> seen = seen_parts(measures, solids);
  LatticeChoice choice;
  choice.wanted = accuracy;
  choice.pitch = machine != nullptr ? machine_pitch(accuracy, seen, *machine) : equal_pitch(accuracy, seen);
  choice.surface_bound = surface_bound(choice.pitch);
  choice.offset_bound = offset_bound(choice.pitch, seen);
  choice.file_tolerance = file_tolerance(scene, solids);
  return choice;
}

}  // namespace lamella::accuracy
