#pragma once

#include <cstddef>
#include <span>

namespace lamella::span {

/// Doubles of one pole and of one sum: (w x, w y, w z, w).
inline constexpr int kNetStride = 4;

/// Where a net is evaluated along one parameter.
struct NetPlace {
  int degree = 0;      ///< at most kMaxDegree (model/bezier.h)
  double place = 0.0;  ///< 0 at the first pole, 1 at the last
  double scale = 1.0;  ///< derivative of `place` by the parameter
};

/// Sums of a tensor-product net, poles along v first, with the Bernstein polynomials and their derivatives:
/// S, S_u, S_v and, where bends are asked for, S_uu, S_uv, S_vv.
using SurfaceNetFunction = void (*)(const double* net, const NetPlace& u, const NetPlace& v, double* sums);
/// C, C_t, C_tt of a curve's net.
using CurveNetFunction = void (*)(const double* net, const NetPlace& t, double* sums);

/// The same work compiled for three levels of the x86-64 architecture, equal bytes on each (depth_kernel.h).
struct NetKernel {
  SurfaceNetFunction surface_slopes = nullptr;
  SurfaceNetFunction surface_bends = nullptr;
  CurveNetFunction curve = nullptr;
};

/// The best kernel that this machine runs.
[[nodiscard]] const NetKernel& net_kernel();
/// All kernels that this machine runs, lowest level first, for tests.
[[nodiscard]] std::span<const NetKernel> net_kernels();

}  // namespace lamella::span
