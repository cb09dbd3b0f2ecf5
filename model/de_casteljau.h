#pragma once

#include <array>
#include <utility>

#include "model/bezier.h"

/// De Casteljau's algorithm on strided control points; `s` in [0, 1] is the place within the piece's interval.
namespace lamella {

/// Splits at `s`. `left` and `right` both hold the control points on entry, the halves' on return.
template <class Point>
void split_in_place(Point* left, Point* right, int degree, int stride, double s) {
  for (int r = 1; r <= degree; ++r) {
    for (int i = 0; i <= degree - r; ++i) {
      Point& point = right[i * stride];
      point = (1.0 - s) * point + s * right[(i + 1) * stride];
    }
    left[r * stride] = right[0];
  }
}

/// Point and derivative by `s`.
template <class Point>
std::pair<Point, Point> evaluate_bezier(const Point* points, int degree, int stride, double s) {
  std::array<Point, kMaxDegree + 1> work;
  for (int i = 0; i <= degree; ++i) work[i] = points[i * stride];
  for (int r = 1; r < degree; ++r) {
    for (int i = 0; i <= degree - r; ++i) work[i] = (1.0 - s) * work[i] + s * work[i + 1];
  }
  if (degree == 0) return {work[0], Point::Zero()};
  return {(1.0 - s) * work[0] + s * work[1], degree * (work[1] - work[0])};
}

}  // namespace lamella
