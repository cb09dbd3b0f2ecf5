#include "model/bernstein_roots.h"

#include <algorithm>
#include <cmath>

namespace lamella {

namespace {

constexpr double kNarrow = 1e-12;  // of the unit interval: below this a root is placed in the middle

int sign_changes(const std::vector<double>& c, double zero) {
  int changes = 0;
  double last = 0.0;
  for (const double value : c) {
    if (std::abs(value) <= zero) continue;
    if (last * value < 0.0) ++changes;
    last = value;
  }
  return changes;
}

/// Halves of the coefficients at the middle, by de Casteljau.
void halve(const std::vector<double>& c, std::vector<double>& left, std::vector<double>& right) {
  right = c;
  left.resize(c.size());
  left[0] = right[0];
  for (std::size_t r = 1; r < c.size(); ++r) {
    for (std::size_t i = 0; i + r < c.size(); ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
    left[r] = right[0];
  }
}

class RootFinder {
 public:
  RootFinder(double zero, std::vector<double>& roots) : zero_(zero), roots_(roots) {}

  void find(const std::vector<double>& c, double lo, double hi) {
    if (sign_changes(c, zero_) == 0) return;
    const double middle = 0.5 * (lo + hi);
    if (hi - lo < kNarrow) {
      add(middle);
      return;
    }
    std::vector<double> left, right;
    halve(c, left, right);
    find(left, lo, middle);
    // A root at the middle itself changes the sign of neither half.
    if (std::abs(left.back()) <= zero_) add(middle);
    find(right, middle, hi);
  }

 private:
  void add(double t) {
    if (roots_.empty() || t - roots_.back() > kNarrow) roots_.push_back(t);
  }

  double zero_;
  std::vector<double>& roots_;
};

}  // namespace

std::vector<double> bernstein_roots(std::span<const double> coefficients, double scale) {
  std::vector<double> roots;
  if (coefficients.size() < 2) return roots;
  for (const double c : coefficients) {
    if (!std::isfinite(c)) return roots;
  }
  const std::vector<double> c(coefficients.begin(), coefficients.end());
  RootFinder(1e-14 * scale, roots).find(c, 0.0, 1.0);
  return roots;
}

}  // namespace lamella
