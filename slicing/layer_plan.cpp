#include "slicing/layer_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "core/error.h"
#include "core/tolerances.h"
#include "core/xml.h"

namespace lamella {

namespace {

constexpr double kRowsByDefault = 1000.0;
constexpr double kLayersByDefault = 500.0;
constexpr std::int64_t kMaxVoxels = std::numeric_limits<std::int32_t>::max();
/// Rows and layers are held in memory, one number each; 1e7 of them is 10 m at 1 um.
constexpr std::int64_t kMaxLines = 10'000'000;
/// A thousand kilometres in mm: beyond it, products of coordinates are of no use to anyone downstream.
constexpr double kFarthest = 1e9;
/// Of a row of pixels; 8 bits of grey tell no more apart.
constexpr std::int64_t kMostSubRows = 64;
/// A nanometre: what contours are joined and subtracted at (docs/methods/material-contours.md).
constexpr double kFinestChord = 1e-6;  // mm

const char* axis_name(int axis) {
  constexpr const char* kNames[] = {"x", "y", "z"};
  return kNames[axis];
}

/// A number for an error message, which must not fail on the overflow it reports.
std::string show(double value) { return std::isfinite(value) ? format_double(value) : "more than a double holds"; }

/// The number 1, 2 or 5 times a power of ten that is nearest to `value` by ratio.
double round_to_1_2_5(double value) {
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  double best = decade;
  for (const double step : {2.0, 5.0, 10.0}) {
    const double candidate = step * decade;
    if (std::abs(std::log(candidate / value)) < std::abs(std::log(best / value))) best = candidate;
  }
  return best;
}

void check_bounds(const Box3& bounds) {
  const Vec3 extent = bounds.max() - bounds.min();
  // Written so that NaN fails.
  if (!bounds.min().allFinite() || !bounds.max().allFinite() || !(extent.minCoeff() >= 0.0)) {
    throw InputError("the assembly has no finite bounds", {},
                     "see `lamella info` for solids that are empty or invalid");
  }
}

/// Pitch of each axis, given or by default.
Vec3 choose_pitch(const Box3& bounds, const PlanOptions& options) {
  const Vec3 extent = bounds.max() - bounds.min();
  Vec3 pitch;
  if (options.pitch) {
    pitch.head<2>() = *options.pitch;
  } else {
    const double width = extent.head<2>().maxCoeff() > 0.0 ? extent.head<2>().maxCoeff() : extent.z();
    pitch.head<2>().setConstant(width > 0.0 ? round_to_1_2_5(width / kRowsByDefault) : 0.0);
  }
  if (options.layer_height) {
    pitch.z() = *options.layer_height;
  } else {
    pitch.z() = extent.maxCoeff() > 0.0 ? round_to_1_2_5(extent.maxCoeff() / kLayersByDefault) : 0.0;
  }
  return pitch;
}

void check_pitch(const Vec3& pitch) {
  for (int axis = 0; axis < 3; ++axis) {
    if (pitch[axis] > 0.0 && std::isfinite(pitch[axis])) continue;
    throw UsageError(axis == 2 ? "the layer height must be positive and finite"
                               : std::string("the pitch along ") + axis_name(axis) + " must be positive and finite",
                     {}, "give a length in mm");
  }
}

Vec3 choose_origin(const Box3& bounds, const PlanOptions& options) {
  if (!options.origin) return bounds.min();
  const Vec3& origin = *options.origin;
  for (int axis = 0; axis < 3; ++axis) {
    if (origin[axis] <= bounds.min()[axis] && std::isfinite(origin[axis])) continue;
    throw UsageError(std::string("the origin lies above the lower bound of the assembly along ") + axis_name(axis), {},
                     "give at most " + format_double(bounds.min()[axis]));
  }
  return origin;
}

/// n = max(1, ceil((upper - O) / p - 1e-6)), within what the lattice can number and doubles can tell apart.
std::int64_t count_voxels(int axis, double origin, double upper, double pitch) {
  const double count = std::max(1.0, std::ceil((upper - origin) / pitch - tolerance::kGridSlack));
  const std::int64_t limit = axis == 0 ? kMaxVoxels : kMaxLines;
  if (!(count <= static_cast<double>(limit))) {
    throw UsageError(std::string("too many voxels along ") + axis_name(axis) + ": " + show(count) + ", at most " +
                         std::to_string(limit),
                     {}, "choose a coarser pitch or layer height");
  }
  const double far = std::max(std::abs(origin), std::abs(origin + count * pitch));
  if (!(far <= kFarthest)) {
    throw UsageError(std::string("the lattice reaches too far along ") + axis_name(axis) + ": " + show(far) + " mm", {},
                     "check the units, the origin and the pitch");
  }
  // Half a pitch must move every coordinate of the lattice, with a few bits to spare.
  if (!(pitch > 64.0 * std::numeric_limits<double>::epsilon() * far)) {
    throw UsageError(
        std::string("the pitch along ") + axis_name(axis) + " is lost in rounding at coordinate " + show(far), {},
        "choose a coarser pitch, or move the assembly nearer to the machine origin");
  }
  return static_cast<std::int64_t>(count);
}

void check_hatch(const HatchLattice& hatch, const Box3& bounds) {
  if (!(hatch.spacing > 0.0) || !std::isfinite(hatch.spacing)) {
    throw UsageError("the hatch spacing must be positive and finite", {}, "give a length in mm");
  }
  if (!std::isfinite(hatch.angle) || !std::isfinite(hatch.rotation)) {
    throw UsageError("the hatch angle and its rotation per layer must be finite", {}, "give angles in degrees");
  }
  // Hatch rows are numbered from the machine origin, in whatever direction they run.
  const double reach = bounds.min().head<2>().cwiseAbs().cwiseMax(bounds.max().head<2>().cwiseAbs()).norm();
  if (!(reach / hatch.spacing <= static_cast<double>(kMaxLines))) {
    throw UsageError("the hatch spacing gives too many rows: at most " + std::to_string(kMaxLines), {},
                     "choose a coarser spacing");
  }
}

void check_chord_error(double chord_error) {
  if (chord_error >= kFinestChord && std::isfinite(chord_error)) return;
  throw UsageError("the chord error of contours must be finite and at least " + show(kFinestChord) + " mm", {},
                   "give a length in mm");
}

}  // namespace

LayerPlan plan_layers(const Box3& bounds, const PlanOptions& options) {
  check_bounds(bounds);
  LayerPlan plan;
  plan.grid.pitch = choose_pitch(bounds, options);
  check_pitch(plan.grid.pitch);
  plan.grid.origin = choose_origin(bounds, options);
  for (int axis = 0; axis < 3; ++axis) {
    plan.grid.size[static_cast<std::size_t>(axis)] =
        count_voxels(axis, plan.grid.origin[axis], bounds.max()[axis], plan.grid.pitch[axis]);
  }
  if (options.hatch) check_hatch(*options.hatch, bounds);
  plan.hatch = options.hatch;
  if (options.chord_error) check_chord_error(*options.chord_error);
  plan.chord_error = options.chord_error;
  plan.curves = options.chord_error && options.curves;
  if (options.sub_rows < 0 || options.sub_rows > kMostSubRows) {
    throw UsageError("a row of pixels can have " + std::to_string(kMostSubRows) + " lines at most", {},
                     "give --coverage-rows less");
  }
  plan.sub_rows = options.sub_rows;

  // One expression for every height, so that the top of a layer is the bottom of the next bit for bit.
  const auto height = [&](double k) { return plan.grid.origin.z() + k * plan.grid.pitch.z(); };
  plan.layers.reserve(static_cast<std::size_t>(plan.grid.size[2]));
  for (std::int64_t layer = 0; layer < plan.grid.size[2]; ++layer) {
    const double k = static_cast<double>(layer);
    plan.layers.push_back({height(k), height(k + 0.5), height(k + 1.0)});
  }
  return plan;
}

HatchAxes hatch_axes(const HatchLattice& hatch, std::size_t layer) {
  const double turn = static_cast<double>(layer) * hatch.rotation;
  const double angle = hatch.angle + turn;
  const double quarters = angle / (0.5 * kPi);
  const double whole = std::round(quarters);
  // Degrees to radians, the product and the sum round once each: four roundings of at most the larger term.
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * (std::abs(hatch.angle) + std::abs(turn));
  double c = std::cos(angle);
  double s = std::sin(angle);
  if (std::abs(quarters - whole) <= rounding) {
    constexpr double kCosine[] = {1.0, 0.0, -1.0, 0.0};
    const int quadrant = static_cast<int>(std::fmod(std::fmod(whole, 4.0) + 4.0, 4.0));
    c = kCosine[quadrant];
    s = kCosine[(quadrant + 3) % 4];
  }
  return {Vec2(c, s), Vec2(-s, c)};
}

}  // namespace lamella
