#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "slicing/span/face_model.h"
#include "slicing/span/node_table.h"
#include "slicing/span/propagate.h"
#include "slicing/span/section.h"
#include "slicing/span/sheet.h"
#include "slicing/span/tracer.h"

namespace lamella::span {

/// Cuts one face layer by layer, upward. What it knows of the band it is in (which node joins which) is carried from
/// one layer to the next.
class FaceSection {
 public:
  /// `heights` are all layers to come, ascending; they must outlive this.
  FaceSection(const Scene& scene, const FaceModel& face, const EdgePieces& edges, const TraceLimits& limits,
              std::span<const double> heights);

  /// Appends the face's arcs on one of the heights, the one that `nodes` has been set to.
  void cut(std::size_t layer, NodeTable& nodes, Section& out);

 private:
  /// An arc as it goes through a band: from one use to another, or a loop from a cut.
  struct Family {
    std::uint32_t begin = 0;  ///< in FaceModel::uses
    std::uint32_t end = 0;
    std::int32_t cut = -1;  ///< of a loop: index of the cut line and of its piece
    std::uint32_t cut_piece = 0;
    CarriedArc carried;  ///< what the last layer left
    Sheet sheet;
    std::size_t next_sheet = 0;  ///< layer from which another sheet may be tried
    bool inner = false;          ///< ellipses: the inner circle of a torus
    double turn = 1.0;           ///< ellipses: the sense in which the angle runs
    double sweep = 0.0;          ///< ellipses: angle at `z`, positive
    double z = 0.0;
  };
  /// One end of an arc on this face.
  struct FacePoint {
    SectionPoint point;
    Vec2 chart = Vec2::Zero();   ///< (u, v) in the face's chart, by the pcurve
    std::uint32_t piece = 0;     ///< edge piece of the node
    Vec2 node = Vec2::Zero();    ///< stored
    Vec2 normal = Vec2::Zero();  ///< of the face there, by the pcurve, as SectionArc has it
    double tolerance = 0.0;
    bool usable = false;
  };

  /// Where a cut crosses the layer.
  struct CutRoot {
    std::uint32_t cut = 0;
    std::uint32_t piece = 0;
    double u = 0.0;
    Vec2 xy = Vec2::Zero();
    Vec2 along = Vec2::Zero();  ///< the cut's direction there
    bool visited = false;       ///< an arc that is known passes through it
  };

  void enter_band(std::size_t band, double z, NodeTable& nodes);
  void pair_plane(double z, const NodeTable& nodes);
  void pair_round(double z, const NodeTable& nodes);
  /// Pairs at height z; if that is the layer's own height the arcs are kept as they were traced.
  void pair_traced(double z, bool is_layer, const NodeTable& nodes);
  [[nodiscard]] double pairing_height(std::size_t band, double layer_z) const;
  void join(std::uint32_t begin, std::uint32_t end);
  void pair_neighbors();
  void trace_starts(double z, bool is_layer);
  void pair_rest();
  void find_roots(double z);
  void visit_roots(const Family& family, double z);
  /// Where a piece, given by its first point and chord as well, comes nearest to a point; nothing if not within
  /// `slack`.
  [[nodiscard]] static std::optional<double> nearest_place(const ArcPiece& piece, const Vec2& from, const Vec2& chord,
                                                           const Vec2& xy, double slack);
  /// Whether an arc that is known passes a point within the tolerance of the face's edges.
  [[nodiscard]] bool is_near_arc(const Vec2& xy, double z);
  /// Whether a root lies on an arc's piece, given by its first point and chord as well.
  [[nodiscard]] bool passes_through(const ArcPiece& piece, const Vec2& from, const Vec2& chord,
                                    const CutRoot& root) const;
  /// Whether a section that goes through a root along `slope` crosses the cut there as the height along the cut has it.
  [[nodiscard]] bool crosses_as(const CutRoot& root, const Vec2& slope) const;
  void find_loops(double z, Section& out);

  void cut_plane(double z, NodeTable& nodes, Section& out) const;
  void cut_round(double z, NodeTable& nodes, Section& out);
  void cut_traced(double z, NodeTable& nodes, Section& out);
  void carry_families(double z, NodeTable& nodes);
  void drop_pierced_families(double inner, NodeTable& nodes);
  void pieces_of(const Family& family, double inner);
  [[nodiscard]] static bool passes_near(const std::vector<ArcPiece>& pieces, const Vec2& xy);
  /// False if the arc, or a part of it, couldn't be followed.
  bool cut_arc(Family& family, const FacePoint& begin, const FacePoint& end, Section& out);
  [[nodiscard]] FacePoint layer_point(std::uint32_t use, double z, double inner, NodeTable& nodes) const;
  bool keeps_to_nodes(const Family& family, const ArcPiece* pieces, std::uint32_t count, NodeTable& nodes) const;
  bool cut_by_sheet(Family& family, double inner, NodeTable& nodes, Section& out) const;
  void try_sheet(Family& family, double inner, const NodeTable& nodes);
  /// An arc that can't be followed from end to end: both ways as far as they come nearest, and a chord between.
  void bridge(const FacePoint& begin, const FacePoint& end, Section& out);
  /// Distance of the face from the middle of the chord between two of its points, mm.
  [[nodiscard]] double height_off(const SectionPoint& a, const SectionPoint& b) const;
  void cut_loop(Family& family, double z, Section& out);

