#pragma once

#include <string>
#include <string_view>

#include "materials/machine.h"

namespace lamella {

/// What firmwares say differently; each is one or more whole lines.
namespace gcode {

/// `text` as it may stand in a comment or a message: printable ASCII without what ends one, at most 80 characters.
[[nodiscard]] std::string plain(std::string_view text);

[[nodiscard]] const char* name_of(GcodeFlavor flavor);
[[nodiscard]] std::string select_tool(GcodeFlavor flavor, std::size_t tool);
/// Heats a tool to the temperature and waits for it, or (0) lets it cool.
[[nodiscard]] std::string heat_tool(GcodeFlavor flavor, std::size_t tool, double temperature);
[[nodiscard]] std::string cool_tool(GcodeFlavor flavor, std::size_t tool);
/// Has the firmware accelerate tracks and travels by these, mm/s^2, 1 or more. Klipper knows but one acceleration, of
/// all that comes next: that of tracks is told it.
[[nodiscard]] std::string set_acceleration(GcodeFlavor flavor, double tracks, double travels);
[[nodiscard]] std::string heat_bed(GcodeFlavor flavor, double temperature);
/// Stops until the operator goes on.
[[nodiscard]] std::string pause(GcodeFlavor flavor, std::string_view message);

}  // namespace gcode

}  // namespace lamella
