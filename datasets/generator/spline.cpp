#include "datasets/generator/spline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace lamella::datasets {
namespace {

using Vec4 = std::array<double, 4>;

Vec4 lifted(const Point& p, double w) { return {p[0] * w, p[1] * w, p[2] * w, w}; }

double weight_at(const std::vector<double>& weights, std::size_t i) { return weights.empty() ? 1.0 : weights[i]; }

/// Index of the knot span [knots[s], knots[s+1]) that holds t, within the valid range.
int span_of(const std::vector<double>& knots, int degree, double t) {
  const int last = static_cast<int>(knots.size()) - degree - 2;
  int s = degree;
  while (s < last && t >= knots[s + 1]) ++s;
  return s;
}

struct Jet {
  Vec4 value{}, derivative{};
};

/// De Boor's algorithm on homogeneous poles; the last step's two points give the derivative.
Jet de_boor(const std::vector<double>& knots, int degree, std::vector<Vec4> d, int span, double t) {
  for (int level = 1; level < degree; ++level) {
    for (int i = degree; i >= level; --i) {
      const int k = span - degree + i;
      const double a = (t - knots[k]) / (knots[k + degree - level + 1] - knots[k]);
      for (int c = 0; c < 4; ++c) d[i][c] = (1 - a) * d[i - 1][c] + a * d[i][c];
    }
  }
  const double width = knots[span + 1] - knots[span];
  const double a = (t - knots[span]) / width;
  Jet jet;
  for (int c = 0; c < 4; ++c) {
    jet.value[c] = (1 - a) * d[degree - 1][c] + a * d[degree][c];
    jet.derivative[c] = degree * (d[degree][c] - d[degree - 1][c]) / width;
  }
  return jet;
}

std::vector<double> distinct(const std::vector<double>& knots, int degree) {
  std::vector<double> result(knots.begin() + degree, knots.end() - degree);
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

Point projected(const Vec4& p) { return {p[0] / p[3], p[1] / p[3], p[2] / p[3]}; }

Point projected_derivative(const Vec4& p, const Vec4& d) {
  Point result;
  for (int c = 0; c < 3; ++c) result[c] = (d[c] - p[c] / p[3] * d[3]) / p[3];
  return result;
}

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Rule {
  std::array<double, 12> nodes, weights;
};

/// Gauss-Legendre nodes on [-1, 1]: Newton's method on the Legendre recursion.
const Rule& gauss12() {
  static const Rule rule = [] {
    Rule r{};
    constexpr int n = 12;
    for (int i = 0; i < n; ++i) {
      double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5));
      double slope = 1.0;
      for (int step = 0; step < 50; ++step) {
        double p0 = 1.0, p1 = x;
        for (int k = 2; k <= n; ++k) {
          const double p2 = ((2 * k - 1) * x * p1 - (k - 1) * p0) / k;
          p0 = p1;
          p1 = p2;
        }
        slope = n * (x * p1 - p0) / (x * x - 1);
        x -= p1 / slope;
      }
      r.nodes[i] = x;
      r.weights[i] = 2 / ((1 - x * x) * slope * slope);
    }
    return r;
  }();
  return rule;
}

}  // namespace

std::vector<double> greville(const std::vector<double>& knots, int degree) {
  std::vector<double> result(knots.size() - degree - 1);
  for (std::size_t i = 0; i < result.size(); ++i) {
    double sum = 0.0;
    for (int k = 1; k <= degree; ++k) sum += knots[i + k];
    result[i] = sum / degree;
  }
  return result;
}

std::vector<double> clamped_knots(const std::vector<double>& breaks, int degree) {
  std::vector<double> knots(degree, breaks.front());
  knots.insert(knots.end(), breaks.begin(), breaks.end());
  knots.insert(knots.end(), degree, breaks.back());
  return knots;
}

std::vector<double> periodic_knots(int count, int degree) {
  std::vector<double> knots;
  for (int k = -degree; k <= count + degree; ++k) knots.push_back(k);
  return knots;
}

SplineCurve::Frame SplineCurve::frame(double t) const {
  const int s = span_of(knots, degree, t);
  std::vector<Vec4> d(degree + 1);
  for (int i = 0; i <= degree; ++i) d[i] = lifted(poles[s - degree + i], weight_at(weights, s - degree + i));
  const Jet jet = de_boor(knots, degree, d, s, t);
  return {projected(jet.value), projected_derivative(jet.value, jet.derivative)};
}

