#pragma once

#include <span>
#include <string>

#include "slicing/orient/surface_samples.h"

namespace lamella {

/// What a picture of an orientation shows.
struct OrientPicture {
  Mat3 turn = Mat3::Identity();  ///< of the assembly, to the machine's frame
  double critical_angle =
      45.0 / 180.0 * kPi;   ///< radians: undersides flatter than this are red, what lies on the plate green
  bool from_below = false;  ///< through the plate, to show what needs support
  int width = 560;          ///< pixels
  int height = 440;
};

/// The assembly as it lies on the plate, seen from the front right and above, as a PNG: every sample a small square,
/// the near ones before the far ones, shaded by its normal in its colour (one a sample). Empty without samples.
[[nodiscard]] std::string draw_orientation(const SurfaceSamples& samples, std::span<const Color> colors,
                                           const OrientPicture& picture);

}  // namespace lamella
