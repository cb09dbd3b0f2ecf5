#include "model/normal_net.h"

#include <algorithm>
#include <cmath>

#include "model/de_casteljau.h"

namespace lamella {

namespace {

/// A tensor-product Bernstein polynomial; `net` as in BezierPatch.
template <class T>
struct Polynomial {
  int degree_u = 0;
  int degree_v = 0;
  std::vector<T> net;

  Polynomial(int du, int dv, const T& zero)
      : degree_u(du), degree_v(dv), net(static_cast<std::size_t>(du + 1) * (dv + 1), zero) {}
  [[nodiscard]] T& at(int i, int j) { return net[static_cast<std::size_t>(i) * (degree_v + 1) + j]; }
  [[nodiscard]] const T& at(int i, int j) const { return net[static_cast<std::size_t>(i) * (degree_v + 1) + j]; }
};

std::vector<double> binomials(int n) {
  std::vector<double> row(static_cast<std::size_t>(n) + 1, 1.0);
  for (int k = 1; k <= n; ++k) row[k] = row[k - 1] * (n - k + 1) / k;
  return row;
}

/// f times g: `times` multiplies two coefficients.
template <class A, class B, class Times>
auto multiply(const Polynomial<A>& f, const Polynomial<B>& g, Times times) {
  using T = std::decay_t<decltype(times(f.net[0], g.net[0]))>;
  Polynomial<T> out(f.degree_u + g.degree_u, f.degree_v + g.degree_v, T(times(f.net[0], g.net[0]) * 0.0));
  const auto fu = binomials(f.degree_u);
  const auto fv = binomials(f.degree_v);
  const auto gu = binomials(g.degree_u);
  const auto gv = binomials(g.degree_v);
  for (int i = 0; i <= f.degree_u; ++i) {
    for (int j = 0; j <= f.degree_v; ++j) {
      for (int k = 0; k <= g.degree_u; ++k) {
        for (int l = 0; l <= g.degree_v; ++l) {
          out.at(i + k, j + l) += (fu[i] * fv[j] * gu[k] * gv[l]) * times(f.at(i, j), g.at(k, l));
        }
      }
    }
  }
  const auto ou = binomials(out.degree_u);
  const auto ov = binomials(out.degree_v);
  for (int i = 0; i <= out.degree_u; ++i) {
    for (int j = 0; j <= out.degree_v; ++j) out.at(i, j) *= 1.0 / (ou[i] * ov[j]);
  }
  return out;
}

template <class T>
Polynomial<T> derivative(const Polynomial<T>& f, bool along_u) {
  const int du = f.degree_u - (along_u ? 1 : 0);
  const int dv = f.degree_v - (along_u ? 0 : 1);
  Polynomial<T> out(du, dv, f.net[0]);
  const double degree = along_u ? f.degree_u : f.degree_v;
  for (int i = 0; i <= du; ++i) {
    for (int j = 0; j <= dv; ++j) {
      out.at(i, j) = degree * (f.at(i + (along_u ? 1 : 0), j + (along_u ? 0 : 1)) - f.at(i, j));
    }
  }
  return out;
}

double longest(const std::vector<Vec3>& net) {
  double most = 0.0;
  for (const Vec3& p : net) most = std::max(most, p.norm());
  return most;
}

/// Splits one parameter at `s` in [0, 1] of its interval.
void split(const NormalNet& net, bool along_u, double s, NormalNet& first, NormalNet& second) {
  first = net;
  second = net;
  const int stride = net.degree_v + 1;
  if (along_u) {
    for (int j = 0; j < stride; ++j) {
      split_in_place(first.net.data() + j, second.net.data() + j, net.degree_u, stride, s);
    }
    first.u.hi = second.u.lo = net.u.lo + s * net.u.length();
  } else {
    for (int i = 0; i <= net.degree_u; ++i) {
      split_in_place(first.net.data() + i * stride, second.net.data() + i * stride, net.degree_v, 1, s);
    }
    first.v.hi = second.v.lo = net.v.lo + s * net.v.length();
  }
}

void restrict_along(NormalNet& net, bool along_u, Interval to) {
  NormalNet first;
  NormalNet second;
  const auto place = [&](double t) {
    const Interval& own = along_u ? net.u : net.v;
    return own.length() > 0.0 ? std::clamp((t - own.lo) / own.length(), 0.0, 1.0) : 0.0;
  };
  if (const double s = place(to.lo); s > 0.0) {
    split(net, along_u, s, first, second);
    net = std::move(second);
  }
  if (const double s = place(to.hi); s < 1.0) {
    split(net, along_u, s, first, second);
    net = std::move(first);
  }
}

}  // namespace

NormalNet normal_net(const BezierPatch& patch) {
  Polynomial<Vec3> x(patch.degree_u, patch.degree_v, Vec3::Zero());
  Polynomial<double> w(patch.degree_u, patch.degree_v, 1.0);
  // About a point of the patch, so that the products below don't cancel.
  const Vec3 middle = evaluate_point(patch, patch.u.middle(), patch.v.middle());
  bool is_rational = false;
  double size = 0.0;
  for (std::size_t i = 0; i < patch.net.size(); ++i) {
    w.net[i] = patch.net[i][3];
    x.net[i] = patch.net[i].head<3>() - patch.net[i][3] * middle;
    is_rational |= w.net[i] != w.net[0];
    size = std::max(size, patch.net[i].head<3>().norm());
  }
  const auto cross = [](const Vec3& a, const Vec3& b) -> Vec3 { return a.cross(b); };
  const auto scale = [](double a, const Vec3& b) -> Vec3 { return a * b; };
  const Polynomial<Vec3> xu = derivative(x, true);
  const Polynomial<Vec3> xv = derivative(x, false);
  Polynomial<Vec3> normal = multiply(xu, xv, cross);
  double weight = 1.0;
  if (is_rational) {
    // S = X / W: W^3 S_u x S_v = W (X_u x X_v) - W_v (X_u x X) - W_u (X x X_v).
    const Polynomial<Vec3> a =
        multiply(multiply(xu, x, cross), derivative(w, false), [](const Vec3& p, double q) -> Vec3 { return q * p; });
    const Polynomial<Vec3> b = multiply(derivative(w, true), multiply(x, xv, cross), scale);
    normal = multiply(w, normal, scale);
    for (std::size_t i = 0; i < normal.net.size(); ++i) normal.net[i] -= a.net[i] + b.net[i];
    weight = *std::max_element(w.net.begin(), w.net.end());
  }
  NormalNet out{normal.degree_u, normal.degree_v, patch.u, patch.v, std::move(normal.net), 0.0};
  // Control points are good to a few units in the last place of their size, and so are their differences.
  const double unit = 1e-15 * size;
  out.rounding = 16.0 * weight * unit * (longest(xu.net) + longest(xv.net));
  return out;
}

NormalNet restrict_to(const NormalNet& net, Interval u, Interval v) {
  NormalNet out = net;
  restrict_along(out, true, u);
  restrict_along(out, false, v);
  return out;
}

SlantNet slant_net(const NormalNet& normals) {
  Polynomial<Vec3> n(normals.degree_u, normals.degree_v, Vec3::Zero());
  n.net = normals.net;
  auto rising = multiply(n, n, [](const Vec3& a, const Vec3& b) { return a.z() * b.z(); });
  auto squared = multiply(n, n, [](const Vec3& a, const Vec3& b) { return a.dot(b); });
  const double largest = *std::max_element(squared.net.begin(), squared.net.end());
  const double length = std::sqrt(std::max(0.0, largest));
  return {rising.degree_u,
          rising.degree_v,
          normals.u,
          normals.v,
          std::move(rising.net),
          std::move(squared.net),
          1e-15 * largest + normals.rounding * std::min(length, normals.rounding)};
}

std::pair<SlantNet, SlantNet> halves(const SlantNet& net, bool along_u) {
  std::pair<SlantNet, SlantNet> out{net, net};
  const int stride = net.degree_v + 1;
  const auto split = [&](std::vector<double>& first, std::vector<double>& second) {
    if (along_u) {
      for (int j = 0; j < stride; ++j) split_in_place(&first[j], &second[j], net.degree_u, stride, 0.5);
    } else {
      for (int i = 0; i <= net.degree_u; ++i) {
        split_in_place(&first[i * stride], &second[i * stride], net.degree_v, 1, 0.5);
      }
    }
  };
  split(out.first.rising, out.second.rising);
  split(out.first.squared, out.second.squared);
  if (along_u) {
    out.first.u.hi = out.second.u.lo = net.u.middle();
  } else {
    out.first.v.hi = out.second.v.lo = net.v.middle();
  }
  return out;
}

SlantRange slant_range(const SlantNet& net) {
  // N_z^2 <= c |N|^2 for every pair of coefficients is the same for the polynomials, which are combinations of them.
  double most = 0.0;
  bool is_known = false;
  for (std::size_t k = 0; k < net.rising.size(); ++k) {
    if (net.squared[k] > net.rounding) {
      is_known = true;
      most = std::max(most, net.rising[k] / net.squared[k]);
    } else if (net.squared[k] < -net.rounding || net.rising[k] > net.rounding) {
      most = 1.0;
    }
  }
  SlantRange range;
  if (is_known) range.bound = std::sqrt(std::clamp(most, 0.0, 1.0));
  const std::size_t stride = static_cast<std::size_t>(net.degree_v) + 1;
  const std::size_t last_row = net.rising.size() - stride;
  for (const std::size_t corner : {std::size_t{0}, stride - 1, last_row, net.rising.size() - 1}) {
    if (!(net.squared[corner] > net.rounding)) continue;
    const double slant = std::sqrt(std::clamp(net.rising[corner] / net.squared[corner], 0.0, 1.0));
    range.least_corner = std::min(range.least_corner, slant);
    range.most_corner = std::max(range.most_corner, slant);
  }
  return range;
}

bool changes_more_in_u(const SlantNet& net) {
  const auto ratio = [&](int i, int j) {
    const std::size_t k = static_cast<std::size_t>(i) * (net.degree_v + 1) + j;
    return net.squared[k] > net.rounding ? std::clamp(net.rising[k] / net.squared[k], -1.0, 2.0) : -2.0;
  };
  double in_u = 0.0;
  double in_v = 0.0;
  const auto difference = [](double a, double b) { return a < -1.5 || b < -1.5 ? 0.0 : std::abs(a - b); };
  for (int i = 0; i <= net.degree_u; ++i) {
    for (int j = 0; j <= net.degree_v; ++j) {
      if (i > 0) in_u = std::max(in_u, net.degree_u * difference(ratio(i, j), ratio(i - 1, j)));
      if (j > 0) in_v = std::max(in_v, net.degree_v * difference(ratio(i, j), ratio(i, j - 1)));
    }
  }
  return in_u >= in_v;
}

}  // namespace lamella
