#include "export/cli_sink.h"

#include <array>
#include <fmt/format.h>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.h"
#include "export/build_check.h"
#include "export/cli_commands.h"
#include "export/material_contours.h"
#include "export/output_file.h"
#include "export/row_tracks.h"

namespace lamella {

namespace {

/// Labels count from 1, in the order of materials.
int label_of(MaterialId material) { return static_cast<int>(material.value()) + 1; }

/// The header is ASCII; a label is quoted, and `//` would begin a comment.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name) text += c < ' ' || c > '~' || c == '"' || c == '/' || c == '$' ? '_' : c;
  return text;
}

/// What is known of a file only at its end, as wide as it will ever be.
std::string totals_text(std::size_t layers, const Box3& box) {
  const Vec3 low = box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.min());
  const Vec3 high = box.isEmpty() ? Vec3(Vec3::Zero()) : Vec3(box.max());
  return fmt::format("$$DIMENSION/{:018.6f},{:018.6f},{:018.6f},{:018.6f},{:018.6f},{:018.6f}\n$$LAYERS/{:08}\n",
                     low.x(), low.y(), low.z(), high.x(), high.y(), high.z(), layers);
}

class CliSink final : public LayerSink {
 public:
  CliSink(std::filesystem::path file, std::unique_ptr<const CliCommands> commands)
      : path_(std::move(file)), commands_(std::move(commands)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    if (info.plan.chord_error) combiner_.emplace(info, "cli");
    info_ = info;
    file_.emplace(path_);
    std::ostream& out = file_->stream();
    out << "$$HEADERSTART\n" << commands_->keyword() << "\n$$UNITS/1.0\n$$VERSION/200\n";
    for (const MaterialId material : info.materials.ids()) {
      out << "$$LABEL/" << label_of(material) << ",\"" << plain(info.materials[material].name) << "\"\n";
    }
    totals_at_ = out.tellp();
    out << totals_text(0, {}) << "$$HEADEREND" << commands_->before();
  }

  void write(const Layer& layer) override { prepare(layer)(); }

  [[nodiscard]] std::function<void()> prepare(const Layer& layer) override {
    check_layer(layer, info_);
    Box2 box;
    std::string text;
    commands_->append_layer(layer.z_top, text);
    append_contours(layer, box, text);
    append_hatches(layer, box, text);
    return [this, &layer, box, text = std::move(text)] { add(layer, box, text); };
  }

  void finish(const SliceReport&) override {
    std::ostream& out = file_->stream();
    out << commands_->behind();
    out.seekp(totals_at_);
    out << totals_text(layers_, box_);
    file_->commit();
  }

 private:
  void append_contours(const Layer& layer, Box2& box, std::string& text) const {
    if (!combiner_) return;
    const MaterialContours contours = combiner_->combine(*layer.contours);
    for (const MaterialId material : contours.ids()) {
      for (const MaterialLoop& loop : contours[material]) {
        for (const Vec2& point : loop.points) box.extend(point);
        const CliSense sense = loop.parent < 0 ? CliSense::counterclockwise : CliSense::clockwise;
        commands_->append_polyline(label_of(material), sense, loop.points, text);
      }
    }
  }

  void append_hatches(const Layer& layer, Box2& box, std::string& text) const {
    std::vector<std::vector<CliHatch>> hatches(info_.materials.size());
    visit_tracks(layer, info_.plan, [&](MaterialId material, const Vec2& from, const Vec2& to) {
      hatches[material.value()].emplace_back(from, to);
      box.extend(from).extend(to);
    });
    for (const MaterialId material : info_.materials.ids()) {
      const auto& of_material = hatches[material.value()];
      if (!of_material.empty()) commands_->append_hatches(label_of(material), of_material, text);
    }
  }

  /// The first layer's thickness is said by an empty layer before it.
  void add(const Layer& layer, const Box2& box, const std::string& text) {
    if (layers_ == 0) {
      std::string zero;
      commands_->append_layer(layer.z_bottom, zero);
      file_->stream() << zero;
      ++layers_;
    }
    file_->stream() << text;
    file_->check();
    ++layers_;
    if (box.isEmpty()) return;
    box_.extend(Vec3(box.min().x(), box.min().y(), layer.z_bottom));
    box_.extend(Vec3(box.max().x(), box.max().y(), layer.z_top));
  }

  std::filesystem::path path_;
  std::unique_ptr<const CliCommands> commands_;
  BuildInfo info_;
  std::optional<ContourCombiner> combiner_;
  std::optional<OutputFile> file_;
  std::streampos totals_at_ = 0;
  std::size_t layers_ = 0;
  Box3 box_;
};

}  // namespace

std::unique_ptr<LayerSink> make_cli_sink(const std::filesystem::path& file) {
  return std::make_unique<CliSink>(file, make_ascii_cli_commands());
}

std::unique_ptr<LayerSink> make_binary_cli_sink(const std::filesystem::path& file) {
  return std::make_unique<CliSink>(file, make_binary_cli_commands());
}

}  // namespace lamella
