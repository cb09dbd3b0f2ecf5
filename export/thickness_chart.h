#pragma once

#include <string>
#include <vector>

#include "core/geometry.h"

namespace lamella {

/// Layers over the height, as a drawing shows them. All lengths in mm.
struct ThicknessChart {
  std::vector<double> borders;     ///< ascending: of layers.size() + 1 heights
  std::vector<double> deviations;  ///< of each layer, bounds
  double tolerance = 0.0;
  Interval range;                ///< of the thicknesses that were allowed
  std::vector<double> features;  ///< heights of flat features that layers meet
  std::vector<double> missed;    ///< and of those that none meets
  std::string title;
};

/// A whole SVG file: thickness and deviation over the height z, which runs upwards as in the machine, both to scale,
/// flat features as lines across. Throws UsageError for a chart without layers.
[[nodiscard]] std::string draw_thickness(const ThicknessChart& chart);

}  // namespace lamella
