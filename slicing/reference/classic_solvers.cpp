#include "slicing/reference/classic_solvers.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lamella::reference {

namespace {

constexpr int kMaxBisections = 64;
/// Eq. (10) asks for "approximately the same" error: a change by this share of the tolerance.
constexpr double kSameError = 1e-6;
constexpr int kMaxNewtonSteps = 24;
/// Newton may leave the sub-patch by this much of its size on the way.
constexpr double kNewtonMargin = 0.5;

/// F1, F2 and W along one line of constant u: Bernstein coefficients in v.
struct LineNets {
  int count = 0;
  std::array<double, kMaxDegree + 1> f1;
  std::array<double, kMaxDegree + 1> f2;
  std::array<double, kMaxDegree + 1> w;
};

struct LinePoint {
  double f1;
  double f2;
  double distance;  ///< |F| / W, mm
};

void hold_u(const PlaneNets& nets, double u, LineNets& line) {
  std::array<double, kMaxDegree + 1> b;
  std::array<double, kMaxDegree + 1> unused;
  bernstein(nets.count_u, u, b.data(), unused.data());
  line.count = nets.count_v;
  for (int j = 0; j < nets.count_v; ++j) {
    line.f1[j] = line.f2[j] = line.w[j] = 0.0;
    for (int i = 0; i < nets.count_u; ++i) {
      const int k = i * nets.count_v + j;
      line.f1[j] += b[i] * nets.f1[k];
      line.f2[j] += b[i] * nets.f2[k];
      line.w[j] += b[i] * nets.patch->net[k].w();
    }
  }
}

LinePoint at(const LineNets& line, double v) {
  std::array<double, kMaxDegree + 1> b;
  std::array<double, kMaxDegree + 1> unused;
  bernstein(line.count, v, b.data(), unused.data());
  double f1 = 0.0, f2 = 0.0, w = 0.0;
  for (int j = 0; j < line.count; ++j) {
    f1 += b[j] * line.f1[j];
    f2 += b[j] * line.f2[j];
    w += b[j] * line.w[j];
  }
  return {f1, f2, std::hypot(f1, f2) / w};
}

/// No point of the line can satisfy eq. (9): a coefficient hull stays further away. Saves bisections that must fail.
bool misses(const LineNets& line, double tolerance) {
  const auto stays_away = [&](const std::array<double, kMaxDegree + 1>& f, double sign) {
    for (int j = 0; j < line.count; ++j) {
      if (sign * f[j] <= tolerance * line.w[j]) return false;
    }
    return true;
  };
  return stays_away(line.f1, 1.0) || stays_away(line.f1, -1.0) || stays_away(line.f2, 1.0) || stays_away(line.f2, -1.0);
}

/// Bisects one line; true and `v` on success.
bool bisect(const LineNets& line, double tolerance, double& v, std::uint64_t& iterations) {
  const LinePoint first = at(line, 0.0);
  const LinePoint last = at(line, 1.0);
  for (const auto& [point, end] : {std::pair(first, 0.0), std::pair(last, 1.0)}) {
    if (point.distance < tolerance) {
      v = end;
      return true;
    }
  }
  const bool changes1 = first.f1 * last.f1 < 0.0;
  const bool changes2 = first.f2 * last.f2 < 0.0;
  if (!changes1 && !changes2) return false;
  const bool use1 = changes1 && (!changes2 || std::abs(last.f1 - first.f1) >= std::abs(last.f2 - first.f2));
  const double sign_at_low = use1 ? first.f1 : first.f2;
  double low = 0.0;
  double high = 1.0;
  double previous = first.distance;
  for (int step = 0; step < kMaxBisections; ++step) {
    ++iterations;
    v = 0.5 * (low + high);
    const LinePoint middle = at(line, v);
    if (middle.distance < tolerance) return true;
    if (std::abs(middle.distance - previous) <= kSameError * tolerance) return false;
    previous = middle.distance;
    ((use1 ? middle.f1 : middle.f2) * sign_at_low > 0.0 ? low : high) = v;
  }
  return false;
}

/// Steps of u that move no point further than `tolerance`: by the net's longest polygon along u.
int line_steps(const PlaneNets& nets, double tolerance) {
  double longest = 0.0;
  for (int j = 0; j < nets.count_v; ++j) {
    double length = 0.0;
    for (int i = 0; i + 1 < nets.count_u; ++i) {
      const Vec4& a = nets.patch->net[i * nets.count_v + j];
      const Vec4& b = nets.patch->net[(i + 1) * nets.count_v + j];
      length += (b.head<3>() / b.w() - a.head<3>() / a.w()).norm();
    }
    longest = std::max(longest, length);
  }
  const double steps = std::ceil(longest / tolerance);
  return static_cast<int>(std::clamp(steps, double{kMinLines}, double{kMaxLines}));
}

PatchRoot make_root(const PlaneNets& nets, double u, double v) {
  return {u, v, 0.0, 0.0, false, evaluate(nets, u, v).determinant() > 0.0};
}

}  // namespace

void solve_by_bisection(const PlaneNets& nets, double tolerance, std::vector<PatchRoot>& roots,
                        std::uint64_t& iterations) {
  const int steps = line_steps(nets, tolerance);
  LineNets line;
  for (int k = 0; k <= steps; ++k) {
    const double u = static_cast<double>(k) / steps;
    hold_u(nets, u, line);
    double v = 0.0;
    if (misses(line, tolerance) || !bisect(line, tolerance, v, iterations)) continue;
    roots.push_back(make_root(nets, u, v));
    return;
  }
}

void solve_by_newton(const PlaneNets& nets, double tolerance, std::vector<PatchRoot>& roots,
                     std::uint64_t& iterations) {
  double u = 0.5;
  double v = 0.5;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    ++iterations;
    const PlaneValues f = evaluate(nets, u, v);
    if (std::hypot(f.f1, f.f2) < tolerance * evaluate_weight(nets, u, v)) {
      if (u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0) roots.push_back(make_root(nets, u, v));
      return;
    }
    const double determinant = f.determinant();
    u -= (f.f1 * f.f2_v - f.f2 * f.f1_v) / determinant;
    v -= (f.f2 * f.f1_u - f.f1 * f.f2_u) / determinant;
    // Also ends on NaN, from a singular Jacobian.
    if (!(std::abs(u - 0.5) <= 0.5 + kNewtonMargin && std::abs(v - 0.5) <= 0.5 + kNewtonMargin)) return;
  }
}

}  // namespace lamella::reference
