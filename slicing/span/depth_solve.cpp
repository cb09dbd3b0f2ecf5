// Compiled once for each level of the architecture, with LAMELLA_LEVEL in the functions' names. Nothing in here may
// have external linkage but those functions, and no inline function of a header may be used: at link time one copy of
// those would be kept, perhaps one with instructions that an older machine lacks.

#include "slicing/span/depth_kernel.h"

namespace lamella::span {

namespace {

constexpr std::size_t kLanes = 64;  // rows solved together: whole vectors of any width, and room in the first cache
constexpr std::size_t kVector = 8;  // lanes of the widest vector
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

/// What a row needs to be solved, an array a quantity. The rows of many short stretches, side by side, fill whole
/// vectors, and the steps of their iterations don't wait for one another. Room for one vector more, since a stretch's
/// quantities are written in whole vectors.
struct Lanes {
  using Array = double[kLanes + kVector];

  Array x[6];
  Array y[6];
  Array slope[4];  // coefficients of y' after the first, which is y[1]
  Array begin;     // of t
  Array end;
  Array width;
  Array y_begin;
  Array per_rise;
  Array first;   // slope at the begin of the stretch mapped to the unit square
  Array excess;  // sum of both end slopes, less 2
  Array row;
  Array t;
  Array error;
};

/// A stretch mapped to the unit square.
struct Stretch {
  double width;
  double y_begin;
  double rise;
  double per_rise;
  double first;
  double excess;
};

inline Stretch prepare(const DepthTask& task) {
  Stretch s;
  s.width = task.t_end - task.t_begin;
  s.y_begin = value(task.y, task.t_begin);
  s.rise = value(task.y, task.t_end) - s.y_begin;
  s.per_rise = s.rise == 0.0 ? 0.0 : 1.0 / s.rise;
  // Both end slopes are >= 0 for a monotone stretch.
  s.first = clamp(slope(task.y, task.t_begin) * s.width * s.per_rise, 0.0, 1e6);
  const double last = clamp(slope(task.y, task.t_end) * s.width * s.per_rise, 0.0, 1e6);
  s.excess = s.first + last - 2.0;
  return s;
}

inline void spread(double quantity, std::size_t count, double* lanes) {
  for (std::size_t i = 0; i < count; i += kVector) {
    for (std::size_t k = 0; k < kVector; ++k) lanes[i + k] = quantity;
  }
}

/// Rows [from, from + count) of a task in the lanes from `at` on.
inline void fill(const DepthTask& task, const Stretch& stretch, std::size_t from, std::size_t count, std::size_t at,
                 Lanes& lanes) {
  for (int k = 0; k < 6; ++k) spread(task.x[k], count, lanes.x[k] + at);
  for (int k = 0; k < 6; ++k) spread(task.y[k], count, lanes.y[k] + at);
  for (int k = 0; k < 4; ++k) spread((k + 2.0) * task.y[k + 2], count, lanes.slope[k] + at);
  spread(task.t_begin, count, lanes.begin + at);
  spread(task.t_begin + stretch.width, count, lanes.end + at);
  spread(stretch.width, count, lanes.width + at);
  spread(stretch.y_begin, count, lanes.y_begin + at);
  spread(stretch.per_rise, count, lanes.per_rise + at);
  spread(stretch.first, count, lanes.first + at);
  spread(stretch.excess, count, lanes.excess + at);
  for (std::size_t i = 0; i < count; ++i) lanes.row[at + i] = task.rows[from + i];
}

inline double value(const Lanes::Array (&c)[6], std::size_t i, double t) {
  return c[0][i] + t * (c[1][i] + t * (c[2][i] + t * (c[3][i] + t * (c[4][i] + t * c[5][i]))));
}

/// Solves (s^2 + first s (1-s)) / (1 + excess s (1-s)) = w for s (Gregory and Delbourgo 1982).
inline void guess(Lanes& lanes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double w = clamp((lanes.row[i] - lanes.y_begin[i]) * lanes.per_rise[i], 0.0, 1.0);
    const double a = 1.0 - lanes.first[i] + w * lanes.excess[i];
    const double b = lanes.first[i] - w * lanes.excess[i];
    const double square = b * b + 4.0 * a * w;
    const double root = __builtin_sqrt(square > 0.0 ? square : 0.0);
    const double bottom = b + root;
    const double s = bottom > 0.0 ? 2.0 * w / bottom : 0.0;
    lanes.t[i] = lanes.begin[i] + lanes.width[i] * clamp(s, 0.0, 1.0);
  }
}

inline void step(Lanes& lanes, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const double t = lanes.t[i];
    const double d = lanes.y[1][i] + t * (lanes.slope[0][i] +
                                          t * (lanes.slope[1][i] + t * (lanes.slope[2][i] + t * lanes.slope[3][i])));
    const double move = (value(lanes.y, i, t) - lanes.row[i]) / (d == 0.0 ? 1e300 : d);
    lanes.t[i] = clamp(t - move, lanes.begin[i], lanes.end[i]);
  }
}

