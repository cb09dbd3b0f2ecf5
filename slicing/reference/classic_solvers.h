#pragma once

#include <cstdint>
#include <vector>

#include "slicing/reference/plane_nets.h"

namespace lamella::reference {

/// The paper's root finder (step 4): u is held while v is bisected; where the error stays above `tolerance` u goes one
/// step on, until a point is found or u reaches its limit. Success is |F| < tolerance (eq. 9), a line is given up when
/// |F| no longer changes from one bisection to the next (eq. 10). F is the distance from the ray in mm. Finds at most
/// one root per sub-patch, as the paper does; it may miss it, and neighbours may both report one on their border.
///
/// The paper leaves open the step of u (here: no point of the sub-patch moves further than `tolerance`, at most
/// kMaxLines lines) and which equation is bisected (here: the one that changes its sign along the line, and more if
/// both do).
void solve_by_bisection(const PlaneNets& nets, double tolerance, std::vector<PatchRoot>& roots,
                        std::uint64_t& iterations);

inline constexpr int kMinLines = 8;
inline constexpr int kMaxLines = 4096;

/// Newton's iteration from the middle of the sub-patch, which the paper names as the faster way of ray tracers: success
/// is |F| < tolerance inside the sub-patch. Finds at most one root; diverges or leaves the sub-patch where it bends.
void solve_by_newton(const PlaneNets& nets, double tolerance, std::vector<PatchRoot>& roots, std::uint64_t& iterations);

}  // namespace lamella::reference
