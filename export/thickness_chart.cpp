#include "export/thickness_chart.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/error.h"
#include "core/xml.h"
#include "export/tick_step.h"

namespace lamella {

namespace {

// In units of the drawing, which scales with the page.
constexpr double kWidth = 720.0;
constexpr double kHeight = 760.0;
constexpr double kTop = 64.0;
constexpr double kBottom = 62.0;
constexpr double kPanel = 270.0;             // width of each panel
constexpr double kPanels[] = {84.0, 420.0};  // left sides

constexpr const char* kStyle =
    "text{font:13px sans-serif;fill:#222}.title{font-size:16px}.grid{stroke:#ddd}.frame{fill:none;stroke:#888}"
    ".flat{stroke:#2a9d5c;stroke-width:0.8}.missed{stroke:#c0392b;stroke-width:1.4}"
    ".thickness{fill:#b9d3ee;stroke:#1f5fa8;stroke-width:0.6}.deviation{fill:#f3d3b0;stroke:#b5651d;stroke-width:0.6}"
    ".limit{stroke:#c0392b;stroke-width:1.5;stroke-dasharray:6 4}";

class Drawing {
 public:
  explicit Drawing(const ThicknessChart& chart) : chart_(chart) {
    text_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" role=\"img\">\n"
        "<style>{2}</style>\n<rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n"
        "<text class=\"title\" x=\"{3}\" y=\"26\">{4}</text>\n",
        kWidth, kHeight, kStyle, kPanels[0], xml_escape(chart.title));
  }

  [[nodiscard]] double y(double z) const {
    const double low = chart_.borders.front();
    const double high = chart_.borders.back();
    return kHeight - kBottom - (z - low) / (high - low) * (kHeight - kTop - kBottom);
  }

  void frame(double left, double top_value, const std::string& label) {
    const double low = chart_.borders.front();
    const double high = chart_.borders.back();
    const double step = tick_step(high - low, 8.0);
    for (double z = std::ceil(low / step - 1e-9) * step; z <= high + 1e-9 * step; z += step) {
      text_ += fmt::format(
          "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>"
          "<text x=\"{3:.1f}\" y=\"{4:.1f}\" text-anchor=\"end\">{5:.6g}</text>\n",
          left, left + kPanel, y(z), left - 6.0, y(z) + 4.5, std::abs(z) < 1e-9 * step ? 0.0 : z);
    }
    const double across = tick_step(top_value, 5.0);
    for (double value = 0.0; value <= top_value * (1.0 + 1e-9); value += across) {
      const double x = left + value / top_value * kPanel;
      text_ += fmt::format(
          "<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>"
          "<text x=\"{0:.1f}\" y=\"{3:.1f}\" text-anchor=\"middle\">{4:.4g}</text>\n",
          x, kTop, kHeight - kBottom, kHeight - kBottom + 18.0, value);
    }
    text_ += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", left + 0.5 * kPanel,
                         kHeight - kBottom + 40.0, xml_escape(label));
  }

  /// A bar for each layer, as high as the layer.
  void bars(double left, double top_value, const std::vector<double>& values, const char* name) {
    std::string path = fmt::format("M{:.1f} {:.2f}", left, y(chart_.borders.front()));
    for (std::size_t k = 0; k < values.size(); ++k) {
      path +=
          fmt::format("H{:.2f}V{:.2f}", left + std::min(1.0, values[k] / top_value) * kPanel, y(chart_.borders[k + 1]));
    }
    text_ += fmt::format("<path class=\"{}\" d=\"{}H{:.1f}Z\"/>\n", name, path, left);
  }

  void limit(double left, double top_value, double value) {
    text_ += fmt::format("<line class=\"limit\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>\n",
                         left + value / top_value * kPanel, kTop, kHeight - kBottom);
  }

  void marks(double left, const std::vector<double>& heights, const char* name) {
    for (const double z : heights) {
      text_ += fmt::format("<line class=\"{0}\" x1=\"{1:.1f}\" x2=\"{2:.1f}\" y1=\"{3:.2f}\" y2=\"{3:.2f}\"/>\n", name,
                           left, left + kPanel, y(z));
    }
  }

  void close(double left) {
    text_ += fmt::format("<rect class=\"frame\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", left,
                         kTop, kPanel, kHeight - kTop - kBottom);
  }

  void legend() {
    text_ += fmt::format(
        "<text transform=\"translate(22 {:.1f}) rotate(-90)\" text-anchor=\"middle\">height z in mm</text>\n"
        "<text x=\"{:.1f}\" y=\"50\">flat features: green lines are met{}</text>\n",
        0.5 * (kTop + kHeight - kBottom), kPanels[0], chart_.missed.empty() ? "" : ", red ones aren't");
  }

  [[nodiscard]] std::string finish() { return text_ + "</svg>\n"; }

 private:
  const ThicknessChart& chart_;
  std::string text_;
};

}  // namespace

std::string draw_thickness(const ThicknessChart& chart) {
  if (chart.deviations.empty() || chart.borders.size() != chart.deviations.size() + 1) {
    throw UsageError("a chart of thicknesses needs layers and a deviation for each");
  }
  std::vector<double> thicknesses;
  double thickest = 0.0;
  for (std::size_t k = 0; k + 1 < chart.borders.size(); ++k) {
    thicknesses.push_back(chart.borders[k + 1] - chart.borders[k]);
    thickest = std::max(thickest, thicknesses.back());
  }
  const double widest = 1.08 * std::max(thickest, chart.range.lo);
  const double deviates =
      1.2 * std::max(chart.tolerance, *std::max_element(chart.deviations.begin(), chart.deviations.end()));
  Drawing drawing(chart);
  drawing.frame(kPanels[0], widest, "thickness of layers in mm");
  drawing.bars(kPanels[0], widest, thicknesses, "thickness");
  drawing.frame(kPanels[1], deviates, "bound of the deviation in mm");
  drawing.bars(kPanels[1], deviates, chart.deviations, "deviation");
  drawing.limit(kPanels[1], deviates, chart.tolerance);
  for (const double left : kPanels) {
    drawing.marks(left, chart.features, "flat");
    drawing.marks(left, chart.missed, "missed");
    drawing.close(left);
  }
  drawing.legend();
  return drawing.finish();
}

}  // namespace lamella
