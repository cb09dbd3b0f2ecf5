#include "slicing/slivers.h"

#include <algorithm>

namespace lamella {

namespace {

/// Within what the faces at the segment's ends touch others.
double tolerance_at(const Segment& segment, std::span<const Span> spans, const CombineRules& rules) {
  double tolerance = rules.gap_tolerance;
  const auto widen = [&](double x, double place, FaceId face) {
    if (x == place) tolerance = std::max(tolerance, rules.tolerance_at(face));
  };
  for (const Span& span : spans) {
    widen(segment.x_begin, span.begin, span.face_in);
    widen(segment.x_begin, span.end, span.face_out);
    widen(segment.x_end, span.begin, span.face_in);
    widen(segment.x_end, span.end, span.face_out);
  }
  return tolerance;
}

bool is_whole_span(const Segment& segment, std::span<const Span> spans) {
  return std::any_of(spans.begin(), spans.end(), [&](const Span& span) {
    return span.solid == segment.solid && span.begin == segment.x_begin && span.end == segment.x_end;
  });
}

bool is_sliver(const Segment& segment, std::span<const Span> spans, const CombineRules& rules) {
  const double length = segment.x_end - segment.x_begin;
  if (length > rules.widest_tolerance()) return false;
  if (length > tolerance::kMinGap && is_whole_span(segment, spans)) return false;
  return length <= tolerance_at(segment, spans, rules);
}

/// Puts `segment` behind the segments kept so far, as one with the last if both are of one solid and meet.
void keep(const Segment& segment, std::size_t row_begin, std::size_t& kept, std::vector<Segment>& segments) {
  if (kept > row_begin) {
    Segment& last = segments[kept - 1];
    if (last.x_end == segment.x_begin && last.solid == segment.solid && last.material == segment.material) {
      last.x_end = segment.x_end;
      return;
    }
  }
  segments[kept++] = segment;
}

}  // namespace

void join_slivers(std::span<const Span> spans, const CombineRules& rules, std::size_t row_begin,
                  std::vector<Segment>& segments) {
  std::size_t kept = row_begin;
  for (std::size_t i = row_begin; i < segments.size(); ++i) {
    Segment segment = segments[i];
    if (is_sliver(segment, spans, rules)) {
      const bool meets_left = kept > row_begin && segments[kept - 1].x_end == segment.x_begin;
      const bool meets_right = i + 1 < segments.size() && segments[i + 1].x_begin == segment.x_end;
      const auto rank = [&](const Segment& neighbour) { return rules.rank[neighbour.solid]; };
      if (meets_right && (!meets_left || rank(segments[i + 1]) > rank(segments[kept - 1]))) {
        segments[i + 1].x_begin = segment.x_begin;
        continue;
      }
      if (meets_left) {
        segments[kept - 1].x_end = segment.x_end;
        continue;
      }
    }
    keep(segment, row_begin, kept, segments);
  }
  segments.resize(kept);
}

}  // namespace lamella
