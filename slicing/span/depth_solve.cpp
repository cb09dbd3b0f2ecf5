// Compiled once for each level of the architecture, with LAMELLA_LEVEL in the functions' names. Nothing in here may
// have external linkage but those functions, and no inline function of a header may be used: at link time one copy of
// those would be kept, perhaps one with instructions that an older machine lacks.

#include "slicing/span/depth_kernel.h"

namespace lamella::span {

namespace {

constexpr std::size_t kLanes = 64;  // rows a block: enough for any vector width, small enough for the stack
constexpr int kSteps = 4;

inline double value(const double* c, double t) {
  return c[0] + t * (c[1] + t * (c[2] + t * (c[3] + t * (c[4] + t * c[5]))));
}

inline double slope(const double* c, double t) {
  return c[1] + t * (2.0 * c[2] + t * (3.0 * c[3] + t * (4.0 * c[4] + t * (5.0 * c[5]))));
}

inline double clamp(double t, double lo, double hi) { return t < lo ? lo : (t > hi ? hi : t); }

inline double magnitude(double a) { return a < 0.0 ? -a : a; }

/// Bisection for what Newton's iteration did not reach; y rises (times sign) over the stretch.
double bisect(const DepthTask& task, double row, double sign) {
  double lo = task.t_begin;
  double hi = task.t_end;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (lo + hi);
    if (sign * (value(task.y, middle) - row) < 0.0) {
      lo = middle;
    } else {
      hi = middle;
    }
  }
  return 0.5 * (lo + hi);
}

}  // namespace

#define LAMELLA_JOIN(name, level) name##_##level
#define LAMELLA_NAME(name, level) LAMELLA_JOIN(name, level)

std::size_t LAMELLA_NAME(solve, LAMELLA_LEVEL)(const DepthTask& task, const double* rows, std::size_t count,
                                               double residual, double* xs);
void LAMELLA_NAME(blend, LAMELLA_LEVEL)(const double* coefficients, std::size_t count, double place, double* sums);

void LAMELLA_NAME(round, LAMELLA_LEVEL)(const RoundTask& task, const double* rows, std::size_t count, double* xs);
void LAMELLA_NAME(line, LAMELLA_LEVEL)(const LineTask& task, const double* rows, std::size_t count, double* xs);

void LAMELLA_NAME(line, LAMELLA_LEVEL)(const LineTask& task, const double* rows, std::size_t count, double* xs) {
  const LineTask line = task;
  const double per_rise = line.dy == 0.0 ? 0.0 : 1.0 / line.dy;
  double* __restrict out = xs;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = line.x0 + clamp((rows[i] - line.y0) * per_rise, 0.0, 1.0) * line.dx;
  }
}

void LAMELLA_NAME(round, LAMELLA_LEVEL)(const RoundTask& task, const double* rows, std::size_t count, double* xs) {
  const RoundTask t = task;
  const double per_reach = t.reach > 0.0 ? 1.0 / t.reach : 0.0;
  double* __restrict out = xs;
  for (std::size_t i = 0; i < count; ++i) {
    const double w = clamp((rows[i] - t.center_y) * per_reach, -1.0, 1.0);
    out[i] = t.center_x + t.slant * w + t.bulge * __builtin_sqrt((1.0 - w) * (1.0 + w));
  }
}

void LAMELLA_NAME(blend, LAMELLA_LEVEL)(const double* coefficients, std::size_t count, double place, double* sums) {
  const double* __restrict c0 = coefficients;
  const double* __restrict c1 = c0 + count;
  const double* __restrict c2 = c1 + count;
  const double* __restrict c3 = c2 + count;
  const double* __restrict c4 = c3 + count;
  double* __restrict out = sums;
  for (std::size_t i = 0; i < count; ++i) {
    out[i] = c0[i] + place * (c1[i] + place * (c2[i] + place * (c3[i] + place * c4[i])));
  }
}

std::size_t LAMELLA_NAME(solve, LAMELLA_LEVEL)(const DepthTask& task, const double* rows, std::size_t count,
                                               double residual, double* xs) {
  double cx[6], cy[6];
  for (int i = 0; i < 6; ++i) cx[i] = task.x[i];
  for (int i = 0; i < 6; ++i) cy[i] = task.y[i];
  const double t0 = task.t_begin;
  const double width = task.t_end - task.t_begin;
  const double y0 = value(cy, task.t_begin);
  const double rise = value(cy, task.t_end) - y0;
  const double per_rise = rise == 0.0 ? 0.0 : 1.0 / rise;
  const double sign = rise < 0.0 ? -1.0 : 1.0;
  // End slopes of the stretch mapped to the unit square; both are >= 0 for a monotone stretch.
  const double first = clamp(slope(cy, task.t_begin) * width * per_rise, 0.0, 1e6);
  const double last = clamp(slope(cy, task.t_end) * width * per_rise, 0.0, 1e6);
  const double excess = first + last - 2.0;
  std::size_t failed = 0;
  double t[kLanes];
  double error[kLanes];
  for (std::size_t begin = 0; begin < count; begin += kLanes) {
    const std::size_t n = count - begin < kLanes ? count - begin : kLanes;
    const double* row = rows + begin;
    for (std::size_t i = 0; i < n; ++i) {
      // Solves (s^2 + first s (1-s)) / (1 + excess s (1-s)) = w for s (Gregory and Delbourgo 1982).
      const double w = clamp((row[i] - y0) * per_rise, 0.0, 1.0);
      const double a = 1.0 - first + w * excess;
      const double b = first - w * excess;
      const double square = b * b + 4.0 * a * w;
      const double root = __builtin_sqrt(square > 0.0 ? square : 0.0);
      const double bottom = b + root;
      const double s = bottom > 0.0 ? 2.0 * w / bottom : 0.0;
      t[i] = t0 + width * clamp(s, 0.0, 1.0);
    }
    for (int step = 0; step < kSteps; ++step) {
      for (std::size_t i = 0; i < n; ++i) {
        const double d = slope(cy, t[i]);
        const double move = (value(cy, t[i]) - row[i]) / (d == 0.0 ? 1e300 : d);
        t[i] = clamp(t[i] - move, t0, t0 + width);
      }
    }
    double* out = xs + begin;
    for (std::size_t i = 0; i < n; ++i) {
      out[i] = value(cx, t[i]);
      error[i] = magnitude(value(cy, t[i]) - row[i]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      if (error[i] <= residual) continue;
      const double w = (row[i] - y0) * per_rise;
      // A row beyond the stretch belongs to its end: the node that closes the arc lies a little further.
      const double at = w <= 0.0 ? t0 : (w >= 1.0 ? t0 + width : bisect(task, row[i], sign));
      out[i] = value(cx, at);
      if (w > 0.0 && w < 1.0 && !(magnitude(value(cy, at) - row[i]) <= residual)) ++failed;
    }
  }
  return failed;
}

}  // namespace lamella::span
