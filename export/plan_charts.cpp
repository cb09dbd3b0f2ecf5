#include "export/plan_charts.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/xml.h"
#include "export/tick_step.h"
#include "materials/color.h"

namespace lamella {

namespace {

// Sizes in units of the drawing, which scales with the page.
constexpr double kWidth = 960.0;
constexpr double kLeft = 110.0;
constexpr double kRight = 14.0;
constexpr double kTop = 12.0;
constexpr double kBottom = 44.0;
constexpr std::size_t kColumns = 400;
constexpr double kTicks = 5.0;

class Chart {
 public:
  Chart(const BuildPlan& plan, double height, double top_value, const std::string& label)
      : height_(height), top_(top_value > 0.0 ? top_value : 1.0) {
    z_low_ = plan.layers.empty() ? 0.0 : plan.layers.front().z_bottom;
    z_high_ = plan.layers.empty() ? 1.0 : plan.layers.back().z_top;
    svg_ =
        fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, height_, xml_escape(label));
  }

  [[nodiscard]] double x(double z) const {
    return kLeft + (z - z_low_) / (z_high_ - z_low_) * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double y(double value) const { return bottom() - value / top_ * (bottom() - kTop); }
  [[nodiscard]] double bottom() const { return height_ - kBottom; }

  void add(const std::string& text) { svg_ += text + "\n"; }

  void axis_z() {
    const double step = tick_step(z_high_ - z_low_, kTicks);
    for (double z = std::ceil(z_low_ / step - 1e-9) * step; z <= z_high_ + 1e-9 * step; z += step) {
      add(fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>", x(z), kTop,
                      bottom()));
      add(fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{:.6g}</text>", x(z), bottom() + 16.0,
                      std::abs(z) < 1e-9 * step ? 0.0 : z));
    }
    add(fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">height z in mm</text>",
                    0.5 * (kLeft + kWidth - kRight), bottom() + 36.0));
  }

  void axis_value(const std::string& label) {
    const double step = tick_step(top_, kTicks);
    for (double value = 0.0; value <= top_ * (1.0 + 1e-9); value += step) {
      add(fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>", kLeft,
                      kWidth - kRight, y(value)));
      add(fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{:.6g}</text>", kLeft - 8.0, y(value) + 4.0,
                      value));
    }
    add(fmt::format("<text transform=\"translate(20 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
                    0.5 * (kTop + bottom()), xml_escape(label)));
  }

  [[nodiscard]] std::string finish() { return svg_ + "</svg>\n"; }

 private:
  double height_;
  double top_;
  double z_low_ = 0.0;
  double z_high_ = 1.0;
  std::string svg_;
};

/// Layers [first, last) that share a column.
struct Column {
  std::size_t first = 0;
  std::size_t last = 0;
};

std::vector<Column> columns_of(const BuildPlan& plan) {
  const std::size_t count = std::min(kColumns, plan.layers.size());
  std::vector<Column> columns;
  for (std::size_t c = 0; c < count; ++c) {
    columns.push_back({c * plan.layers.size() / count, (c + 1) * plan.layers.size() / count});
  }
  return columns;
}

/// The largest value of a column's layers.
template <class Value>
std::vector<double> sample(const BuildPlan& plan, const std::vector<Column>& columns, const Value& value) {
  std::vector<double> samples;
  for (const Column& column : columns) {
    double most = 0.0;
    for (std::size_t k = column.first; k < column.last; ++k) most = std::max(most, value(plan.layers[k]));
    samples.push_back(most);
  }
  return samples;
}

double area_of(const PlanLayer& layer, MaterialId material) {
  for (const PlanStep& step : layer.steps) {
    if (step.material == material) return step.statistics.area;
  }
  return 0.0;
}

/// A line of steps, one a column.
std::string step_path(const Chart& chart, const BuildPlan& plan, const std::vector<Column>& columns,
                      const std::vector<double>& samples) {
  std::string path;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double from = chart.x(plan.layers[columns[c].first].z_bottom);
    const double to = chart.x(plan.layers[columns[c].last - 1].z_top);
    path += fmt::format("{}{:.1f} {:.1f}H{:.1f}", c == 0 ? "M" : "L", from, chart.y(samples[c]), to);
  }
  return path;
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 0.0 : *std::max_element(values.begin(), values.end());
}

}  // namespace

