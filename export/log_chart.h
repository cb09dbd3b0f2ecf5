#pragma once

#include <string>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Points joined by a line, or a level over the whole width where there is one point with x = 0.
struct LogSeries {
  std::string name;
  std::vector<Vec2> points;  ///< x ascending; what isn't positive and finite has no place on a logarithmic axis
  bool is_dashed = false;    ///< a bound or a reference, without marks
};

/// A chart with logarithmic axes.
struct LogChart {
  std::string title;
  std::string x_label;  ///< with its unit
  std::string y_label;
  std::vector<LogSeries> series;
};

/// The chart as inline SVG with its key below, colours by kLogChartStyle; a note in place of a chart without points.
[[nodiscard]] std::string log_chart(const LogChart& chart);

/// Goes into the page's style beside kPageStyle.
extern const char* const kLogChartStyle;

}  // namespace lamella
