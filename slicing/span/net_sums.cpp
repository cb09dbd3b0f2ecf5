// Compiled once for each level of the architecture, with LAMELLA_LEVEL in the functions' names. Nothing in here may
// have external linkage but those functions, and no inline function of a header may be used: at link time one copy of
// those would be kept, perhaps one with instructions that an older machine lacks.

#include "slicing/span/bernstein_rows.h"
#include "slicing/span/net_kernel.h"

namespace lamella::span {

namespace {

/// One pole or sum, at any address.
typedef double Quad __attribute__((vector_size(32), aligned(8), may_alias));

using Row = BernsteinRow<double>;

/// `count_v` is a constant for the usual degrees, so that the inner loops are unrolled.
template <bool Bends>
inline __attribute__((always_inline)) void contract(const double* net, int count_u, int count_v, const Row& bu,
                                                    const Row& bv, double* out) {
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
  Row bu, bv;
  if (u.degree == 3 && v.degree == 3) {
    fill_cubic<Bends>(u.place, u.scale, bu);
    fill_cubic<Bends>(v.place, v.scale, bv);
    return contract<Bends>(net, 4, 4, bu, bv, sums);
  }
  fill_row<Bends>(u.degree, u.place, u.scale, bu);
  fill_row<Bends>(v.degree, v.place, v.scale, bv);
  const int count_u = u.degree + 1;
  switch (v.degree) {
    case 1:
      return contract<Bends>(net, count_u, 2, bu, bv, sums);
    case 2:
      return contract<Bends>(net, count_u, 3, bu, bv, sums);
    case 3:
      return contract<Bends>(net, count_u, 4, bu, bv, sums);
    case 5:
      return contract<Bends>(net, count_u, 6, bu, bv, sums);
    default:
      return contract<Bends>(net, count_u, v.degree + 1, bu, bv, sums);
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
  Row row;
  fill_row<true>(t.degree, t.place, t.scale, row);
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
