#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include "model/curve.h"
#include "model/surface.h"

/// Random B-splines with multiple knots for tests, and the textbook definition of their basis as an oracle.
namespace lamella::test {

class RandomGeometry {
 public:
  explicit RandomGeometry(unsigned seed) : engine_(seed) {}

  double real(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  int integer(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  template <int Dim>
  Vec<Dim> point(double size = 10.0) {
    Vec<Dim> result;
    for (int i = 0; i < Dim; ++i) result[i] = real(-size, size);
    return result;
  }

  /// Clamped knots with up to `spans` spans; inner knots up to `degree` times.
  std::vector<double> knots(int degree, int spans) {
    double knot = real(-3.0, 3.0);
    std::vector<double> result(degree + 1, knot);
    for (int i = 1; i < spans; ++i) {
      knot += real(0.05, 1.0);
      result.insert(result.end(), integer(1, degree), knot);
    }
    result.insert(result.end(), degree + 1, knot + real(0.05, 1.0));
    return result;
  }

  std::vector<double> weights(std::size_t count) {
    std::vector<double> result(count);
    for (double& weight : result) weight = real(0.1, 5.0);
    return result;
  }

  template <int Dim>
  BSplineCurve<Dim> curve(int degree, int spans, bool rational) {
    BSplineCurve<Dim> result{degree, knots(degree, spans), {}, {}};
    for (std::size_t i = degree + 1; i < result.knots.size(); ++i) result.poles.push_back(point<Dim>());
    if (rational) result.weights = weights(result.poles.size());
    return result;
  }

  BSplineSurface surface(int degree_u, int degree_v, int spans, bool rational) {
    BSplineSurface result;
    result.degree_u = degree_u;
    result.degree_v = degree_v;
    result.knots_u = knots(degree_u, spans);
    result.knots_v = knots(degree_v, spans);
    result.count_u = static_cast<int>(result.knots_u.size()) - degree_u - 1;
    result.count_v = static_cast<int>(result.knots_v.size()) - degree_v - 1;
    for (int i = 0; i < result.count_u * result.count_v; ++i) result.poles.push_back(point<3>());
    if (rational) result.weights = weights(result.poles.size());
    return result;
  }

  std::mt19937& engine() { return engine_; }

 private:
  std::mt19937 engine_;
};

/// All B-splines of `degree` at t by their recursive definition, in extended precision; the last span is closed.
inline std::vector<long double> basis_by_definition(const std::vector<double>& knots, int degree, long double t) {
  std::vector<long double> row(knots.size() - 1);
  for (std::size_t i = 0; i < row.size(); ++i) {
    const bool closes = t == knots.back() && knots[i + 1] == knots.back();
    row[i] = knots[i] < knots[i + 1] && knots[i] <= t && (t < knots[i + 1] || closes) ? 1.0L : 0.0L;
  }
  for (int d = 1; d <= degree; ++d) {
    for (std::size_t i = 0; i + d + 1 < knots.size(); ++i) {
      const long double lower = static_cast<long double>(knots[i + d]) - knots[i];
      const long double upper = static_cast<long double>(knots[i + d + 1]) - knots[i + 1];
      row[i] = (lower > 0.0L ? (t - knots[i]) / lower * row[i] : 0.0L) +
               (upper > 0.0L ? (knots[i + d + 1] - t) / upper * row[i + 1] : 0.0L);
    }
  }
  row.resize(knots.size() - degree - 1);
  return row;
}

inline Vec3 point_by_definition(const BSplineSurface& surface, double u, double v) {
  const auto bu = basis_by_definition(surface.knots_u, surface.degree_u, static_cast<long double>(u));
  const auto bv = basis_by_definition(surface.knots_v, surface.degree_v, static_cast<long double>(v));
  Eigen::Matrix<long double, 3, 1> sum = Eigen::Matrix<long double, 3, 1>::Zero();
  long double weight = 0.0L;
  for (int i = 0; i < surface.count_u; ++i) {
    for (int j = 0; j < surface.count_v; ++j) {
      const int index = i * surface.count_v + j;
      const long double factor = bu[i] * bv[j] * (surface.weights.empty() ? 1.0L : surface.weights[index]);
      sum += factor * surface.poles[index].cast<long double>();
      weight += factor;
    }
  }
  return (sum / weight).cast<double>();
}

}  // namespace lamella::test
