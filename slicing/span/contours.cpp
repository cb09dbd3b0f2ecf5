#include "slicing/span/contours.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "slicing/span/arc_chain.h"
#include "slicing/span/conic_section.h"
#include "slicing/span/flatten.h"
#include "slicing/span/loop_nesting.h"
#include "slicing/span/quintic.h"

namespace lamella::span {

namespace {

/// A gap at a node below this share of the chord error is spared a corner of its own: the node stands for the arc's
/// end, and the rest of the chord error is left for the chords.
constexpr double kSparedGap = 0.1;

/// How often a polygon that shows nothing of its loop is made anew, four times finer.
constexpr int kRefinements = 12;

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Twice the area between a piece and the origin: the integral of x y' - y x', term by term.
double swept(const ArcPiece& piece, const Vec2& origin) {
  Quintic x = piece.x;
  Quintic y = piece.y;
  x[0] -= origin.x();
  y[0] -= origin.y();
  double sum = 0.0;
  for (int j = 1; j < 6; ++j) {
    for (int i = 0; i < j; ++i) sum += (x[i] * y[j] - x[j] * y[i]) * (j - i) / (i + j);
  }
  return sum;
}

/// Twice the area between an arc, from node to node, and the origin.
double swept(const Section& section, const SectionArc& arc, const Vec2& origin) {
  double sum = 0.0;
  Vec2 last = arc.begin - origin;
  for (std::uint32_t i = 0; i < arc.piece_count; ++i) {
    const ArcPiece& piece = section.pieces[arc.first_piece + i];
    sum += cross(last, piece.at(0.0) - origin) + swept(piece, origin);
    last = piece.at(1.0) - origin;
  }
  return sum + cross(last, arc.end - origin);
}

double polygon_area(const std::vector<Vec2>& points) {
  double sum = 0.0;
  for (std::size_t i = 2; i < points.size(); ++i) sum += cross(points[i - 1] - points[0], points[i] - points[0]);
  return 0.5 * sum;
}

class Assembler {
 public:
  Assembler(const Scene& scene, const Section& section, const ContourRequest& request)
      : scene_(scene), section_(section), request_(request), chord_error_(request.chord_error) {
    if (!(chord_error_ >= kLeastChordError)) chord_error_ = kLeastChordError;  // NaN too
  }

  SectionContours run() {
    result_.solid = request_.solid;
    result_.z = request_.z;
    const ArcChains chains = chain_arcs(section_);
    for (const auto& arcs : chains.loops) add_loop(arcs);
    const std::vector<std::int32_t> parents = find_parents(section_, kept_, result_.loops, chord_error_);
    for (std::size_t i = 0; i < parents.size(); ++i) result_.loops[i].parent = parents[i];
    for (const auto& arcs : chains.open) add_open(arcs);
    report(chains);
    return std::move(result_);
  }

 private:
  void add_loop(const std::vector<std::uint32_t>& arcs) {
    SectionLoop loop;
    const Vec2 origin = section_.arcs[arcs.front()].begin;
    for (const std::uint32_t i : arcs) loop.area += 0.5 * swept(section_, section_.arcs[i], origin);
    result_.area += loop.area;
    double chord_error = chord_error_;
    for (int i = 0; i <= kRefinements; ++i, chord_error *= 0.25) {
      Polygon made = polygon(arcs, chord_error);
      loop.points = std::move(made.points);
      loop.curves = curves_of(made.sources);
      if (loop.points.size() > 2 && (polygon_area(loop.points) > 0.0) == (loop.area > 0.0)) break;
    }
    // Two chords to and fro.
    if (loop.points.size() < 3) return;
    result_.loops.push_back(std::move(loop));
    kept_.push_back(arcs);
  }

  void add_open(const std::vector<std::uint32_t>& arcs) {
    std::vector<Vec2> points = polygon(arcs, chord_error_).points;
    const Vec2 begin = section_.arcs[arcs.front()].begin;
    const Vec2 end = section_.arcs[arcs.back()].end;
    if (points.empty() || points.back() != end) points.push_back(end);
    result_.open.push_back(std::move(points));
    std::ostringstream text;
    text << "a contour does not close: it leads from " << place(begin) << " to " << place(end);
    add_finding(Severity::error, section_.arcs[arcs.back()].face, text.str(),
                "faces that should share an edge there do not; repair the solid or leave it out");
  }

  /// What the side behind a point is a chord of: nothing, a piece, or the ellipse of an arc.
  struct Source {
    static constexpr std::uint32_t kNone = ~0U;
    std::uint32_t arc = kNone;
    std::uint32_t piece = kNone;  ///< none of an ellipse

    bool operator==(const Source&) const = default;
  };
  struct Polygon {
    std::vector<Vec2> points;
    std::vector<Source> sources;  ///< of the side behind each point

    void add(const Vec2& point, const Source& source) {
      points.push_back(point);
      sources.push_back(source);
    }
  };

  Polygon polygon(const std::vector<std::uint32_t>& arcs, double chord_error) const {
    Polygon all;
    for (const std::uint32_t i : arcs) append_arc(i, chord_error, all);
    // Of equal points the last one's side is the one with a length.
    Polygon kept;
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      if (!kept.points.empty() && kept.points.back() == all.points[i]) {
        kept.sources.back() = all.sources[i];
      } else {
        kept.add(all.points[i], all.sources[i]);
      }
    }
    while (kept.points.size() > 1 && kept.points.back() == kept.points.front()) {
      kept.points.pop_back();
      kept.sources.pop_back();
    }
    return kept;
  }