/// Writes the xs of the first `count` lanes. Returns whether all rows are met.
inline bool finish(Lanes& lanes, std::size_t count, double residual, double* xs) {
  for (std::size_t i = 0; i < count; ++i) xs[i] = value(lanes.x, i, lanes.t[i]);
  long long missed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    lanes.error[i] = magnitude(value(lanes.y, i, lanes.t[i]) - lanes.row[i]);
    missed |= lanes.error[i] <= residual ? 0 : 1;
  }
  return missed == 0;
}

/// Settles the rows of one stretch that Newton's iteration did not reach. Returns how many can't be.
std::size_t mend(const DepthTask& task, const double* rows, const double* errors, std::size_t count, double residual,
                 double* xs) {
  const Stretch stretch = prepare(task);
  const double sign = stretch.rise < 0.0 ? -1.0 : 1.0;
  std::size_t failed = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (errors[i] <= residual) continue;
    const double w = (rows[i] - stretch.y_begin) * stretch.per_rise;
    // A row beyond the stretch belongs to its end: the node that closes the arc lies a little further.
    const double at = w <= 0.0 ? task.t_begin : w >= 1.0 ? task.t_begin + stretch.width : bisect(task, rows[i], sign);
    xs[i] = value(task.x, at);
    if (w > 0.0 && w < 1.0 && !(magnitude(value(task.y, at) - rows[i]) <= residual)) ++failed;
  }
  return failed;
}

/// Rows of one task among those solved together.
struct Part {
  std::size_t task;
  std::size_t lane;
  std::size_t count;
};

/// Solves `used` lanes.
void solve(Lanes& lanes, std::size_t used, const Part* parts, std::size_t part_count, DepthTask* tasks, double residual,
           double* xs) {
  guess(lanes, used);
  for (int k = 0; k < kSteps; ++k) step(lanes, used);
  if (finish(lanes, used, residual, xs)) return;
  for (const Part* part = parts; part != parts + part_count; ++part) {
    const std::size_t at = part->lane;
    tasks[part->task].failed +=
        mend(tasks[part->task], lanes.row + at, lanes.error + at, part->count, residual, xs + at);
  }
}

}  // namespace

#define LAMELLA_JOIN(name, level) name##_##level
#define LAMELLA_NAME(name, level) LAMELLA_JOIN(name, level)

void LAMELLA_NAME(solve, LAMELLA_LEVEL)(DepthTask* tasks, std::size_t count, double residual, double* xs);
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

void LAMELLA_NAME(solve, LAMELLA_LEVEL)(DepthTask* tasks, std::size_t count, double residual, double* xs) {
  Lanes lanes;
  Part parts[kLanes];
  std::size_t part_count = 0;
  std::size_t used = 0;
  for (std::size_t k = 0; k < count; ++k) {
    tasks[k].failed = 0;
    const Stretch stretch = prepare(tasks[k]);
    for (std::size_t from = 0; from < tasks[k].count;) {
      const std::size_t left = tasks[k].count - from;
      const std::size_t taken = left < kLanes - used ? left : kLanes - used;
      fill(tasks[k], stretch, from, taken, used, lanes);
      parts[part_count++] = {k, used, taken};
      from += taken;
      used += taken;
      if (used < kLanes) continue;
      solve(lanes, used, parts, part_count, tasks, residual, xs);
      xs += used;
      used = part_count = 0;
    }
  }
  if (used > 0) solve(lanes, used, parts, part_count, tasks, residual, xs);
}

}  // namespace lamella::span
