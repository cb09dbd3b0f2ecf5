#pragma once

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "core/geometry.h"

/// Sets of spans on one row, ascending and disjoint.
namespace lamella::test {

/// Every span longer by `by` at both ends, joined where they meet; shorter, and gone where nothing is left, when `by`
/// is negative.
inline std::vector<Interval> grown(const std::vector<Interval>& spans, double by) {
  std::vector<Interval> result;
  for (const Interval& span : spans) {
    const Interval longer{span.lo - by, span.hi + by};
    if (longer.hi <= longer.lo) continue;
    if (!result.empty() && longer.lo <= result.back().hi) {
      result.back().hi = std::max(result.back().hi, longer.hi);
    } else {
      result.push_back(longer);
    }
  }
  return result;
}

inline std::vector<Interval> united(std::vector<Interval> a, const std::vector<Interval>& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end(), [](const Interval& l, const Interval& r) { return l.lo < r.lo; });
  return grown(a, 0.0);
}

/// What of `a` isn't in `b`.
inline std::vector<Interval> without(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  std::vector<Interval> result;
  for (Interval rest : a) {
    for (const Interval& hole : b) {
      if (hole.hi <= rest.lo || hole.lo >= rest.hi) continue;
      if (hole.lo > rest.lo) result.push_back({rest.lo, hole.lo});
      rest.lo = std::max(rest.lo, hole.hi);
    }
    if (rest.lo < rest.hi) result.push_back(rest);
  }
  return result;
}

inline std::vector<Interval> common(const std::vector<Interval>& a, const std::vector<Interval>& b) {
  return without(a, without(a, b));
}

/// Length of the longest span, 0 for none.
inline double longest(const std::vector<Interval>& spans) {
  double length = 0.0;
  for (const Interval& span : spans) length = std::max(length, span.length());
  return length;
}

inline double total_length(const std::vector<Interval>& spans) {
  double length = 0.0;
  for (const Interval& span : spans) length += span.length();
  return length;
}

/// For messages: " [lo, hi]" for each.
inline std::string text_of(const std::vector<Interval>& spans) {
  std::ostringstream text;
  text.precision(15);
  for (const Interval& span : spans) text << " [" << span.lo << ", " << span.hi << "]";
  return text.str();
}

}  // namespace lamella::test
