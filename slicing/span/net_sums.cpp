// Compiled once for each level of the architecture, with LAMELLA_LEVEL in the functions' names. Nothing in here may
// have external linkage but those functions, and no inline function of a header may be used: at link time one copy of
// those would be kept, perhaps one with instructions that an older machine lacks.

#include "slicing/span/net_kernel.h"

namespace lamella::span {

namespace {

constexpr int kMostPoles = 26;  // kMaxDegree + 1

/// One pole or sum, at any address.
typedef double Quad __attribute__((vector_size(32), aligned(8), may_alias));

/// Bernstein polynomials of one degree with first and, if asked for, second derivatives at a place.
struct BernsteinRow {
  double value[kMostPoles];
  double slope[kMostPoles];
  double bend[kMostPoles];
};

/// One step of the triangular recursion: degree n - 1 to n, in place.
inline void raise(double* b, int n, double s) {
  const double r = 1.0 - s;
  b[n] = s * b[n - 1];
  for (int i = n - 1; i > 0; --i) b[i] = r * b[i] + s * b[i - 1];
  b[0] = r * b[0];
}

/// The derivative's row from that of one degree less: factor (b[i - 1] - b[i]).
inline void differ(const double* b, int degree, double factor, double* out) {
  out[0] = -factor * b[0];
  for (int i = 1; i < degree; ++i) out[i] = factor * (b[i - 1] - b[i]);
  out[degree] = factor * b[degree - 1];
}

template <bool Bends>
void fill_general(int degree, double s, double scale, BernsteinRow& row) {
  double* b = row.value;
  b[0] = 1.0;
  for (int n = 1; n <= degree - 2; ++n) raise(b, n, s);
  if (Bends) {
    row.bend[0] = 0.0;
    for (int i = 1; i <= degree; ++i) row.bend[i] = 0.0;
  }
  if (degree >= 2) {
    if (Bends) {
      double first[kMostPoles];
      differ(b, degree - 1, (degree - 1) * scale, first);
      differ(first, degree, degree * scale, row.bend);
    }
    raise(b, degree - 1, s);
  }
  row.slope[0] = 0.0;
  if (degree >= 1) {
    differ(b, degree, degree * scale, row.slope);
    raise(b, degree, s);
  }
}

/// The degree of most surfaces, written out.
template <bool Bends>
inline void fill_cubic(double s, double scale, BernsteinRow& row) {
  const double r = 1.0 - s;
  const double rr = r * r, rs = r * s, ss = s * s;
  row.value[0] = r * rr;
  row.value[1] = 3.0 * s * rr;
  row.value[2] = 3.0 * r * ss;
  row.value[3] = s * ss;
  const double d = 3.0 * scale;
  row.slope[0] = -d * rr;
  row.slope[1] = d * (rr - 2.0 * rs);
  row.slope[2] = d * (2.0 * rs - ss);
  row.slope[3] = d * ss;
  if (!Bends) return;
  const double e = 6.0 * scale * scale;
  row.bend[0] = e * r;
  row.bend[1] = e * (s - 2.0 * r);
  row.bend[2] = e * (r - 2.0 * s);
  row.bend[3] = e * s;
}

template <bool Bends>
inline void fill_row(const NetPlace& at, BernsteinRow& row) {
  if (at.degree == 3) {
    fill_cubic<Bends>(at.place, at.scale, row);
  } else {
    fill_general<Bends>(at.degree, at.place, at.scale, row);
  }
}

/// Counts are constants where the compiler can unroll.
template <bool Bends>
inline __attribute__((always_inline)) void contract(const double* net, int count_u, int count_v, const BernsteinRow& bu,
                                                    const BernsteinRow& bv, double* out) {
  const Quad zero = {0.0, 0.0, 0.0, 0.0};
  Quad s = zero, su = zero, sv = zero, suu = zero, suv = zero, svv = zero;
  const Quad* pole = reinterpret_cast<const Quad*>(net);
  for (int i = 0; i < count_u; ++i, pole += count_v) {
    Quad r = bv.value[0] * pole[0];
    Quad rv = bv.slope[0] * pole[0];
    Quad rvv = zero;
    if (Bends) rvv = bv.bend[0] * pole[0];
    for (int j = 1; j < count_v; ++j) {
      r += bv.value[j] * pole[j];
      rv += bv.slope[j] * pole[j];
      if (Bends) rvv += bv.bend[j] * pole[j];
    }
    s += bu.value[i] * r;
    su += bu.slope[i] * r;
    sv += bu.value[i] * rv;
    if (Bends) {
      suu += bu.bend[i] * r;
      suv += bu.slope[i] * rv;
      svv += bu.value[i] * rvv;
    }
  }
  Quad* sums = reinterpret_cast<Quad*>(out);
  sums[0] = s;
  sums[1] = su;
  sums[2] = sv;
  if (!Bends) return;
  sums[3] = suu;
  sums[4] = suv;
  sums[5] = svv;
}

template <bool Bends>
inline void sum_surface(const double* net, const NetPlace& u, const NetPlace& v, double* sums) {
  BernsteinRow bu, bv;
  fill_row<Bends>(u, bu);
  fill_row<Bends>(v, bv);
  if (u.degree == 3 && v.degree == 3) {
    contract<Bends>(net, 4, 4, bu, bv, sums);
  } else {
    contract<Bends>(net, u.degree + 1, v.degree + 1, bu, bv, sums);
  }
}

}  // namespace

#define LAMELLA_JOIN(name, level) name##_##level
#define LAMELLA_NAME(name, level) LAMELLA_JOIN(name, level)

void LAMELLA_NAME(surface_slopes, LAMELLA_LEVEL)(const double*, const NetPlace&, const NetPlace&, double*);
void LAMELLA_NAME(surface_bends, LAMELLA_LEVEL)(const double*, const NetPlace&, const NetPlace&, double*);
void LAMELLA_NAME(curve, LAMELLA_LEVEL)(const double*, const NetPlace&, double*);

void LAMELLA_NAME(surface_slopes, LAMELLA_LEVEL)(const double* net, const NetPlace& u, const NetPlace& v,
                                                 double* sums) {
  sum_surface<false>(net, u, v, sums);
}

void LAMELLA_NAME(surface_bends, LAMELLA_LEVEL)(const double* net, const NetPlace& u, const NetPlace& v, double* sums) {
  sum_surface<true>(net, u, v, sums);
}

void LAMELLA_NAME(curve, LAMELLA_LEVEL)(const double* net, const NetPlace& t, double* sums) {
  BernsteinRow row;
  fill_row<true>(t, row);
  const Quad* pole = reinterpret_cast<const Quad*>(net);
  Quad c = row.value[0] * pole[0];
  Quad ct = row.slope[0] * pole[0];
  Quad ctt = row.bend[0] * pole[0];
  for (int i = 1; i <= t.degree; ++i) {
    c += row.value[i] * pole[i];
    ct += row.slope[i] * pole[i];
    ctt += row.bend[i] * pole[i];
  }
  Quad* out = reinterpret_cast<Quad*>(sums);
  out[0] = c;
  out[1] = ct;
  out[2] = ctt;
}

}  // namespace lamella::span