  /// The arc's points but the node where it ends.
  void append_arc(std::uint32_t index, double chord_error, Polygon& out) const {
    const SectionArc& arc = section_.arcs[index];
    if (arc.piece_count == 0) {
      out.add(arc.begin, {});
      return;
    }
    const auto source = [&](std::uint32_t piece) {
      const bool is_line = chord_distance(section_.pieces[arc.first_piece + piece], 0.0, 1.0) <= kLeastChordError;
      if (arc.straight || arc.doubtful || is_line) return Source();
      return Source{index, arc.round < 0 ? arc.first_piece + piece : Source::kNone};
    };
    const Vec2 first = section_.pieces[arc.first_piece].at(0.0);
    const Vec2 last = section_.pieces[arc.first_piece + arc.piece_count - 1].at(1.0);
    const double gap = (first - arc.begin).norm();
    const double last_gap = (last - arc.end).norm();
    const double spared = kSparedGap * chord_error;
    out.add(arc.begin, gap > spared ? Source() : source(0));
    if (gap > spared) out.add(first, source(0));
    const double moved = std::max(gap > spared ? 0.0 : gap, last_gap > spared ? 0.0 : last_gap);
    std::vector<Vec2> within;
    for (std::uint32_t i = 0; i < arc.piece_count; ++i) {
      const ArcPiece& piece = section_.pieces[arc.first_piece + i];
      if (i > 0) out.add(piece.at(0.0), source(i));
      within.clear();
      flatten(piece, chord_error - moved, within);
      for (const Vec2& point : within) out.add(point, source(i));
    }
    if (last_gap > spared) out.add(last, {});
  }

  /// Sides of one source as one curve.
  [[nodiscard]] std::vector<ContourCurve> curves_of(const std::vector<Source>& sources) const {
    std::vector<ContourCurve> curves;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (sources[i].arc == Source::kNone) continue;
      if (i == 0 || sources[i] != sources[i - 1]) {
        curves.push_back(curve_of(sources[i]));
        curves.back().first_side = i;
      }
      ++curves.back().sides;
    }
    return curves;
  }

  [[nodiscard]] ContourCurve curve_of(const Source& source) const {
    ContourCurve curve;
    if (source.piece != Source::kNone) {
      const ArcPiece& piece = section_.pieces[source.piece];
      const Surface& surface = scene_.faces[section_.arcs[source.arc].face].surface;
      if (const std::optional<ConicArc> arc = conic_arc(surface, request_.z, piece)) {
        curve.kind = CurveKind::conic;
        curve.numbers = {arc->begin.x(), arc->begin.y(), arc->pole.x(), arc->pole.y(),
                         arc->end.x(),   arc->end.y(),   arc->weight};
        return curve;
      }
      std::copy(piece.x.begin(), piece.x.end(), curve.numbers.begin());
      std::copy(piece.y.begin(), piece.y.end(), curve.numbers.begin() + 6);
      return curve;
    }
    const EllipseArc& arc = section_.ellipses[static_cast<std::size_t>(section_.arcs[source.arc].round)];
    const PlaneEllipse& e = arc.ellipse;
    curve.kind = CurveKind::ellipse;
    curve.numbers = {e.center.x(), e.center.y(), e.cosine.x(), e.cosine.y(),
                     e.sine.x(),   e.sine.y(),   arc.begin,    arc.sweep};
    return curve;
  }

  void report(const ArcChains& chains) {
    std::uint32_t doubtful = 0;
    FaceId face;
    for (const SectionArc& arc : section_.arcs) {
      if (arc.doubtful && ++doubtful == 1) face = arc.face;
    }
    if (doubtful > 0) {
      add_finding(Severity::warning, face,
                  std::to_string(doubtful) + " arc(s) of the contours could not be followed; chords stand for them",
                  {});
    }
    if (chains.doubled > 0) {
      add_finding(Severity::warning, FaceId{},
                  std::to_string(chains.doubled) + " arc(s) were there twice; one was kept",
                  "the solid has a face twice");
    }
    if (chains.unusable > 0) {
      add_finding(Severity::error, FaceId{},
                  std::to_string(chains.unusable) + " arc(s) are not finite and were left out", {});
    }
  }

  void add_finding(Severity severity, FaceId face, const std::string& what, const std::string& hint) {
    Finding finding;
    finding.severity = severity;
    finding.solid = scene_.solids[request_.solid].info.path;
    if (face.valid()) {
      finding.face = scene_.faces[face].name;
      const int entity = scene_.faces[face].step_entity;
      if (entity != 0) finding.entity.append("#").append(std::to_string(entity));
    }
    std::ostringstream text;
    text << "at z = " << request_.z << " mm " << what;
    finding.what = text.str();
    finding.hint = hint;
    result_.findings.push_back(std::move(finding));
  }

  static std::string place(const Vec2& point) {
    std::ostringstream text;
    text << '(' << point.x() << ", " << point.y() << ')';
    return text.str();
  }

  const Scene& scene_;
  const Section& section_;
  const ContourRequest& request_;
  double chord_error_;
  SectionContours result_;
  std::vector<std::vector<std::uint32_t>> kept_;  ///< the arcs of each loop of the result
};

}  // namespace

SectionContours assemble_contours(const Scene& scene, const Section& section, const ContourRequest& request) {
  return Assembler(scene, section, request).run();
}

double section_area(const Section& section) {
  if (section.arcs.empty()) return 0.0;
  const Vec2 origin = section.arcs.front().begin;
  double sum = 0.0;
  for (const SectionArc& arc : section.arcs) sum += swept(section, arc, origin);
  return 0.5 * sum;
}

}  // namespace lamella::span
