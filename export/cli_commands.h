#pragma once

#include <memory>
#include <span>
#include <string>
#include <utility>

#include "core/geometry.h"

namespace lamella {

/// Sense of a polyline, by its number in the format.
enum class CliSense { clockwise = 0, counterclockwise = 1 };

/// A straight track.
using CliHatch = std::pair<Vec2, Vec2>;

/// Commands of a CLI file, in one of its two forms. Lengths in mm.
class CliCommands {
 public:
  virtual ~CliCommands() = default;
  /// What the header calls the form.
  [[nodiscard]] virtual const char* keyword() const = 0;
  /// What stands between the header's end and the first command, and behind the last one.
  [[nodiscard]] virtual const char* before() const = 0;
  [[nodiscard]] virtual const char* behind() const = 0;
  /// Upper surface of the layer that follows.
  virtual void append_layer(double z, std::string& out) const = 0;
  /// A closed polygon; its first point is repeated.
  virtual void append_polyline(int label, CliSense sense, std::span<const Vec2> points, std::string& out) const = 0;
  virtual void append_hatches(int label, std::span<const CliHatch> hatches, std::string& out) const = 0;
};

[[nodiscard]] std::unique_ptr<const CliCommands> make_ascii_cli_commands();
/// Long commands throughout: the short ones hold neither negative coordinates nor more than 65535 points.
[[nodiscard]] std::unique_ptr<const CliCommands> make_binary_cli_commands();

/// Appends a length as the format wants a REAL: with a decimal point.
void append_cli_real(std::string& out, double length);

}  // namespace lamella
