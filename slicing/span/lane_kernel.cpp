#include "slicing/span/lane_kernel.h"

#include <array>

#include "slicing/span/depth_kernel.h"

namespace lamella::span {

#define LAMELLA_DECLARE(level)                                               \
  void jets_##level(const NetShape&, const NetLanes&, int, bool, JetLanes&); \
  void move_##level(const JetLanes&, int, MoveLanes&, PointLanes&);          \
  void join_##level(const RunLanes&, int, PieceLanes&);                      \
  void measure_##level(const JetLanes&, int, MeasureLanes&);                 \
  void distance_##level(const JetLanes&, int, MeasureLanes&)
LAMELLA_DECLARE(v2);
LAMELLA_DECLARE(v3);
LAMELLA_DECLARE(v4);
#undef LAMELLA_DECLARE

namespace {

const std::array<LaneKernel, 3>& all_kernels() {
  static const std::array<LaneKernel, 3> kernels{{
      {jets_v2, move_v2, join_v2, measure_v2, distance_v2},
#if defined(LAMELLA_X86_LEVELS)
      {jets_v3, move_v3, join_v3, measure_v3, distance_v3},
      {jets_v4, move_v4, join_v4, measure_v4, distance_v4},
#endif
  }};
  return kernels;
}

}  // namespace

std::size_t lane_kernels(const LaneKernel** kernels) {
  *kernels = all_kernels().data();
  // The machine runs the same levels here as there.
  const DepthKernel* depth = nullptr;
  return depth_kernels(&depth);
}

const LaneKernel& lane_kernel() {
  static const LaneKernel* const best = [] {
    const LaneKernel* kernels = nullptr;
    const std::size_t count = lane_kernels(&kernels);
    return kernels + (count - 1);
  }();
  return *best;
}

}  // namespace lamella::span
