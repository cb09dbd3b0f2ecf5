#include "export/cli_commands.h"

#include <cstdint>

#include "export/byte_order.h"
#include "export/decimal.h"

namespace lamella {

namespace {

void append_point(std::string& out, const Vec2& point) {
  out += ',';
  append_cli_real(out, point.x());
  out += ',';
  append_cli_real(out, point.y());
}

class AsciiCommands final : public CliCommands {
 public:
  [[nodiscard]] const char* keyword() const override { return "$$ASCII"; }
  [[nodiscard]] const char* before() const override { return "\n$$GEOMETRYSTART\n"; }
  [[nodiscard]] const char* behind() const override { return "$$GEOMETRYEND\n"; }

  void append_layer(double z, std::string& out) const override {
    out += "$$LAYER/";
    append_cli_real(out, z);
    out += '\n';
  }

  void append_polyline(int label, CliSense sense, std::span<const Vec2> points, std::string& out) const override {
    out += "$$POLYLINE/" + std::to_string(label) + ',' + std::to_string(static_cast<int>(sense)) + ',' +
           std::to_string(points.size() + 1);
    for (const Vec2& point : points) append_point(out, point);
    append_point(out, points.front());
    out += '\n';
  }

  void append_hatches(int label, std::span<const CliHatch> hatches, std::string& out) const override {
    out += "$$HATCHES/" + std::to_string(label) + ',' + std::to_string(hatches.size());
    for (const auto& [from, to] : hatches) {
      append_point(out, from);
      append_point(out, to);
    }
    out += '\n';
  }
};

/// Command indices; every one is 16 bits, as the format has it.
constexpr std::uint16_t kLayerLong = 127;
constexpr std::uint16_t kPolylineLong = 130;
constexpr std::uint16_t kHatchesLong = 132;

void append_floats(std::string& out, const Vec2& point) {
  append_little_endian(out, static_cast<float>(point.x()));
  append_little_endian(out, static_cast<float>(point.y()));
}

class BinaryCommands final : public CliCommands {
 public:
  [[nodiscard]] const char* keyword() const override { return "$$BINARY"; }
  [[nodiscard]] const char* before() const override { return ""; }
  [[nodiscard]] const char* behind() const override { return ""; }

  void append_layer(double z, std::string& out) const override {
    append_little_endian(out, kLayerLong);
    append_little_endian(out, static_cast<float>(z));
  }

  void append_polyline(int label, CliSense sense, std::span<const Vec2> points, std::string& out) const override {
    append_little_endian(out, kPolylineLong);
    append_little_endian(out, static_cast<std::int32_t>(label));
    append_little_endian(out, static_cast<std::int32_t>(sense));
    append_little_endian(out, static_cast<std::int32_t>(points.size() + 1));
    for (const Vec2& point : points) append_floats(out, point);
    append_floats(out, points.front());
  }

  void append_hatches(int label, std::span<const CliHatch> hatches, std::string& out) const override {
    append_little_endian(out, kHatchesLong);
    append_little_endian(out, static_cast<std::int32_t>(label));
    append_little_endian(out, static_cast<std::int32_t>(hatches.size()));
    for (const auto& [from, to] : hatches) {
      append_floats(out, from);
      append_floats(out, to);
    }
  }
};

}  // namespace

std::unique_ptr<const CliCommands> make_ascii_cli_commands() { return std::make_unique<AsciiCommands>(); }
std::unique_ptr<const CliCommands> make_binary_cli_commands() { return std::make_unique<BinaryCommands>(); }

void append_cli_real(std::string& out, double length) {
  const std::size_t begin = out.size();
  append_decimal(out, length);
  if (out.find('.', begin) == std::string::npos) out += ".0";
}

}  // namespace lamella
