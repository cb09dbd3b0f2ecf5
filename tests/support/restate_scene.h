#pragma once

#include "model/scene.h"

/// The same point sets said in other words.
namespace lamella::test {

/// B-spline faces with u and v exchanged; their Su x Sv turns.
[[nodiscard]] Scene with_swapped_parameters(Scene scene);
/// Every face with one parameter running the other way (u, or v of planes and extrusions); its Su x Sv turns.
[[nodiscard]] Scene with_reversed_parameters(Scene scene);
/// B-spline faces with `count` knots inserted along u and along v, at random.
[[nodiscard]] Scene with_inserted_knots(Scene scene, int count, unsigned seed);
/// B-spline faces with every inner knot at full multiplicity: Bezier pieces.
[[nodiscard]] Scene with_full_knots(Scene scene);
/// The faces of each shell in another order.
[[nodiscard]] Scene with_shuffled_faces(Scene scene, unsigned seed);

}  // namespace lamella::test
