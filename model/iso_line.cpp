#include "model/iso_line.h"

#include <algorithm>

namespace lamella {

void RevolutionLine::set_nodes(const std::vector<double>& nodes) {
  nodes_.clear();
  nodes_.reserve(nodes.size());
  for (const double v : nodes) nodes_.push_back(evaluate<3>(surface_.meridian, v));
}

void RevolutionLine::set_u(double u) { rotation_ = Eigen::AngleAxisd(u, surface_.axis_direction).toRotationMatrix(); }

SurfacePoint RevolutionLine::turned(const CurvePoint<3>& at) const {
  const Vec3 way = rotation_ * (at.point - surface_.axis_origin);
  return {surface_.axis_origin + way, surface_.axis_direction.cross(way), rotation_ * at.dt};
}

SplineLine::SplineLine(const BSplineSurface& surface)
    : surface_(surface),
      table_u_(surface.knots_u, surface.degree_u),
      table_v_(surface.knots_v, surface.degree_v),
      column_(surface.count_v),
      column_u_(surface.count_v) {
  net_.reserve(surface.poles.size());
  for (std::size_t i = 0; i < surface.poles.size(); ++i) {
    const double w = surface.weights.empty() ? 1.0 : surface.weights[i];
    net_.emplace_back(w * surface.poles[i].x(), w * surface.poles[i].y(), w * surface.poles[i].z(), w);
  }
}

void SplineLine::set_nodes(const std::vector<double>& nodes) {
  const int order = surface_.degree_v + 1;
  first_.clear();
  basis_.clear();
  first_.reserve(nodes.size());
  basis_.resize(2 * nodes.size() * order);
  double* values = basis_.data();
  for (const double v : nodes) {
    first_.push_back(table_v_.evaluate(v, values, values + order));
    values += 2 * order;
  }
}

void SplineLine::set_u(double u) {
  BasisRow values;
  BasisRow slopes;
  const int first = table_u_.evaluate(u, values.data(), slopes.data());
  std::fill(column_.begin(), column_.end(), Vec4::Zero());
  std::fill(column_u_.begin(), column_u_.end(), Vec4::Zero());
  for (int i = 0; i <= surface_.degree_u; ++i) {
    const Vec4* row = net_.data() + static_cast<std::size_t>(first + i) * surface_.count_v;
    const double value = values[i];
    const double slope = slopes[i];
    for (int j = 0; j < surface_.count_v; ++j) {
      column_[j] += value * row[j];
      column_u_[j] += slope * row[j];
    }
  }
}

SurfacePoint SplineLine::at(double v) const {
  BasisRow values;
  BasisRow slopes;
  const int first = table_v_.evaluate(v, values.data(), slopes.data());
  return combine(first, values.data(), slopes.data());
}

SurfacePoint SplineLine::at_node(std::size_t i) const {
  const int order = surface_.degree_v + 1;
  const double* values = basis_.data() + 2 * i * order;
  return combine(first_[i], values, values + order);
}

SurfacePoint SplineLine::combine(int first, const double* value, const double* slope) const {
  Vec4 point = Vec4::Zero();
  Vec4 du = Vec4::Zero();
  Vec4 dv = Vec4::Zero();
  for (int j = 0; j <= surface_.degree_v; ++j) {
    point += value[j] * column_[first + j];
    du += value[j] * column_u_[first + j];
    dv += slope[j] * column_[first + j];
  }
  if (surface_.weights.empty()) return {point.head<3>(), du.head<3>(), dv.head<3>()};
  const double w = point[3];
  const Vec3 place = point.head<3>() / w;
  return {place, (du.head<3>() - du[3] * place) / w, (dv.head<3>() - dv[3] * place) / w};
}

BSplineCurve<3> iso_curve(const BSplineSurface& surface, bool along_v, double at) {
  const Basis basis = along_v ? evaluate_basis(surface.knots_u, surface.degree_u, at, 0)
                              : evaluate_basis(surface.knots_v, surface.degree_v, at, 0);
  BSplineCurve<3> curve;
  curve.degree = along_v ? surface.degree_v : surface.degree_u;
  curve.knots = along_v ? surface.knots_v : surface.knots_u;
  const int count = along_v ? surface.count_v : surface.count_u;
  const int terms = (along_v ? surface.degree_u : surface.degree_v) + 1;
  for (int k = 0; k < count; ++k) {
    Vec3 pole = Vec3::Zero();
    double weight = 0.0;
    for (int i = 0; i < terms; ++i) {
      const std::size_t row = along_v ? basis.first + i : k;
      const std::size_t index = row * surface.count_v + (along_v ? k : basis.first + i);
      const double w = basis.derivative[0][i] * (surface.weights.empty() ? 1.0 : surface.weights[index]);
      pole += w * surface.poles[index];
      weight += w;
    }
    curve.poles.push_back(pole / weight);
    if (!surface.weights.empty()) curve.weights.push_back(weight);
  }
  return curve;
}

std::vector<double> crease_knots(const BSplineSurface& surface, bool along_v, Interval range) {
  const std::vector<double>& knots = along_v ? surface.knots_u : surface.knots_v;
  const auto degree = static_cast<std::ptrdiff_t>(along_v ? surface.degree_u : surface.degree_v);
  std::vector<double> creases;
  for (auto first = knots.begin(); first != knots.end();) {
    const auto last = std::upper_bound(first, knots.end(), *first);
    if (last - first >= degree && *first > range.lo && *first < range.hi) creases.push_back(*first);
    first = last;
  }
  return creases;
}

}  // namespace lamella
