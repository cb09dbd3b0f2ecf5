#pragma once

// Bernstein polynomials for the sources that are compiled once for each level of the architecture: everything in here
// has internal linkage, or is forced inline, so that no copy of one level serves another.

namespace lamella::span {

namespace {

constexpr int kMostPoles = 26;  // kMaxDegree + 1

/// Bernstein polynomials of one degree with first and, if asked for, second derivatives at a place. Real is a double,
/// or a vector of them for as many places.
template <class Real>
struct BernsteinRow {
  Real value[kMostPoles];
  Real slope[kMostPoles];
  Real bend[kMostPoles];
};

/// One step of the triangular recursion: degree n - 1 to n, in place.
template <class Real>
inline __attribute__((always_inline)) void raise(Real* b, int n, const Real& s) {
  const Real r = 1.0 - s;
  b[n] = s * b[n - 1];
  for (int i = n - 1; i > 0; --i) b[i] = r * b[i] + s * b[i - 1];
  b[0] = r * b[0];
}

/// The derivative's row from that of one degree less: factor (b[i - 1] - b[i]).
template <class Real>
inline __attribute__((always_inline)) void differ(const Real* b, int degree, const Real& factor, Real* out) {
  out[0] = -factor * b[0];
  for (int i = 1; i < degree; ++i) out[i] = factor * (b[i - 1] - b[i]);
  out[degree] = factor * b[degree - 1];
}

template <bool Bends, class Real>
inline __attribute__((always_inline)) void fill_general(int degree, const Real& s, const Real& scale,
                                                        BernsteinRow<Real>& row) {
  Real* b = row.value;
  b[0] = Real{} + 1.0;
  for (int n = 1; n <= degree - 2; ++n) raise(b, n, s);
  if (Bends) {
    for (int i = 0; i <= degree; ++i) row.bend[i] = Real{};
  }
  if (degree >= 2) {
    if (Bends) {
      Real first[kMostPoles];
      differ<Real>(b, degree - 1, (degree - 1) * scale, first);
      differ<Real>(first, degree, degree * scale, row.bend);
    }
    raise(b, degree - 1, s);
  }
  row.slope[0] = Real{};
  if (degree >= 1) {
    differ<Real>(b, degree, degree * scale, row.slope);
    raise(b, degree, s);
  }
}

/// The degree of most surfaces, written out.
template <bool Bends, class Real>
inline __attribute__((always_inline)) void fill_cubic(const Real& s, const Real& scale, BernsteinRow<Real>& row) {
  const Real r = 1.0 - s;
  const Real rr = r * r, rs = r * s, ss = s * s;
  row.value[0] = r * rr;
  row.value[1] = 3.0 * s * rr;
  row.value[2] = 3.0 * r * ss;
  row.value[3] = s * ss;
  const Real d = 3.0 * scale;
  row.slope[0] = -d * rr;
  row.slope[1] = d * (rr - 2.0 * rs);
  row.slope[2] = d * (2.0 * rs - ss);
  row.slope[3] = d * ss;
  if (!Bends) return;
  const Real e = 6.0 * scale * scale;
  row.bend[0] = e * r;
  row.bend[1] = e * (s - 2.0 * r);
  row.bend[2] = e * (r - 2.0 * s);
  row.bend[3] = e * s;
}

/// Where the degree is a constant, the loops are unrolled.
template <bool Bends, class Real>
void fill_row(int degree, const Real& place, const Real& scale, BernsteinRow<Real>& row) {
  switch (degree) {
    case 1:
      return fill_general<Bends>(1, place, scale, row);
    case 2:
      return fill_general<Bends>(2, place, scale, row);
    case 3:
      return fill_cubic<Bends>(place, scale, row);
    case 4:
      return fill_general<Bends>(4, place, scale, row);
    case 5:
      return fill_general<Bends>(5, place, scale, row);
    case 6:
      return fill_general<Bends>(6, place, scale, row);
    default:
      return fill_general<Bends>(degree, place, scale, row);
  }
}

}  // namespace

}  // namespace lamella::span
