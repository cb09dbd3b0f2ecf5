#include "slicing/span/lane_kernel.h"

#include <array>

#include "slicing/span/cpu_level.h"

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

constexpr std::array<LaneKernel, kCpuLevels> kBuilds{{
    {jets_v2, move_v2, join_v2, measure_v2, distance_v2},
#if defined(LAMELLA_X86_LEVELS)
    {jets_v3, move_v3, join_v3, measure_v3, distance_v3},
    {jets_v4, move_v4, join_v4, measure_v4, distance_v4},
#endif
}};

}  // namespace

std::span<const LaneKernel> lane_kernels() { return usable(kBuilds); }

const LaneKernel& lane_kernel() {
  static const LaneKernel& best = lane_kernels().back();
  return best;
}

}  // namespace lamella::span
