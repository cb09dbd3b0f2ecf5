#include "export/svg_sink.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <sstream>
#include <string>
#include <utility>

#include "core/xml.h"
#include "core/xml_writer.h"
#include "export/build_check.h"
#include "export/decimal.h"
#include "export/image_folder.h"
#include "export/material_contours.h"

namespace lamella {

namespace {

constexpr std::string_view kSvgNamespace = "http://www.w3.org/2000/svg";
constexpr std::string_view kSlicerNamespace = "http://slic3r.org/namespaces/slic3r";

std::string decimal(double length) {
  std::string text;
  append_decimal(text, length);
  return text;
}

std::string colour_of(const Color& color) {
  std::string text = "#";
  for (const double channel : color) text += fmt::format("{:02x}", std::lround(std::clamp(channel, 0.0, 1.0) * 255.0));
  return text;
}

class SvgSink final : public LayerSink {
 public:
  explicit SvgSink(std::filesystem::path folder) : folder_(std::move(folder), {.extension = ".svg"}) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    combiner_.emplace(info, "svg");
    info_ = info;
    const Grid& grid = info.plan.grid;
    left_ = grid.origin.x();
    width_ = grid.pitch.x() * static_cast<double>(grid.size[0]);
    height_ = grid.pitch.y() * static_cast<double>(grid.size[1]);
    top_ = grid.origin.y() + height_;
    folder_.open(info);
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    folder_.write_image(layer.index, 0, picture_of(layer));
    return [this, &layer] { folder_.add_layer(layer.index, info_.plan.layers[layer.index]); };
  }

  void finish(const SliceReport&) override { folder_.close(); }
  void abandon() noexcept override { folder_.abandon(); }

 private:
  [[nodiscard]] std::string picture_of(const Layer& layer) const {
    std::ostringstream text;
    XmlWriter xml(text);
    xml.start("svg").attribute("xmlns", kSvgNamespace).attribute("xmlns:slic3r", kSlicerNamespace);
    xml.attribute("version", "1.1").attribute("width", decimal(width_) + "mm");
    xml.attribute("height", decimal(height_) + "mm");
    xml.attribute("viewBox", "0 0 " + decimal(width_) + " " + decimal(height_));
    xml.start("desc").text(fmt::format("Layer {}. Machine x = {} + x, machine y = {} - y, mm.", layer.index,
                                       format_double(left_), format_double(top_)));
    xml.end();
    xml.start("g").attribute("id", fmt::format("layer{}", layer.index));
    xml.attribute("slic3r:z", decimal(layer.z_top)).attribute("slic3r:slice-z", decimal(layer.z_sample));
    xml.attribute("slic3r:layer-height", decimal(layer.z_top - layer.z_bottom));
    xml.attribute("fill-rule", "evenodd").attribute("stroke", "none");
    const MaterialContours contours = combiner_->combine(*layer.contours);
    for (const MaterialId material : contours.ids()) {
      if (!contours[material].empty()) write_material(xml, material, contours[material]);
    }
    xml.end().end();
    return std::move(text).str();
  }

  void write_material(XmlWriter& xml, MaterialId id, const std::vector<MaterialLoop>& loops) const {
    const Material& material = info_.materials[id];
    xml.start("g").attribute("id", fmt::format("material{}", id.value()));
    xml.attribute("fill", colour_of(material.color));
    xml.start("title").text(material.name).end();
    for (std::size_t begin = 0, end = 1; begin < loops.size(); begin = end++) {
      while (end < loops.size() && loops[end].parent >= 0) ++end;
      std::string data;
      for (std::size_t i = begin; i < end; ++i) append_loop(loops[i], data);
      xml.start("path").attribute("slic3r:type", "contour").attribute("d", data).end();
    }
    xml.end();
  }

  void append_loop(const MaterialLoop& loop, std::string& out) const {
    const char* command = out.empty() ? "M" : " M";
    for (const Vec2& point : loop.points) {
      out += std::exchange(command, " L");
      append_decimal(out, point.x() - left_);
      out += ' ';
      append_decimal(out, top_ - point.y());
    }
    out += " Z";
  }

  ImageFolder folder_;
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  double left_ = 0.0;  ///< mm: the corner of the picture, on the machine
  double top_ = 0.0;
  double width_ = 0.0;
  double height_ = 0.0;
};

}  // namespace

std::unique_ptr<LayerSink> make_svg_sink(const std::filesystem::path& folder) {
  return std::make_unique<SvgSink>(folder);
}

}  // namespace lamella
