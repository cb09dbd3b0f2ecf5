#include "export/gcode_part.h"

#include <algorithm>

#include "slicing/compensated_sum.h"

namespace lamella {

namespace {

/// Adds up the layers of a range.
class PartSums {
 public:
  explicit PartSums(const BuildPlan& plan) : plan_(plan), volume_(plan.materials.size()), length_(volume_.size()) {
    part_.is_whole = false;
    for (const PlanMaterial& material : plan.materials) {
      part_.materials.emplace_back().name = material.name;
    }
  }

  void add(const PlanLayer& layer) {
    time_.add(layer.time);
    for (const PlanStep& step : layer.steps) add(step);
  }

  [[nodiscard]] GcodePart finish(LayerRange range) {
    part_.layers = range;
    part_.time = time_.value();
    for (std::size_t m = 0; m < part_.materials.size(); ++m) {
      PlanMaterial& material = part_.materials[m];
      material.volume = volume_[m].value();
      material.length = length_[m].value();
      const auto& density = plan_.materials[m].density;
      if (density) material.mass = material.volume * *density * 1e-3;  // mm^3 g/cm^3 = mg
    }
    return std::move(part_);
  }

 private:
  void add(const PlanStep& step) {
    const std::size_t m = step.material.value();
    if (is_begun_ && step.is_change) ++part_.tool_changes;
    if (!is_begun_) time_.add(-step.change_time);
    is_begun_ = true;
    if (step.is_reload) ++part_.reloads;
    std::vector<ToolId>& tools = part_.materials[m].tools;
    if (std::find(tools.begin(), tools.end(), step.tool) == tools.end()) tools.push_back(step.tool);
    volume_[m].add(step.volume);
    length_[m].add(step.statistics.length);
  }

  const BuildPlan& plan_;
  GcodePart part_;
  bool is_begun_ = false;
  CompensatedSum time_;
  std::vector<CompensatedSum> volume_;
  std::vector<CompensatedSum> length_;
};

}  // namespace

GcodePart part_of(const BuildPlan& plan, LayerRange range) {
  const auto count = static_cast<std::uint32_t>(plan.layers.size());
  range.last = std::min(range.last, count);
  range.first = std::min(range.first, range.last);
  if (range.first == 0 && range.last == count) {
    return {range, true, plan.time, plan.tool_changes, plan.reloads, plan.materials};
  }
  PartSums sums(plan);
  for (std::uint32_t k = range.first; k < range.last; ++k) sums.add(plan.layers[k]);
  return sums.finish(range);
}

}  // namespace lamella