std::vector<double> SplineCurve::breaks() const { return distinct(knots, degree); }
std::vector<double> SplineSurface::breaks_u() const { return distinct(knots_u, degree_u); }
std::vector<double> SplineSurface::breaks_v() const { return distinct(knots_v, degree_v); }

SplineSurface::Frame SplineSurface::frame(double u, double v) const {
  const int su = span_of(knots_u, degree_u, u), sv = span_of(knots_v, degree_v, v);
  std::vector<Vec4> across(degree_u + 1), slopes(degree_u + 1);
  for (int i = 0; i <= degree_u; ++i) {
    std::vector<Vec4> d(degree_v + 1);
    for (int j = 0; j <= degree_v; ++j) {
      const std::size_t k = static_cast<std::size_t>(su - degree_u + i) * count_v + (sv - degree_v + j);
      d[j] = lifted(poles[k], weight_at(weights, k));
    }
    const Jet jet = de_boor(knots_v, degree_v, d, sv, v);
    across[i] = jet.value;
    slopes[i] = jet.derivative;
  }
  const Jet along = de_boor(knots_u, degree_u, across, su, u);
  const Jet slope = de_boor(knots_u, degree_u, slopes, su, u);
  return {projected(along.value), projected_derivative(along.value, along.derivative),
          projected_derivative(along.value, slope.value)};
}

SplineCurve closed_spline(const std::vector<Point>& poles, int degree) {
  SplineCurve curve{degree, periodic_knots(static_cast<int>(poles.size()), degree), poles, {}};
  for (int i = 0; i < degree; ++i) curve.poles.push_back(poles[i]);
  return curve;
}

SplineCurve graph_spline(const std::vector<double>& breaks, const std::vector<double>& values, int degree) {
  SplineCurve curve{degree, clamped_knots(breaks, degree), {}, {}};
  const std::vector<double> x = greville(curve.knots, degree);
  if (x.size() != values.size()) throw std::logic_error("graph_spline: one value per pole is needed");
  for (std::size_t i = 0; i < x.size(); ++i) curve.poles.push_back({x[i], values[i], 0.0});
  return curve;
}

double integrate(double a, double b, const std::function<double(double)>& f) {
  const Rule& rule = gauss12();
  double sum = 0.0;
  for (std::size_t i = 0; i < rule.nodes.size(); ++i)
    sum += rule.weights[i] * f(0.5 * (a + b) + 0.5 * (b - a) * rule.nodes[i]);
  return 0.5 * (b - a) * sum;
}

double integrate(const std::vector<double>& breaks, const std::function<double(double)>& f, int parts) {
  double sum = 0.0;
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double step = (breaks[i + 1] - breaks[i]) / parts;
    for (int k = 0; k < parts; ++k) sum += integrate(breaks[i] + k * step, breaks[i] + (k + 1) * step, f);
  }
  return sum;
}

double revolved_volume(const SplineCurve& profile, double from, double to) {
  std::vector<double> breaks{from};
  for (const double b : profile.breaks())
    if (b > from && b < to) breaks.push_back(b);
  breaks.push_back(to);
  return std::numbers::pi * integrate(breaks, [&](double x) {
           const double r = profile.point(x)[1];
           return r * r;
         });
}

namespace {

double flux(const SplineSurface& s, int parts, const std::function<double(const Point&, const Point&)>& density) {
  return integrate(
      s.breaks_u(),
      [&](double u) {
        return integrate(
            s.breaks_v(),
            [&](double v) {
              const auto f = s.frame(u, v);
              return density(f.point, cross(f.du, f.dv));
            },
            parts);
      },
      parts);
}

}  // namespace

double y_flux(const SplineSurface& surface, int parts) {
  return flux(surface, parts, [](const Point& p, const Point& n) { return p[1] * n[1]; });
}

double radial_flux(const SplineSurface& surface, int parts) {
  return flux(surface, parts,
              [](const Point& p, const Point& n) { return (p[0] * n[0] + p[1] * n[1] + p[2] * n[2]) / 3; });
}

}  // namespace lamella::datasets
