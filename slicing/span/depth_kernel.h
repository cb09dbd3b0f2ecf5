#pragma once

#include <cstddef>
#include <span>

namespace lamella::span {

/// The stretch of an arc over which y runs one way, and the rows to be found on it.
struct DepthTask {
  const double* x = nullptr;  ///< coefficients of the piece, 6 ascending
  const double* y = nullptr;
  double t_begin = 0.0;  ///< part of [0, 1]
  double t_end = 1.0;
  const double* rows = nullptr;
  std::size_t count = 0;   ///< of rows
  std::size_t failed = 0;  ///< set to the number of rows whose residual in y stayed too large
};

/// x where y(t) is the row, for all rows of all tasks one after the other in xs: Newton's iteration from the inverse of
/// the rational quadratic with the stretch's end slopes. Rows beyond the stretch's own y get its end. A residual in y
/// above `residual` (mm) is a failure.
using DepthFunction = void (*)(DepthTask* tasks, std::size_t count, double residual, double* xs);

/// The part of an ellipse on one side of the line through its turning points, by the row's own coordinates:
/// x = center_x + slant w + bulge sqrt(1 - w^2) with w = (y - center_y) / reach.
struct RoundTask {
  double center_x = 0.0;
  double center_y = 0.0;
  double reach = 0.0;  ///< half the ellipse's extent in y
  double slant = 0.0;
  double bulge = 0.0;  ///< signed: which side
};
using RoundFunction = void (*)(const RoundTask& task, const double* rows, std::size_t count, double* xs);

/// A chord: x = x0 + t dx where y0 + t dy is the row, t within [0, 1].
struct LineTask {
  double x0 = 0.0;
  double dx = 0.0;
  double y0 = 0.0;
  double dy = 0.0;
};
using LineFunction = void (*)(const LineTask& task, const double* rows, std::size_t count, double* xs);

/// sums[i] = polynomial of degree 4 at `place`, coefficients[power * count + i].
using BlendFunction = void (*)(const double* coefficients, std::size_t count, double place, double* sums);

/// The same work compiled for three levels of the x86-64 architecture. Equal bytes on each: no contraction, no
/// reassociation, and only operations that IEEE 754 rounds correctly.
struct DepthKernel {
  DepthFunction solve = nullptr;
  BlendFunction blend = nullptr;
  RoundFunction round = nullptr;
  LineFunction line = nullptr;
};

/// The best kernel that this machine runs.
[[nodiscard]] const DepthKernel& depth_kernel();
/// All kernels that this machine runs, lowest level first, for tests.
[[nodiscard]] std::span<const DepthKernel> depth_kernels();

}  // namespace lamella::span
