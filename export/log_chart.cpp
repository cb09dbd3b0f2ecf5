#include "export/log_chart.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "core/xml.h"

namespace lamella {

namespace {

// Sizes in units of the drawing, which scales with the page.
constexpr double kWidth = 520.0;
constexpr double kHeight = 330.0;
constexpr double kLeft = 72.0;
constexpr double kRight = 12.0;
constexpr double kTop = 10.0;
constexpr double kBottom = 46.0;
constexpr std::size_t kColors = 5;
constexpr int kMostTicks = 9;

bool is_drawable(double value) { return value > 0.0 && std::isfinite(value); }

bool is_level(const LogSeries& series) { return series.points.size() == 1 && series.points[0].x() == 0.0; }

/// An axis from one power of ten to another.
struct Axis {
  double low = 0.0;   ///< logarithm
  double high = 0.0;  ///< logarithm
  double from = 0.0;  ///< where on the drawing
  double to = 0.0;

  [[nodiscard]] double at(double value) const { return from + (std::log10(value) - low) / (high - low) * (to - from); }
  /// Every so many decades there is a line.
  [[nodiscard]] int step() const { return 1 + static_cast<int>((high - low) / kMostTicks); }
};

struct Range {
  double low = 0.0;
  double high = 0.0;

  [[nodiscard]] bool empty() const { return high <= 0.0; }
  void add(double value) {
    if (!is_drawable(value)) return;
    low = empty() ? value : std::min(low, value);
    high = std::max(high, value);
  }
};

Axis axis_of(const Range& range, double from, double to) {
  Axis axis{std::floor(std::log10(range.low) + 1e-9), std::ceil(std::log10(range.high) - 1e-9), from, to};
  if (axis.high <= axis.low) axis.high = axis.low + 1.0;
  return axis;
}

std::string power(int exponent) {
  if (exponent >= -3 && exponent <= 4) return fmt::format("{:.6g}", std::pow(10.0, exponent));
  return fmt::format("10<tspan dy=\"-5\" font-size=\"9\">{}</tspan>", exponent);
}

std::string axes(const LogChart& chart, const Axis& x, const Axis& y) {
  std::string svg;
  for (int e = static_cast<int>(x.low); e <= static_cast<int>(x.high); e += x.step()) {
    const double at = x.at(std::pow(10.0, e));
    svg += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.1f}\" y2=\"{2:.1f}\"/>\n", at, y.to,
                       y.from);
    svg +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", at, y.from + 17.0, power(e));
  }
  for (int e = static_cast<int>(y.low); e <= static_cast<int>(y.high); e += y.step()) {
    const double at = y.at(std::pow(10.0, e));
    svg += fmt::format("<line class=\"grid\" x1=\"{0:.1f}\" x2=\"{1:.1f}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/>\n", x.from,
                       x.to, at);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n", x.from - 7.0, at + 4.0,
                       power(e));
  }
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", 0.5 * (x.from + x.to),
                     kHeight - 8.0, xml_escape(chart.x_label));
  svg += fmt::format("<text transform=\"translate(15 {:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                     0.5 * (y.from + y.to), xml_escape(chart.y_label));
  return svg;
}

std::string draw_level(const LogSeries& series, std::size_t color, const Axis& x, const Axis& y) {
  const double value = series.points[0].y();
  if (!is_drawable(value)) return "";
  return fmt::format("<path class=\"level c{}\" d=\"M{:.1f} {:.1f}H{:.1f}\"><title>{}: {:.3g}</title></path>\n", color,
                     x.from, y.at(value), x.to, xml_escape(series.name), value);
}

std::string draw_line(const LogSeries& series, std::size_t color, const Axis& x, const Axis& y) {
  std::string path;
  std::string marks;
  for (const Vec2& point : series.points) {
    if (!is_drawable(point.x()) || !is_drawable(point.y())) continue;
    const double px = x.at(point.x());
    const double py = y.at(point.y());
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px, py);
    if (series.is_dashed) continue;
    marks += fmt::format(
        "<circle class=\"mark f{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.2\"><title>{}: {:.3g} at "
        "{:.3g}</title></circle>\n",
        color, px, py, xml_escape(series.name), point.y(), point.x());
  }
  if (path.empty()) return "";
  return fmt::format("<path class=\"curve c{}{}\" d=\"{}\"/>\n", color, series.is_dashed ? " dash" : "", path) + marks;
}

std::string key(const LogChart& chart) {
  std::string html = "<div class=\"key\">";
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const LogSeries& series = chart.series[s];
    const bool is_dashed = series.is_dashed || is_level(series);
    html += fmt::format(
        "<span><svg class=\"swatch\" viewBox=\"0 0 26 8\"><path class=\"curve c{}{}\" d=\"M0 4H26\"/></svg>{}</span>",
        s % kColors, is_dashed ? " dash" : "", xml_escape(series.name));
  }
  return html + "</div>\n";
}

}  // namespace

const char* const kLogChartStyle = R"css(
:root{--c0:#2f6fb2;--c1:#b4530f;--c2:#2b7d4f;--c3:#7a4fb5;--c4:#5b6675}
@media (prefers-color-scheme:dark){:root{--c0:#6aa9e9;--c1:#f0a35c;--c2:#66c992;--c3:#b892ee;--c4:#9aa5b3}}
.charts{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(440px,100%),1fr));gap:18px}figure{margin:0}figcaption{font-weight:500;margin:6px 0}
.curve,.level{fill:none;stroke-width:2}.level,.dash{stroke-dasharray:6 4}.mark{stroke:var(--card);stroke-width:1}
.c0{stroke:var(--c0)}.c1{stroke:var(--c1)}.c2{stroke:var(--c2)}.c3{stroke:var(--c3)}.c4{stroke:var(--c4)}
.f0{fill:var(--c0)}.f1{fill:var(--c1)}.f2{fill:var(--c2)}.f3{fill:var(--c3)}.f4{fill:var(--c4)}
svg.swatch{width:26px;height:8px;background:none;border-radius:0;margin-right:6px;vertical-align:middle}
)css";

std::string log_chart(const LogChart& chart) {
  Range xs;
  Range ys;
  for (const LogSeries& series : chart.series) {
    for (const Vec2& point : series.points) {
      if (!is_level(series) && (!is_drawable(point.x()) || !is_drawable(point.y()))) continue;
      xs.add(point.x());
      ys.add(point.y());
    }
  }
  std::string html = fmt::format("<figure><figcaption>{}</figcaption>\n", xml_escape(chart.title));
  if (xs.empty() || ys.empty()) return html + "<p>Nothing but zeros, or nothing at all.</p></figure>\n";
  const Axis x = axis_of(xs, kLeft, kWidth - kRight);
  const Axis y = axis_of(ys, kHeight - kBottom, kTop);
  html += fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n", kWidth, kHeight,
                      xml_escape(chart.title)) +
          axes(chart, x, y);
  for (std::size_t s = 0; s < chart.series.size(); ++s) {
    const LogSeries& series = chart.series[s];
    html += is_level(series) ? draw_level(series, s % kColors, x, y) : draw_line(series, s % kColors, x, y);
  }
  return html + "</svg>\n" + key(chart) + "</figure>\n";
}

}  // namespace lamella
