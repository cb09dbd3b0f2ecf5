#include "slicing/reference/face_patches.h"

#include "model/evaluate.h"

namespace lamella::reference {

RationalForm face_form(const Face& face) {
  constexpr double kPad = 1e-9;
  constexpr double kWholePeriod = 1.0 - 4.0 * kPad;
  const Vec2 period = periods(face.surface);
  Box2 bounds = face.uv_bounds;
  for (int k = 0; k < 2; ++k) {
    const double width = bounds.sizes()[k];
    if (period[k] > 0.0 && width >= kWholePeriod * period[k]) continue;
    bounds.min()[k] -= kPad * width;
    bounds.max()[k] += kPad * width;
  }
  return rational_form(face.surface, bounds);
}

}  // namespace lamella::reference
