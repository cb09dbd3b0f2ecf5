#include "slicing/reference/plane_nets.h"

#include <array>
#include <limits>

namespace lamella::reference {

void project(const SubPatch& sub_patch, const RayPlanes& planes, PlaneNets& nets) {
  const BezierPatch& patch = sub_patch.patch;
  nets.count_u = patch.degree_u + 1;
  nets.count_v = patch.degree_v + 1;
  nets.patch = &patch;
  const std::size_t size = patch.net.size();
  nets.f1.resize(size);
  nets.f2.resize(size);
  const Vec3& o = planes.origin;
  for (std::size_t k = 0; k < size; ++k) {
    const Vec4& pole = patch.net[k];
    const Vec3 relative = pole.head<3>() - pole.w() * o;
    nets.f1[k] = planes.n1.dot(relative);
    nets.f2[k] = planes.n2.dot(relative);
  }
  // Per component: product, difference, product with |n| <= 1, two sums: 5 roundings of numbers up to w |x| + w |o|,
  // over 3 components of a unit normal (1-norm at most sqrt(3)); the normals themselves are rounded once. 16 covers it.
  const double magnitude = sub_patch.max_coordinate + sub_patch.max_weight * o.cwiseAbs().maxCoeff();
  nets.error = 16.0 * std::numeric_limits<double>::epsilon() * magnitude;
}

void bernstein(int count, double t, double* values, double* derivatives) {
  const double s = 1.0 - t;
  values[0] = 1.0;
  if (count == 1) derivatives[0] = 0.0;
  for (int degree = 1; degree < count; ++degree) {
    if (degree == count - 1) {
      // B'_i = n (B_{i-1} - B_i) with the polynomials of one degree less.
      derivatives[0] = -degree * values[0];
      for (int i = 1; i < degree; ++i) derivatives[i] = degree * (values[i - 1] - values[i]);
      derivatives[degree] = degree * values[degree - 1];
    }
    values[degree] = t * values[degree - 1];
    for (int i = degree - 1; i > 0; --i) values[i] = t * values[i - 1] + s * values[i];
    values[0] *= s;
  }
}

PlaneValues evaluate(const PlaneNets& nets, double u, double v) {
  std::array<double, kMaxDegree + 1> bu;
  std::array<double, kMaxDegree + 1> du;
  std::array<double, kMaxDegree + 1> bv;
  std::array<double, kMaxDegree + 1> dv;
  bernstein(nets.count_u, u, bu.data(), du.data());
  bernstein(nets.count_v, v, bv.data(), dv.data());
  PlaneValues result{};
  for (int i = 0; i < nets.count_u; ++i) {
    const double* row1 = &nets.f1[static_cast<std::size_t>(i) * nets.count_v];
    const double* row2 = &nets.f2[static_cast<std::size_t>(i) * nets.count_v];
    double a1 = 0.0, b1 = 0.0, a2 = 0.0, b2 = 0.0;
    for (int j = 0; j < nets.count_v; ++j) {
      a1 += bv[j] * row1[j];
      b1 += dv[j] * row1[j];
      a2 += bv[j] * row2[j];
      b2 += dv[j] * row2[j];
    }
    result.f1 += bu[i] * a1;
    result.f1_u += du[i] * a1;
    result.f1_v += bu[i] * b1;
    result.f2 += bu[i] * a2;
    result.f2_u += du[i] * a2;
    result.f2_v += bu[i] * b2;
  }
  return result;
}

double evaluate_weight(const PlaneNets& nets, double u, double v) {
  std::array<double, kMaxDegree + 1> bu;
  std::array<double, kMaxDegree + 1> bv;
  std::array<double, kMaxDegree + 1> unused;
  bernstein(nets.count_u, u, bu.data(), unused.data());
  bernstein(nets.count_v, v, bv.data(), unused.data());
  double weight = 0.0;
  for (int i = 0; i < nets.count_u; ++i) {
    for (int j = 0; j < nets.count_v; ++j) weight += bu[i] * bv[j] * nets.patch->net[i * nets.count_v + j].w();
  }
  return weight;
}

}  // namespace lamella::reference
