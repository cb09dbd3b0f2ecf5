#include "export/gcode_writer.h"

#include <cmath>
#include <fmt/format.h>

#include "export/gcode_words.h"

namespace lamella {

namespace {

constexpr double kPurgeSpeed = 5.0;  // mm of filament a second

double rounded(double coordinate) { return std::round(coordinate * 1e4) * 1e-4; }

}  // namespace

GcodeWriter::GcodeWriter(std::ostream& stream, const Machine& machine)
    : stream_(stream),
      machine_(machine),
      gcode_(*machine.gcode),
      filament_area_(kPi / 4.0 * gcode_.filament_diameter * gcode_.filament_diameter),
      temperature_(machine.tools.size()),
      is_retracted_(machine.tools.size()) {}

void GcodeWriter::line(const std::string& text) { stream_ << text << '\n'; }

void GcodeWriter::comment(const std::string& text) { line("; " + gcode::plain(text)); }

void GcodeWriter::write_start() {
  line("G21");
  line("G90");
  line(gcode_.relative_extrusion ? "M83" : "M82");
  line("G28");
  if (gcode_.bed_temperature > 0.0) stream_ << gcode::heat_bed(gcode_.flavor, gcode_.bed_temperature);
}

void GcodeWriter::write_end() {
  leave_tool();
  for (std::size_t t = 0; t < temperature_.size(); ++t) {
    if (temperature_[t] > 0.0) stream_ << gcode::cool_tool(gcode_.flavor, t);
  }
  if (gcode_.bed_temperature > 0.0) stream_ << gcode::heat_bed(gcode_.flavor, 0.0);
  line("M84");
}

void GcodeWriter::feed(double filament, double speed, const std::string& move) {
  filament_ += filament;
  const auto told = static_cast<std::int64_t>(std::llround(filament_ * 1e5));
  const std::int64_t number = gcode_.relative_extrusion ? told - filament_told_ : told;
  filament_told_ = told;
  line(fmt::format("G1{} E{:.5f} F{:.0f}", move, static_cast<double>(number) * 1e-5, speed * 60.0));
}

void GcodeWriter::retract() {
  if (!tool_ || is_retracted_[tool_->value()] || settings_.retraction <= 0.0) return;
  feed(-settings_.retraction, settings_.retraction_speed, "");
  is_retracted_[tool_->value()] = true;
}

void GcodeWriter::unretract() {
  if (!is_retracted_[tool_->value()]) return;
  feed(settings_.retraction, settings_.retraction_speed, "");
  is_retracted_[tool_->value()] = false;
}

void GcodeWriter::leave_tool() {
  retract();
  tool_.reset();
}

void GcodeWriter::accelerate(bool is_travel) {
  const double tracks = machine_.depositing(*tool_, settings_).acceleration;
  const double travels = machine_.traveling(*tool_).acceleration;
  if (!std::isfinite(tracks) || !std::isfinite(travels)) return;
  // Klipper knows but one, which has to be told anew.
  const bool is_one = gcode_.flavor == GcodeFlavor::klipper;
  const std::array<double, 2> told{is_one && is_travel ? travels : tracks, is_one ? 0.0 : travels};
  if (told == acceleration_told_) return;
  stream_ << gcode::set_acceleration(gcode_.flavor, told[0], told[1]);
  acceleration_told_ = told;
}

void GcodeWriter::use_tool(ToolId tool, const MaterialSettings& settings, double purge) {
  const bool is_other = tool_ != tool;
  if (is_other) {
    leave_tool();
    stream_ << gcode::select_tool(gcode_.flavor, tool.value());
    line("G92 E0");
    tool_ = tool;
    at_.reset();
    filament_ = 0.0;
    filament_told_ = 0;
    acceleration_told_.reset();
  }
  settings_ = settings;
  double& temperature = temperature_[tool.value()];
  if (settings.temperature > 0.0 && settings.temperature != temperature) {
    stream_ << gcode::heat_tool(gcode_.flavor, tool.value(), settings.temperature);
    temperature = settings.temperature;
  }
  if (purge <= 0.0) return;
  comment(fmt::format("purge {:.6g} mm^3", purge));
  travel(gcode_.purge_at);
  unretract();
  feed(purge / filament_area_, kPurgeSpeed, "");
  retract();
}

void GcodeWriter::reload(ToolId tool, const std::string& material) {
  retract();
  stream_ << gcode::pause(gcode_.flavor, "load " + machine_.tools[tool].name + " with " + gcode::plain(material));
}

void GcodeWriter::move_up(double z) {
  retract();
  z_ = z;
  line(fmt::format("G0 Z{:.4f}", z));
}

void GcodeWriter::travel(const Vec2& to) {
  accelerate(true);
  const double speed = machine_.traveling(*tool_).speed;
  line(fmt::format("G0 X{:.4f} Y{:.4f} F{:.0f}", to.x(), to.y(), speed * 60.0));
  at_ = to;
}

void GcodeWriter::track(const Vec2& from, const Vec2& to, double volume) {
  const Vec2 begin(rounded(from.x()), rounded(from.y()));
  const Vec2 end(rounded(to.x()), rounded(to.y()));
  if (!at_ || *at_ != begin) {
    // Between neighbouring rows the nozzle stays over the part.
    const bool is_far = !at_ || (begin - *at_).norm() > 2.0 * machine_.width;
    if (is_far) retract();
    travel(begin);
  }
  unretract();
  accelerate(false);
  const double speed = machine_.depositing(*tool_, settings_).speed;
  feed(volume * settings_.flow / filament_area_, speed, fmt::format(" X{:.4f} Y{:.4f}", end.x(), end.y()));
  at_ = end;
}

}  // namespace lamella
