#include "model/iso_line.h"

namespace lamella {

SplineLine::SplineLine(const BSplineSurface& surface)
    : surface_(surface), column_(surface.count_v), column_u_(surface.count_v) {
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
  basis_.reserve(2 * nodes.size() * order);
  for (const double v : nodes) {
    const Basis basis = evaluate_basis(surface_.knots_v, surface_.degree_v, v, 1);
    first_.push_back(basis.first);
    basis_.insert(basis_.end(), basis.derivative[0].begin(), basis.derivative[0].begin() + order);
    basis_.insert(basis_.end(), basis.derivative[1].begin(), basis.derivative[1].begin() + order);
  }
}

void SplineLine::set_u(double u) {
  const Basis basis = evaluate_basis(surface_.knots_u, surface_.degree_u, u, 1);
  std::fill(column_.begin(), column_.end(), Vec4::Zero());
  std::fill(column_u_.begin(), column_u_.end(), Vec4::Zero());
  for (int i = 0; i <= surface_.degree_u; ++i) {
    const Vec4* row = net_.data() + static_cast<std::size_t>(basis.first + i) * surface_.count_v;
    const double value = basis.derivative[0][i];
    const double slope = basis.derivative[1][i];
    for (int j = 0; j < surface_.count_v; ++j) {
      column_[j] += value * row[j];
      column_u_[j] += slope * row[j];
    }
  }
}

SurfacePoint SplineLine::at(double v) const {
  const Basis basis = evaluate_basis(surface_.knots_v, surface_.degree_v, v, 1);
  return combine(basis.first, basis.derivative[0].data(), basis.derivative[1].data());
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

}  // namespace lamella
