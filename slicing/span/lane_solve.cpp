// Compiled once for each level of the architecture, with LAMELLA_LEVEL in the functions' names. Nothing in here may
// have external linkage but those functions, and no inline function of a header may be used but those of
// bernstein_rows.h: at link time one copy of those would be kept, perhaps one with instructions that an older machine
// lacks.

#include "slicing/span/bernstein_rows.h"
#include "slicing/span/lane_kernel.h"
#include "slicing/span/net_kernel.h"

namespace lamella::span {

namespace {

#if defined(__AVX512F__)
constexpr int kWidth = 8;
#elif defined(__AVX__)
constexpr int kWidth = 4;
#else
constexpr int kWidth = 2;
#endif

/// Some lanes of one quantity, as many as the machine's vectors hold; and the same at any address.
typedef double Vector __attribute__((vector_size(kWidth * sizeof(double))));
typedef double Unaligned __attribute__((vector_size(kWidth * sizeof(double)), aligned(8), may_alias));
/// One pole or sum of a net.
typedef double Quad __attribute__((vector_size(32), aligned(8), may_alias));

#define LAMELLA_INLINE inline __attribute__((always_inline))

LAMELLA_INLINE Vector get(const double* lanes) { return *reinterpret_cast<const Unaligned*>(lanes); }
LAMELLA_INLINE void put(const Vector& quantity, double* lanes) { *reinterpret_cast<Unaligned*>(lanes) = quantity; }

LAMELLA_INLINE Vector root(const Vector& square) {
  Vector result = square;
  for (int i = 0; i < kWidth; ++i) result[i] = __builtin_sqrt(square[i]);
  return result;
}

struct Triple {
  Vector x, y, z;
};

LAMELLA_INLINE Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
LAMELLA_INLINE Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
LAMELLA_INLINE Triple operator*(const Triple& a, const Vector& f) { return {a.x * f, a.y * f, a.z * f}; }
LAMELLA_INLINE Vector dot(const Triple& a, const Triple& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// The derivative number `order` of a jet, from lane k on.
LAMELLA_INLINE Triple triple(const JetLanes& jets, int order, int k) {
  return {get(jets.value[3 * order] + k), get(jets.value[3 * order + 1] + k), get(jets.value[3 * order + 2] + k)};
}

LAMELLA_INLINE void put(const Triple& a, int order, int k, JetLanes& jets) {
  put(a.x, jets.value[3 * order] + k);
  put(a.y, jets.value[3 * order + 1] + k);
  put(a.z, jets.value[3 * order + 2] + k);
}

using Rows = BernsteinRow<Vector>;

/// Sums of one lane's net with that lane's Bernstein polynomials.
template <bool Bends>
LAMELLA_INLINE void contract(const double* net, int count_u, int count_v, const Rows& bu, const Rows& bv, int lane,
                             Quad* sums) {
  const Quad zero = {0.0, 0.0, 0.0, 0.0};
  Quad s = zero, su = zero, sv = zero, suu = zero, suv = zero, svv = zero;
  const Quad* pole = reinterpret_cast<const Quad*>(net);
  for (int i = 0; i < count_u; ++i, pole += count_v) {
    Quad r = bv.value[0][lane] * pole[0];
    Quad rv = bv.slope[0][lane] * pole[0];
    Quad rvv = zero;
    if (Bends) rvv = bv.bend[0][lane] * pole[0];
    for (int j = 1; j < count_v; ++j) {
      r += bv.value[j][lane] * pole[j];
      rv += bv.slope[j][lane] * pole[j];
      if (Bends) rvv += bv.bend[j][lane] * pole[j];
    }
    s += bu.value[i][lane] * r;
    su += bu.slope[i][lane] * r;
    sv += bu.value[i][lane] * rv;
    if (!Bends) continue;
    suu += bu.bend[i][lane] * r;
    suv += bu.slope[i][lane] * rv;
    svv += bu.value[i][lane] * rvv;
  }
  sums[0] = s;
  sums[1] = su;
  sums[2] = sv;
  if (!Bends) return;
  sums[3] = suu;
  sums[4] = suv;
  sums[5] = svv;
}

template <bool Bends>
LAMELLA_INLINE void contract_any(const double* net, const NetShape& shape, const Rows& bu, const Rows& bv, int lane,
                                 Quad* sums) {
  const int count_u = shape.degree_u + 1;
  switch (shape.degree_v) {
    case 1:
      return contract<Bends>(net, count_u, 2, bu, bv, lane, sums);
    case 2:
      return contract<Bends>(net, count_u, 3, bu, bv, lane, sums);
    case 3:
      return contract<Bends>(net, count_u, 4, bu, bv, lane, sums);
    case 5:
      return contract<Bends>(net, count_u, 6, bu, bv, lane, sums);
    default:
      return contract<Bends>(net, count_u, shape.degree_v + 1, bu, bv, lane, sums);
  }
}

/// Weights of the jets, beside JetLanes: order by order.
using Weights = Vector[6];

/// Quotients by Leibniz' rule on numerator = weight * point.
LAMELLA_INLINE void divide(const Weights& w, bool bends, int k, JetLanes& jets) {
  const Vector inverse = 1.0 / w[0];
  const Triple s = triple(jets, 0, k) * inverse;
  const Triple su = (triple(jets, 1, k) - s * w[1]) * inverse;
  const Triple sv = (triple(jets, 2, k) - s * w[2]) * inverse;
  put(s, 0, k, jets);
  put(su, 1, k, jets);
  put(sv, 2, k, jets);
  if (!bends) return;
  put((triple(jets, 3, k) - su * (2.0 * w[1]) - s * w[3]) * inverse, 3, k, jets);
  put((triple(jets, 4, k) - sv * w[1] - su * w[2] - s * w[4]) * inverse, 4, k, jets);
  put((triple(jets, 5, k) - sv * (2.0 * w[2]) - s * w[5]) * inverse, 5, k, jets);
}

template <bool Bends>
LAMELLA_INLINE void sum_lanes(const NetShape& shape, const NetLanes& nets, int k, int count, JetLanes& out) {
  Rows bu, bv;
  fill_row<Bends>(shape.degree_u, get(nets.place_u + k), get(nets.scale_u + k), bu);
  fill_row<Bends>(shape.degree_v, get(nets.place_v + k), get(nets.scale_v + k), bv);
  constexpr int kOrders = Bends ? 6 : 3;
  Weights weights;
  Quad sums[kOrders] = {};
  for (int lane = 0; lane < kWidth; ++lane) {
    if (k + lane >= count) {
      // Like the last one.
    } else if (shape.degree_u == 3 && shape.degree_v == 3) {
      contract<Bends>(nets.net[k + lane], 4, 4, bu, bv, lane, sums);
    } else {
      contract_any<Bends>(nets.net[k + lane], shape, bu, bv, lane, sums);
    }
    for (int order = 0; order < kOrders; ++order) {
      for (int axis = 0; axis < 3; ++axis) out.value[3 * order + axis][k + lane] = sums[order][axis];
      weights[order][lane] = sums[order][3];
    }
  }
  if (shape.rational) divide(weights, Bends, k, out);
  for (int axis = 0; axis < 3; ++axis) put(shape.origin[axis] + get(out.value[axis] + k), out.value[axis] + k);
}

/// First fundamental form.
struct Metric {
  Vector e, f, g;
};

LAMELLA_INLINE Metric metric_of(const Triple& du, const Triple& dv) { return {dot(du, du), dot(du, dv), dot(dv, dv)}; }

/// (u, v) by z along the given way, or else the steepest one: the metric gradient of z times its determinant.
struct Rise {
  Vector u, v;
};

LAMELLA_INLINE Rise rise_of(const Triple& du, const Triple& dv, const Metric& m, const Vector& way_u,
                            const Vector& way_v) {
  const auto is_free = (way_u == 0.0) & (way_v == 0.0);
  const Vector u = is_free ? m.g * du.z - m.f * dv.z : way_u;
  const Vector v = is_free ? m.e * dv.z - m.f * du.z : way_v;
  const Vector rate = 1.0 / (du.z * u + dv.z * v);
  return {u * rate, v * rate};
}

/// Section_point of section_point.cpp: equations (2) and (3).
LAMELLA_INLINE void put_point(const Triple& du, const Triple& dv, const Triple& duu, const Triple& duv,
                              const Triple& dvv, const Metric& m, double sign, int k, PointLanes& out) {
  const Triple normal = {sign * (du.y * dv.z - du.z * dv.y), sign * (du.z * dv.x - du.x * dv.z),
                         sign * (du.x * dv.y - du.y * dv.x)};
  const Vector horizontal = root(normal.x * normal.x + normal.y * normal.y);
  const Vector inverse = 1.0 / horizontal;
  const Vector tx = -normal.y * inverse;
  const Vector ty = normal.x * inverse;
  const Vector us = dv.z * (sign * inverse);
  const Vector vs = -du.z * (sign * inverse);
  const Triple bend = duu * (us * us) + duv * (2.0 * us * vs) + dvv * (vs * vs);
  const Vector curvature = -dot(normal, bend) * inverse;
  const Triple rest = {-ty * curvature - bend.x, tx * curvature - bend.y, -bend.z};
  const Vector determinant = m.e * m.g - m.f * m.f;
  const Vector per_determinant = 1.0 / determinant;
  const Vector a = dot(du, rest);
  const Vector b = dot(dv, rest);
  put(tx, out.tangent_x + k);
  put(ty, out.tangent_y + k);
  put(curvature, out.curvature + k);
  put(du.z, out.height_u + k);
  put(dv.z, out.height_v + k);
  put(us, out.slope_u + k);
  put(vs, out.slope_v + k);
  put((m.g * a - m.f * b) * per_determinant, out.bend_u + k);
  put((m.e * b - m.f * a) * per_determinant, out.bend_v + k);
  put(m.e, out.metric_e + k);
  put(m.f, out.metric_f + k);
  put(m.g, out.metric_g + k);
  put(horizontal / root(determinant), out.steepness + k);
}

LAMELLA_INLINE void move_lanes(const JetLanes& jets, int k, MoveLanes& move, PointLanes& out) {
  Triple s = triple(jets, 0, k), du = triple(jets, 1, k), dv = triple(jets, 2, k);
  const Triple duu = triple(jets, 3, k), duv = triple(jets, 4, k), dvv = triple(jets, 5, k);
  const Vector way_u = get(move.way_u + k), way_v = get(move.way_v + k);
  const Triple step = du * get(move.step_u + k) + dv * get(move.step_v + k);
  put(root(dot(step, step)), move.moved + k);
  const Rise rise = rise_of(du, dv, metric_of(du, dv), way_u, way_v);
  const Vector left = move.z - s.z;
  const Vector u = left * rise.u, v = left * rise.v;
  const Triple correction = du * u + dv * v;
  put(root(dot(correction, correction)), move.correction + k);
  // As shift() has it: position to second order, first derivatives to first.
  s = s + correction + duu * (0.5 * u * u) + duv * (u * v) + dvv * (0.5 * v * v);
  const Triple more_u = duu * u + duv * v, more_v = duv * u + dvv * v;
  du = du + more_u;
  dv = dv + more_v;
  const Metric metric = metric_of(du, dv);
  const Rise velocity = rise_of(du, dv, metric, way_u, way_v);
  put(velocity.u, move.velocity_u + k);
  put(velocity.v, move.velocity_v + k);
  put(get(move.u + k) + u, out.u + k);
  put(get(move.v + k) + v, out.v + k);
  put(s.x, out.x + k);
  put(s.y, out.y + k);
  put_point(du, dv, duu, duv, dvv, metric, move.sign, k, out);
}

/// Value and first two derivatives by t at one end of a piece along one axis.
struct End {
  Vector value, slope, bend;
};

LAMELLA_INLINE void put_quintic(const End& a, const End& b, int k, Lane* out) {
  const Vector h = 0.5 * a.bend;
  const Vector rest = b.value - a.value - a.slope - h;
  const Vector slope_rest = b.slope - a.slope - 2.0 * h;
  const Vector bend_rest = b.bend - 2.0 * h;
  put(a.value, out[0] + k);
  put(a.slope, out[1] + k);
  put(h, out[2] + k);
  put(10.0 * rest - 4.0 * slope_rest + 0.5 * bend_rest, out[3] + k);
  put(-15.0 * rest + 7.0 * slope_rest - bend_rest, out[4] + k);
  put(6.0 * rest - 3.0 * slope_rest + 0.5 * bend_rest, out[5] + k);
}

/// Both ends' values at t = 1/2: Hermite's basis there.
LAMELLA_INLINE Vector middle_of(const End& a, const End& b) {
  return 0.5 * (a.value + b.value) + 0.15625 * (a.slope - b.slope) + 0.015625 * (a.bend + b.bend);
}

/// One end of a piece: derivatives by t = w . (u, v) / span from those by arc length, equation (6).
struct PieceEnd {
  End x, y, u, v;
  Vector rate;  ///< dt / ds
};

LAMELLA_INLINE PieceEnd end_of(const RunLanes& p, int i, const Vector& weight_u, const Vector& weight_v,
                               const Vector& per_span) {
  const Vector us = get(p.slope_u + i), vs = get(p.slope_v + i);
  const Vector uss = get(p.bend_u + i), vss = get(p.bend_v + i);
  const Vector tx = get(p.tangent_x + i), ty = get(p.tangent_y + i), curvature = get(p.curvature + i);
  PieceEnd end;
  end.rate = (weight_u * us + weight_v * vs) * per_span;
  const Vector per_rate = 1.0 / end.rate;
  const Vector drift = (weight_u * uss + weight_v * vss) * per_span * per_rate;
  const Vector square = per_rate * per_rate;
  end.x = {get(p.x + i), tx * per_rate, (-curvature * ty - drift * tx) * square};
  end.y = {get(p.y + i), ty * per_rate, (curvature * tx - drift * ty) * square};
  end.u = {get(p.u + i), us * per_rate, (uss - drift * us) * square};
  end.v = {get(p.v + i), vs * per_rate, (vss - drift * vs) * square};
  return end;
}

/// As is_even of arc_piece.cpp.
LAMELLA_INLINE Vector evenness(const Vector& first, const Vector& second, const Vector& span) {
  const Vector zero = {};
  const auto is_even = (first > 0.4) & (first < 2.5) & (second > 0.4) & (second < 2.5) & (span > 0.0);
  return is_even ? zero + 1.0 : zero;
}

LAMELLA_INLINE void join_lanes(const RunLanes& p, int k, PieceLanes& out) {
  const Vector du = get(p.u + k + 1) - get(p.u + k), dv = get(p.v + k + 1) - get(p.v + k);
  const Vector e = 0.5 * (get(p.metric_e + k) + get(p.metric_e + k + 1));
  const Vector f = 0.5 * (get(p.metric_f + k) + get(p.metric_f + k + 1));
  const Vector g = 0.5 * (get(p.metric_g + k) + get(p.metric_g + k + 1));
  const Vector weight_u = e * du + f * dv, weight_v = f * du + g * dv;
  const Vector span = weight_u * du + weight_v * dv;
  const Vector per_span = 1.0 / span;
  const PieceEnd a = end_of(p, k, weight_u, weight_v, per_span);
  const PieceEnd b = end_of(p, k + 1, weight_u, weight_v, per_span);
  const Vector dx = b.x.value - a.x.value, dy = b.y.value - a.y.value;
  const Vector chord = root(dx * dx + dy * dy);
  put_quintic(a.x, b.x, k, out.x);
  put_quintic(a.y, b.y, k, out.y);
  put_quintic(a.u, b.u, k, out.u);
  put_quintic(a.v, b.v, k, out.v);
  put(weight_u, out.weight_u + k);
  put(weight_v, out.weight_v + k);
  put(chord, out.chord + k);
  put(get(p.tangent_x + k) * get(p.tangent_x + k + 1) + get(p.tangent_y + k) * get(p.tangent_y + k + 1), out.turn + k);
  put(evenness(a.rate * chord, b.rate * chord, span), out.is_even + k);
  put(middle_of(a.u, b.u), out.middle_u + k);
  put(middle_of(a.v, b.v), out.middle_v + k);
  put(middle_of(a.x, b.x), out.middle_x + k);
  put(middle_of(a.y, b.y), out.middle_y + k);
}

LAMELLA_INLINE void measure_lanes(const JetLanes& jets, int k, MeasureLanes& lanes) {
  const Triple s = triple(jets, 0, k);
  const Triple move = triple(jets, 1, k) * get(lanes.aside_u + k) + triple(jets, 2, k) * get(lanes.aside_v + k);
  const Vector amount = (lanes.z - s.z) / move.z;
  const Vector x = get(lanes.x + k) - s.x - amount * move.x;
  const Vector y = get(lanes.y + k) - s.y - amount * move.y;
  put(root(x * x + y * y), lanes.error + k);
}

LAMELLA_INLINE void distance_lanes(const JetLanes& jets, int k, MeasureLanes& lanes) {
  const Triple s = triple(jets, 0, k), du = triple(jets, 1, k), dv = triple(jets, 2, k);
  const Vector nx = du.y * dv.z - du.z * dv.y, ny = du.z * dv.x - du.x * dv.z, nz = du.x * dv.y - du.y * dv.x;
  const Vector off = nx * (get(lanes.x + k) - s.x) + ny * (get(lanes.y + k) - s.y) + nz * (lanes.z - s.z);
  put(root(off * off / (nx * nx + ny * ny)), lanes.error + k);
}

}  // namespace

#define LAMELLA_JOIN(name, level) name##_##level
#define LAMELLA_NAME(name, level) LAMELLA_JOIN(name, level)

void LAMELLA_NAME(jets, LAMELLA_LEVEL)(const NetShape& shape, const NetLanes& nets, int count, bool bends,
                                       JetLanes& out);
void LAMELLA_NAME(move, LAMELLA_LEVEL)(const JetLanes& jets, int count, MoveLanes& move, PointLanes& out);
void LAMELLA_NAME(join, LAMELLA_LEVEL)(const RunLanes& points, int count, PieceLanes& out);
void LAMELLA_NAME(measure, LAMELLA_LEVEL)(const JetLanes& jets, int count, MeasureLanes& lanes);
void LAMELLA_NAME(distance, LAMELLA_LEVEL)(const JetLanes& jets, int count, MeasureLanes& lanes);

void LAMELLA_NAME(jets, LAMELLA_LEVEL)(const NetShape& shape, const NetLanes& nets, int count, bool bends,
                                       JetLanes& out) {
  for (int k = 0; k < count; k += kWidth) {
    if (bends) {
      sum_lanes<true>(shape, nets, k, count, out);
    } else {
      sum_lanes<false>(shape, nets, k, count, out);
    }
  }
}

void LAMELLA_NAME(move, LAMELLA_LEVEL)(const JetLanes& jets, int count, MoveLanes& move, PointLanes& out) {
  for (int k = 0; k < count; k += kWidth) move_lanes(jets, k, move, out);
}

void LAMELLA_NAME(join, LAMELLA_LEVEL)(const RunLanes& points, int count, PieceLanes& out) {
  for (int k = 0; k < count; k += kWidth) join_lanes(points, k, out);
}

void LAMELLA_NAME(measure, LAMELLA_LEVEL)(const JetLanes& jets, int count, MeasureLanes& lanes) {
  for (int k = 0; k < count; k += kWidth) measure_lanes(jets, k, lanes);
}

void LAMELLA_NAME(distance, LAMELLA_LEVEL)(const JetLanes& jets, int count, MeasureLanes& lanes) {
  for (int k = 0; k < count; k += kWidth) distance_lanes(jets, k, lanes);
}

}  // namespace lamella::span