std::string area_chart(const BuildPlan& plan) {
  const std::vector<Column> columns = columns_of(plan);
  std::vector<std::vector<double>> samples;
  double top = 0.0;
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    samples.push_back(sample(plan, columns, [m](const PlanLayer& layer) { return area_of(layer, MaterialId{m}); }));
    top = std::max(top, largest(samples.back()));
  }
  Chart chart(plan, 320.0, top, "area of each material over the height");
  chart.axis_z();
  chart.axis_value("area in mm\u00b2");
  for (std::size_t m = 0; m < plan.materials.size(); ++m) {
    if (plan.materials[m].tools.empty()) continue;
    const std::string path = step_path(chart, plan, columns, samples[m]);
    chart.add(fmt::format("<path class=\"halo\" d=\"{}\"/>", path));
    chart.add(fmt::format("<path class=\"line\" stroke=\"{}\" d=\"{}\"><title>{}</title></path>",
                          format_color(plan.materials[m].color), path, xml_escape(plan.materials[m].name)));
  }
  return chart.finish();
}

std::string time_chart(const BuildPlan& plan) {
  const std::vector<Column> columns = columns_of(plan);
  const auto all = sample(plan, columns, [](const PlanLayer& layer) { return layer.time; });
  const auto laying = sample(plan, columns, [](const PlanLayer& layer) {
    double time = 0.0;
    for (const PlanStep& step : layer.steps) time += step.time;
    return time;
  });
  Chart chart(plan, 260.0, largest(all), "time of each layer over the height");
  chart.axis_z();
  chart.axis_value("time per layer in s");
  const auto area = [&](const std::vector<double>& samples, const char* name, const char* title) {
    if (columns.empty()) return;
    const double from = chart.x(plan.layers.front().z_bottom);
    const double to = chart.x(plan.layers.back().z_top);
    chart.add(fmt::format("<path class=\"{}\" d=\"{}L{:.1f} {:.1f}H{:.1f}Z\"><title>{}</title></path>", name,
                          step_path(chart, plan, columns, samples), to, chart.bottom(), from, title));
  };
  area(all, "rest", "changes, reloads and overhead");
  area(laying, "laying", "laying material down");
  return chart.finish();
}

std::string tool_chart(const BuildPlan& plan) {
  constexpr double kRow = 30.0;
  const auto tools = static_cast<double>(plan.tools.size());
  Chart chart(plan, kTop + tools * kRow + kBottom, 1.0, "material of each tool over the height");
  chart.axis_z();
  const std::vector<Column> columns = columns_of(plan);
  for (std::size_t t = 0; t < plan.tools.size(); ++t) {
    const double y = kTop + static_cast<double>(t) * kRow;
    chart.add(fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 8.0, y + 19.0,
                          xml_escape(plan.tools[t])));
    for (std::size_t c = 0; c < columns.size();) {
      // The tool's material in the column, and how far the same goes on.
      const auto material_in = [&](const Column& column) {
        for (std::size_t k = column.first; k < column.last; ++k) {
          for (const PlanStep& step : plan.layers[k].steps) {
            if (step.tool == ToolId{t}) return step.material;
          }
        }
        return MaterialId{};
      };
      const MaterialId material = material_in(columns[c]);
      std::size_t end = c + 1;
      while (end < columns.size() && material_in(columns[end]) == material) ++end;
      if (material.valid()) {
        const double from = chart.x(plan.layers[columns[c].first].z_bottom);
        const double to = chart.x(plan.layers[columns[end - 1].last - 1].z_top);
        const PlanMaterial& held = plan.materials[material.value()];
        chart.add(
            fmt::format("<rect class=\"use\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" "
                        "fill=\"{}\"><title>{}: {}</title></rect>",
                        from, y + 4.0, std::max(to - from, 0.5), kRow - 8.0, format_color(held.color),
                        xml_escape(plan.tools[t]), xml_escape(held.name)));
      }
      c = end;
    }
    for (const PlanLayer& layer : plan.layers) {
      for (const PlanStep& step : layer.steps) {
        if (!step.is_reload || step.tool != ToolId{t}) continue;
        chart.add(fmt::format(
            "<path class=\"reload\" d=\"M{0:.1f} {1:.1f}v{2:.1f}\"><title>reload with {3}</title></path>",
            chart.x(layer.z_bottom), y + 1.0, kRow - 2.0, xml_escape(plan.materials[step.material.value()].name)));
      }
    }
  }
  return chart.finish();
}

}  // namespace lamella