  /// Notes on the arcs from number `first` on, those of one family on the layer z, what the face says in their nodes:
  /// where these are known already, else by their pcurves.
  void note_normals(const Family& family, std::size_t first, double z, NodeTable& nodes, Section& out) const;
  void note_normals(const FacePoint& begin, const FacePoint& end, std::size_t first, double z, Section& out) const;
  /// Horizontal part of the outward unit normal where a node lies by its pcurve; zero on a crease and where it is
  /// small.
  [[nodiscard]] Vec2 node_normal(std::uint32_t use, NodeTable& nodes) const;
  [[nodiscard]] Vec2 horizontal_normal(const SurfacePoint& at, const Cell& cell, const Vec2& uv) const;

  [[nodiscard]] double inner_height(double z) const;
  /// (u, v) of a node in the face's chart, by the pcurve.
  [[nodiscard]] Vec2 chart_point(const PieceUse& use, const Node& node) const;
  [[nodiscard]] FacePoint face_point(const PieceUse& use, const Node& node, double z) const;
  [[nodiscard]] FacePoint cut_point(const Family& family, double z) const;
  [[nodiscard]] bool lie_together(const FacePoint& begin, const FacePoint& end) const;
  /// Whether an arc between two points is none: it has vanished, or is inverted within the tolerance. `ends` are those
  /// that it may have if it is one all the same.
  [[nodiscard]] bool are_joined(const FacePoint& begin, const FacePoint& end, std::span<const SectionPoint> ends);
  /// Whether the section from a point can be followed through the face to one of the ends.
  [[nodiscard]] bool leads_to(const FacePoint& begin, std::span<const SectionPoint> ends);
  [[nodiscard]] const TrimRegion& region();
  [[nodiscard]] bool is_whole_ellipse(double z, bool inner) const;
  [[nodiscard]] double chart_angle(const PieceUse& use, const Node& node, const PlaneEllipse& ellipse) const;
  [[nodiscard]] double sweep_between(const Family& family, double z, const Node& begin, const Node& end) const;
  [[nodiscard]] Family round_family(double z, bool inner) const;
  [[nodiscard]] double run_of(double z, bool inner) const;
  [[nodiscard]] bool is_inner(const PieceUse& use, const Node& node) const;
  double follow_sweep(Family& family, double z, NodeTable& nodes) const;
  /// Appends an arc between two stored nodes; where its own ends lie off them, straight arcs lead there.
  void append(const Vec2& begin, const Vec2& end, const std::vector<ArcPiece>& pieces, Section& out) const;
  void append_range(Vec2 begin, Vec2 end, std::uint32_t first, Section& out) const;
  void append_chord(const Vec2& begin, const Vec2& end, const Vec2& from, const Vec2& to, bool doubtful,
                    Section& out) const;

  const Scene* scene_;
  const FaceModel* face_;
  const EdgePieces* edges_;
  TraceLimits limits_;
  std::span<const double> heights_;
  std::size_t layer_ = 0;
  double last_z_ = 0.0;  ///< height of the last layer that met the face
  std::optional<std::size_t> band_;
  bool entered_ = false;  ///< this layer is the first in its band
  std::vector<Family> families_;
  TracedArc traced_;
  TracedArc backward_;
  CarryWork work_;
  std::optional<TrimRegion> own_region_;  ///< where the model has none

  // Of the band being entered.
  std::vector<std::uint32_t> starts_;  ///< uses that cross the band
  std::vector<std::uint32_t> ends_;
  std::vector<FacePoint> points_;  ///< one a use
  std::vector<std::uint8_t> is_paired_;
  std::vector<CutRoot> roots_;
  std::vector<std::uint32_t> roots_by_x_;
  std::vector<ArcPiece> pieces_;          ///< of the family being looked at
  std::vector<SectionPoint> end_points_;  ///< of the arcs on this layer, behind a place for a loop's seed
  std::vector<std::uint8_t> is_known_;    ///< for each of them: its arc was followed from end to end
};

}  // namespace lamella::span
