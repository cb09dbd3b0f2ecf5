#include "export/gcode_sink.h"

#include <algorithm>
#include <fmt/format.h>

#include "core/error.h"
#include "export/build_check.h"
#include "export/gcode_part.h"
#include "export/gcode_words.h"
#include "export/gcode_writer.h"
#include "export/output_file.h"
#include "slicing/plan/track_order.h"

namespace lamella {

namespace {

class GcodeSink final : public LayerSink {
 public:
  GcodeSink(std::filesystem::path file, GcodeOptions options) : path_(std::move(file)), options_(std::move(options)) {}

  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
    check_machine();
    check_plan();
    place();
    file_.emplace(path_);
    writer_.emplace(file_->stream(), options_.machine);
    write_header();
    writer_->write_start();
  }

  void write(const Layer& layer) override {
    check_layer(layer, info_);
    const PlanLayer& plan = plan_of(layer);
    check_tracks(layer, plan);
    if (plan.steps.empty() || !layer.hatch) return;
    file_->stream() << fmt::format(";LAYER_CHANGE\n;LAYER:{}\n;Z:{:.4f}\n;HEIGHT:{:.4f}\n", layer.index,
                                   layer.z_top + offset_.z(), layer.z_top - layer.z_bottom);
    writer_->move_up(layer.z_top + offset_.z());
    for (const PlanStep& step : plan.steps) write_step(layer, step);
    file_->check();
  }

  void finish(const SliceReport&) override {
    writer_->write_end();
    file_->commit();
  }

 private:
  void check_machine() const {
    if (!info_.plan.hatch) {
      throw UsageError("gcode needs hatch rows, and the build has none", {}, "slice with --hatch-spacing");
    }
    if (!options_.machine.gcode) {
      throw InputError("the machine takes no G-code", options_.machine.source, "add a <gcode flavor=\"...\"/>");
    }
    for (const MachineTool& tool : options_.machine.tools) {
      if (tool.speed <= 0.0 || tool.travel <= 0.0) {
        throw InputError("the tool '" + tool.name + "' has no speed", options_.machine.source, "give speed and travel");
      }
    }
  }

  /// The plan is of this build and this machine.
  void check_plan() const {
    const BuildPlan& plan = options_.plan;
    const auto refuse = [](const std::string& what) {
      throw InputError("the plan is of another " + what, {}, "make it again with lamella plan");
    };
    std::vector<std::string> tools;
    for (const MachineTool& tool : options_.machine.tools) tools.push_back(tool.name);
    if (plan.machine != options_.machine.name || plan.tools != tools) refuse("machine: " + plan.machine);
    if (plan.layers.size() != info_.plan.layers.size()) refuse("build: its number of layers differs");
    bool same = plan.materials.size() == info_.materials.size() && plan.by_hatch;
    for (std::size_t m = 0; same && m < plan.materials.size(); ++m) {
      same = plan.materials[m].name == info_.materials[MaterialId{m}].name;
    }
    if (!same) refuse("build: its materials or its lattice differ");
    for (std::size_t k = 0; k < plan.layers.size(); ++k) {
      const LayerSpan& span = info_.plan.layers[k];
      if (plan.layers[k].index != k || plan.layers[k].z_top != span.z_top || plan.layers[k].z_bottom != span.z_bottom) {
        refuse("build: its layers differ");
      }
    }
  }

  /// Where the part stands on the machine: as it is when it lies within the volume, else in the middle of the plate.
  void place() {
    Box3 box;
    for (const BuildSolid& solid : info_.solids) {
      if (!solid.bounds.isEmpty()) box.extend(solid.bounds);
    }
    if (box.isEmpty()) return;
    // Layers may overhang the part's top.
    box.extend(Vec3(box.min().x(), box.min().y(), info_.plan.layers.front().z_bottom));
    box.extend(Vec3(box.max().x(), box.max().y(), info_.plan.layers.back().z_top));
    const Vec3& volume = options_.machine.volume;
    if ((box.sizes().array() > volume.array()).any()) {
      throw InputError("the part is larger than the machine's build volume", options_.machine.source,
                       "turn the part or choose a larger machine");
    }
    const bool lies_within = (box.min().array() >= 0.0).all() && (box.max().array() <= volume.array()).all();
    if (lies_within) return;
    const Vec3 middle = 0.5 * volume - box.center();
    offset_ = Vec3(middle.x(), middle.y(), -box.min().z());
  }

