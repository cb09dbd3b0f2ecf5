#pragma once

#include "core/geometry.h"

namespace lamella {

/// A rigid motion p -> turn p + shift; `turn` is a rotation, `shift` is in mm.
struct Motion {
  Mat3 turn = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  [[nodiscard]] Vec3 apply(const Vec3& point) const { return turn * point + shift; }
};

}  // namespace lamella
