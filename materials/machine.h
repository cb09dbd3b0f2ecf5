#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "core/ids.h"
#include "materials/ramped_motion.h"

namespace lamella {

using ToolId = Id<struct ToolTag>;

/// How a machine lays material down, which decides how a layer's time arises (docs/methods/build-plan.md).
enum class Technology {
  material_jetting,  ///< heads sweep the layer's box in swaths, all materials at once
  vat,               ///< each material's area is exposed as a whole
  extrusion,         ///< tracks
  powder_bed         ///< tracks in powder that is spread once a material
};

[[nodiscard]] const char* name_of(Technology technology);

/// A nozzle, head, vat or hopper: holds one material at a time.
struct MachineTool {
  std::string name;
  std::vector<std::string> holds;                  ///< globs on names of materials; empty: all
  double speed = 0.0;                              ///< mm/s while it deposits
  double travel = 0.0;                             ///< mm/s between tracks
  double purge = 0.0;                              ///< mm^3 of the new material when a change leads to this tool
  std::optional<double> layer_min = std::nullopt;  ///< mm, of layers that it lays; absent: the machine's
  std::optional<double> layer_max = std::nullopt;
  std::optional<double> acceleration = std::nullopt;         ///< mm/s^2 while it deposits; absent: the machine's
  std::optional<double> travel_acceleration = std::nullopt;  ///< mm/s^2 between tracks; absent: the machine's
};

/// What changing from one tool to another takes, where it differs from the rest.
struct ToolChange {
  ToolId from;
  ToolId to;
  double time = 0.0;   ///< s, purging included
  double purge = 0.0;  ///< mm^3 of the material of `to`
};

enum class PriceUnit { kilogram, litre };

/// How materials whose name the glob matches are processed; the first that matches counts.
struct MaterialSettings {
  std::string match = "*";
  std::optional<double> price;  ///< in the machine's currency
  PriceUnit per = PriceUnit::kilogram;
  std::optional<double> speed;         ///< mm/s, instead of the tool's
  std::optional<double> acceleration;  ///< mm/s^2, instead of the tool's
  double exposure = 0.0;               ///< s a layer
  double first_exposure = 0.0;         ///< s, of the first layers
  double temperature = 0.0;            ///< degree Celsius, 0: leave it alone
  double flow = 1.0;                   ///< factor on the volume that is pushed out
  double retraction = 0.0;             ///< mm of filament
  double retraction_speed = 0.0;
  std::optional<double> layer_min;  ///< mm, of adaptive layers that have the material
  std::optional<double> layer_max;
};

enum class SupportFill { overhang, box };
struct MachineSupport {
  std::string material;
  SupportFill fill = SupportFill::overhang;  ///< `box`: all of the build's box that no material takes
  std::optional<double> price;
  PriceUnit per = PriceUnit::kilogram;
  std::optional<double> density;  ///< g/cm^3
};

enum class GcodeFlavor { marlin, reprapfirmware, klipper };

struct GcodeSettings {
  GcodeFlavor flavor = GcodeFlavor::marlin;
  double filament_diameter = 1.75;  ///< mm
  double bed_temperature = 0.0;     ///< degree Celsius, 0: leave it alone
  bool relative_extrusion = true;
  bool serpentine = true;        ///< every second row backwards; else all along the same direction
  Vec2 purge_at = Vec2::Zero();  ///< mm, where a nozzle purges
};

/// What the command and the build plan know of a machine. Lengths in mm, times in s.
struct Machine {
  std::string name;
  Technology technology = Technology::extrusion;
  Vec3 volume = Vec3::Zero();
  Vec2 pitch = Vec2::Zero();  ///< x, y
  double layer_min = 0.0;
  double layer_max = 0.0;
  double layer_step = 0.0;  ///< heights are layer_min plus a multiple of it; 0: any
  double layer_default = 0.0;
  double layer_overhead = 0.0;                ///< s a layer
  double width = 0.0;                         ///< of a track, a drop or a pixel
  double swath = 0.0;                         ///< of a sweep, material jetting only
  double turn = 0.0;                          ///< s from one sweep to the next
  std::optional<double> self_support;         ///< a layer may overhang that far; absent: nothing needs support
  int first_layers = 0;                       ///< exposed longer
  std::optional<double> acceleration;         ///< mm/s^2 of tools that state none; absent: nothing is lost to it
  std::optional<double> travel_acceleration;  ///< mm/s^2 between tracks; absent: as while depositing
  Vec3 shrink = Vec3::Zero();                 ///< fraction that the part loses along each axis
  double width_compensation = 0.0;            ///< mm that a track comes out wider than asked, on each side
  double change_time = 0.0;                   ///< s from tool to tool, where no ToolChange says otherwise
  double change_cost = 0.0;
  bool allows_reloading = false;  ///< between layers an operator may load a tool with another material
  double reload_time = 0.0;
  double reload_cost = 0.0;
  double reload_purge = 0.0;  ///< mm^3 of the new material
  IdVector<ToolId, MachineTool> tools;
  std::vector<ToolChange> changes;
  std::vector<MaterialSettings> settings;
  std::optional<MachineSupport> support;
  std::string currency = "EUR";
  double cost_per_hour = 0.0;
  std::optional<GcodeSettings> gcode;
  std::string source;  ///< file name, for messages

  /// What the change from one tool to another takes; nothing for the same tool.
  [[nodiscard]] ToolChange change(ToolId from, ToolId to) const;
  [[nodiscard]] bool can_hold(ToolId tool, const std::string& material) const;
  /// How the tool moves while it deposits what these settings are of, and between tracks.
  [[nodiscard]] RampedMotion depositing(ToolId tool, const MaterialSettings& material) const;
  [[nodiscard]] RampedMotion traveling(ToolId tool) const;
  /// Heights in mm of the layers that the tool lays: its own range within the machine's, empty (lo > hi) where they
  /// have none in common.
  [[nodiscard]] Interval layers_of(ToolId tool) const;
  /// The first settings that match; those of MaterialSettings{} when none does.
  [[nodiscard]] MaterialSettings settings_of(const std::string& material) const;
  /// mm by which lengths on the machine exceed those of the part, per mm: 1 / (1 - shrink).
  [[nodiscard]] Vec3 scale() const;
};

/// Largest number of tools that a machine may have.
inline constexpr std::size_t kMaxTools = 32;

/// Reads machine.xml (schemas/machine.xsd, docs/formats/machine.md). Throws InputError with file, line and hint.
[[nodiscard]] Machine read_machine(const std::filesystem::path& path);

/// Whether a height in mm, typed as a decimal, is in a range of heights: half a nanometre counts as rounding.
[[nodiscard]] bool takes_height(const Interval& range, double height);

/// Why the machine can't build layers of this height, empty when it can.
[[nodiscard]] std::string layer_height_fault(const Machine& machine, double height);

}  // namespace lamella
