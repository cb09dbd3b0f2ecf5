#pragma once

#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "core/geometry.h"
#include "materials/machine.h"

namespace lamella {

/// Writes moves, and keeps what the machine's state is meanwhile. Positions in mm on the machine.
/// Coordinates have four decimals, lengths of filament five; those are rounded as sums, so that rounding doesn't add
/// up.
class GcodeWriter {
 public:
  GcodeWriter(std::ostream& stream, const Machine& machine);

  void write_start();
  void write_end();
  void comment(const std::string& text);

  /// Changes to the tool if another is in use, heats it for the material, and purges a volume in mm^3.
  void use_tool(ToolId tool, const MaterialSettings& settings, double purge);
  /// Has the operator load the tool with another material.
  void reload(ToolId tool, const std::string& material);
  void move_up(double z);
  /// One track of `volume` mm^3; travels to its beginning first.
  void track(const Vec2& from, const Vec2& to, double volume);

 private:
  void line(const std::string& text);
  void travel(const Vec2& to);
  /// Pushes out that much filament, or draws it back, while standing; or along with a move that `move` begins.
  void feed(double filament, double speed, const std::string& move);
  void retract();
  void unretract();
  void leave_tool();
  /// Tells the firmware how the tool in use is accelerated on what comes next, where the machine states it.
  void accelerate(bool is_travel);

  std::ostream& stream_;
  const Machine& machine_;
  const GcodeSettings& gcode_;
  double filament_area_;
  std::vector<double> temperature_;  ///< of each tool as last set
  std::vector<bool> is_retracted_;
  std::optional<ToolId> tool_;
  MaterialSettings settings_;
  std::optional<Vec2> at_;
  double z_ = 0.0;
  /// mm/s^2 of tracks and travels, 0 of those that the firmware knows not; none where a change of tool may have set
  /// others.
  std::optional<std::array<double, 2>> acceleration_told_;
  double filament_ = 0.0;           ///< mm since the tool was chosen, retractions left out
  std::int64_t filament_told_ = 0;  ///< the same in 1e-5 mm as written
};

}  // namespace lamella
