#include "export/gcode_words.h"

#include <fmt/format.h>

#include "export/decimal.h"

namespace lamella::gcode {

namespace {

/// Klipper calls its heaters extruder, extruder1, extruder2 ...
std::string klipper_extruder(std::size_t tool) { return tool == 0 ? "extruder" : fmt::format("extruder{}", tool); }

}  // namespace

std::string plain(std::string_view text) {
  constexpr std::size_t kLongest = 80;
  std::string out;
  for (const char c : text.substr(0, kLongest)) {
    const bool is_safe = c >= ' ' && c <= '~' && c != ';' && c != '"' && c != '(' && c != ')' && c != '*' && c != '\\';
    out += is_safe ? c : '_';
  }
  return out;
}

const char* name_of(GcodeFlavor flavor) {
  switch (flavor) {
    case GcodeFlavor::marlin:
      return "Marlin";
    case GcodeFlavor::reprapfirmware:
      return "RepRapFirmware";
    case GcodeFlavor::klipper:
      break;
  }
  return "Klipper";
}

std::string select_tool(GcodeFlavor flavor, std::size_t tool) {
  if (flavor == GcodeFlavor::klipper) return "ACTIVATE_EXTRUDER EXTRUDER=" + klipper_extruder(tool) + "\n";
  return fmt::format("T{}\n", tool);
}

std::string heat_tool(GcodeFlavor flavor, std::size_t tool, double temperature) {
  switch (flavor) {
    case GcodeFlavor::marlin:
      return fmt::format("M109 T{} S{:.0f}\n", tool, temperature);
    case GcodeFlavor::reprapfirmware:
      return fmt::format("G10 P{0} S{1:.0f} R{1:.0f}\nM116 P{0}\n", tool, temperature);
    case GcodeFlavor::klipper:
      break;
  }
  const std::string heater = klipper_extruder(tool);
  return fmt::format("SET_HEATER_TEMPERATURE HEATER={0} TARGET={1:.0f}\nTEMPERATURE_WAIT SENSOR={0} MINIMUM={1:.0f}\n",
                     heater, temperature);
}

std::string cool_tool(GcodeFlavor flavor, std::size_t tool) {
  switch (flavor) {
    case GcodeFlavor::marlin:
      return fmt::format("M104 T{} S0\n", tool);
    case GcodeFlavor::reprapfirmware:
      return fmt::format("G10 P{} S0 R0\n", tool);
    case GcodeFlavor::klipper:
      break;
  }
  return "SET_HEATER_TEMPERATURE HEATER=" + klipper_extruder(tool) + " TARGET=0\n";
}

std::string set_acceleration(GcodeFlavor flavor, double tracks, double travels) {
  std::string first;
  append_decimal(first, tracks);
  if (flavor == GcodeFlavor::klipper) return "SET_VELOCITY_LIMIT ACCEL=" + first + "\n";
  std::string second;
  append_decimal(second, travels);
  return "M204 P" + first + " T" + second + "\n";
}

std::string heat_bed(GcodeFlavor flavor, double temperature) {
  if (flavor == GcodeFlavor::klipper) {
    return fmt::format("SET_HEATER_TEMPERATURE HEATER=heater_bed TARGET={:.0f}\n", temperature) +
           (temperature > 0.0 ? fmt::format("TEMPERATURE_WAIT SENSOR=heater_bed MINIMUM={:.0f}\n", temperature) : "");
  }
  return fmt::format("{} S{:.0f}\n", temperature > 0.0 ? "M190" : "M140", temperature);
}

std::string pause(GcodeFlavor flavor, std::string_view message) {
  switch (flavor) {
    case GcodeFlavor::marlin:
      return "M0 " + plain(message) + "\n";
    case GcodeFlavor::reprapfirmware:
      return "M291 P\"" + plain(message) + "\" S3\n";
    case GcodeFlavor::klipper:
      break;
  }
  return "M117 " + plain(message) + "\nPAUSE\n";
}

}  // namespace lamella::gcode