  void write_header() {
    const BuildPlan& plan = options_.plan;
    std::ostream& out = file_->stream();
    out << "; Lamella, raster G-code for " << gcode::name_of(options_.machine.gcode->flavor) << "\n";
    out << "; machine: " << gcode::plain(plan.machine) << "\n";
    const GcodePart part = part_of(plan, info_.given);
    out << fmt::format("; layers: {}\n", part.layers.last - part.layers.first);
    if (!part.is_whole) write_range(part.layers);
    out << fmt::format("; time: {:.1f} s\n; tool changes: {}\n; manual changes: {}\n", part.time, part.tool_changes,
                       part.reloads);
    out << fmt::format("; hatch spacing: {:.6g} mm, {}\n", info_.plan.hatch->spacing,
                       options_.machine.gcode->serpentine ? "serpentine" : "one-way");
    out << fmt::format("; offset of the part: X{:.4f} Y{:.4f} Z{:.4f} mm\n", offset_.x(), offset_.y(), offset_.z());
    out << fmt::format(
        "; tracks end where the part ends; what they come out wider ({:.6g} mm a side) and shrinkage "
        "aren't made up for\n",
        options_.machine.width_compensation);
    for (const PlanMaterial& material : part.materials) {
      if (material.tools.empty()) continue;
      std::string tools;
      for (const ToolId tool : material.tools) tools += fmt::format(" T{}", tool.value());
      out << fmt::format("; material: {}, tools{}, tracks {:.4f} mm, volume {:.4f} mm^3, mass {}\n",
                         gcode::plain(material.name), tools, material.length, material.volume,
                         material.mass ? fmt::format("{:.4f} g", *material.mass) : "unknown");
    }
  }

  /// That the file isn't all of the build, and what it stands on.
  void write_range(LayerRange layers) {
    std::ostream& out = file_->stream();
    out << fmt::format("; of the build's {} layers only {} to {}: time, changes, tracks, volume and mass are theirs\n",
                       info_.plan.layers.size(), layers.first, layers.last - 1);
    if (layers.first == 0) return;
    out << fmt::format(
        "; WARNING: begins at Z{:.4f}, on top of layer {}: without the layers below, it is laid into the air\n",
        info_.plan.layers[layers.first].z_bottom + offset_.z(), layers.first - 1);
  }

  /// The plan knows of every segment: nothing of a layer may be left out because the plan is of another cut.
  void check_tracks(const Layer& layer, const PlanLayer& plan) const {
    std::vector<std::uint64_t> segments(info_.materials.size());
    if (layer.hatch) {
      for (const Segment& segment : layer.hatch->rows.segments) ++segments[segment.material.value()];
    }
    for (const PlanStep& step : plan.steps) segments[step.material.value()] -= step.statistics.segments;
    for (const std::uint64_t left : segments) {
      if (left == 0) continue;
      throw InputError("the plan is of another build: the segments of layer " + std::to_string(layer.index) + " differ",
                       {}, "make it again with lamella plan");
    }
  }

  const PlanLayer& plan_of(const Layer& layer) const { return options_.plan.layers.at(layer.index); }

  void write_step(const Layer& layer, const PlanStep& step) {
    const Material& material = info_.materials[step.material];
    file_->stream() << ";TYPE:Solid infill\n";
    writer_->comment(fmt::format("material: {}", material.name));
    if (step.is_reload) writer_->reload(step.tool, material.name);
    writer_->use_tool(step.tool, options_.machine.settings_of(material.name), step.purge);
    const HatchAxes axes = hatch_axes(*info_.plan.hatch, layer.index);
    const double section = layer.hatch->spacing * (layer.z_top - layer.z_bottom);
    const auto point = [&](std::size_t row, double x) -> Vec2 {
      const double across =
          (static_cast<double>(layer.hatch->first_row + static_cast<std::int64_t>(row)) + 0.5) * layer.hatch->spacing;
      return x * axes.along + across * axes.across + offset_.head<2>();
    };
    visit_tracks(layer.hatch->rows, step.material, options_.machine.gcode->serpentine,
                 [&](std::size_t row, double from, double to) {
                   writer_->track(point(row, from), point(row, to), std::abs(to - from) * section);
                 });
  }

  std::filesystem::path path_;
  GcodeOptions options_;
  BuildInfo info_;
  Vec3 offset_ = Vec3::Zero();
  std::optional<OutputFile> file_;
  std::optional<GcodeWriter> writer_;
};

}  // namespace

std::unique_ptr<LayerSink> make_gcode_sink(const std::filesystem::path& file, GcodeOptions options) {
  return std::make_unique<GcodeSink>(file, std::move(options));
}

}  // namespace lamella
