#pragma once

#include "model/scene.h"

namespace lamella::test {

/// The scene with every vertex and every edge's curve moved aside by up to `gap` mm, every pcurve by as much on its
/// face, all independently and at random: nothing meets any more. Surfaces stay. The tolerances say so when `stated`.
[[nodiscard]] Scene disturbed(Scene scene, double gap, unsigned seed, bool stated);

}  // namespace lamella::test
