#include "model/step/convert_solid.h"

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_Transform.hxx>
#include <BRepLib.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <NCollection_DataMap.hxx>
#include <ShapeFix_Edge.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Iterator.hxx>
#include <TopoDS_Vertex.hxx>
#include <algorithm>
#include <cmath>

#include "model/evaluate.h"
#include "model/step/convert_geometry.h"
#include "model/step/curve_box.h"
#include "model/step/loop_order.h"

namespace lamella::step {
namespace {

template <class IdT>
using ShapeMap = NCollection_DataMap<TopoDS_Shape, IdT, TopTools_ShapeMapHasher>;

/// Half-edges of one wire before they are put in order.
using Chain = std::vector<HalfEdge>;

/// A face on its way into the scene.
struct FaceDraft {
  Face face;
  std::vector<Chain> loops;
};

class SolidConverter {
 public:
  SolidConverter(Scene& scene, const EntityIndex& entities, const FaceColors& colors)
      : scene_(scene), entities_(entities), colors_(colors) {}

  void run(const SolidSource& source);

 private:
  void add_shell(const TopoDS_Shape& shell);
  void add_face(const TopoDS_Face& face);
  FaceDraft draft_face(const TopoDS_Face& face);
  Chain draft_wire(const TopoDS_Shape& wire, const TopoDS_Face& face, const Surface* plane);
  void cover_deviations(const FaceDraft& draft);
  void commit(FaceDraft draft);
  EdgeId edge_id(const TopoDS_Edge& edge);
  Edge convert_edge(const TopoDS_Edge& edge);
  VertexId vertex_id(const TopoDS_Vertex& vertex);
  void report(const TopoDS_Face& face, const std::string& what);

  Scene& scene_;
  const EntityIndex& entities_;
  const FaceColors& colors_;
  SolidId solid_;
  ShellId shell_;
  std::uint32_t face_number_ = 0;
  bool failed_ = false;
  ShapeMap<EdgeId> edges_;
  ShapeMap<VertexId> vertices_;
};

bool is_scaled(const gp_Trsf& placement) {
  constexpr double kUnscaled = 1e-12;
  return std::abs(std::abs(placement.ScaleFactor()) - 1.0) > kUnscaled;
}

/// Completes an instance by its placement; without one that the model has, it is none.
void place_instance(const TopoDS_Shape& shape, std::optional<Instance>& instance) {
  const gp_Trsf trsf = shape.Location().Transformation();
  if (is_scaled(trsf)) {
    instance.reset();
    return;
  }
  try {
    const Placement placement = placement_of(trsf);
    instance->turn = placement.linear;
    instance->shift = placement.translation;
  } catch (const Unconvertible&) {
    instance.reset();
  }
}

double size_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box, Standard_False);
  return box.IsVoid() ? 0.0 : box.SquareExtent();
}

/// The shells of a solid, the one with the largest box (which holds the others) first; a compound of loose faces is
/// one shell.
std::vector<TopoDS_Shape> shells_of(const TopoDS_Shape& shape) {
  std::vector<TopoDS_Shape> shells;
  for (TopExp_Explorer it(shape, TopAbs_SHELL); it.More(); it.Next()) shells.push_back(it.Current());
  if (shells.empty()) shells.push_back(shape);
  if (shells.size() > 1) {
    const auto largest = std::max_element(shells.begin(), shells.end(),
                                          [](const auto& a, const auto& b) { return size_of(a) < size_of(b); });
    std::rotate(shells.begin(), largest, largest + 1);
  }
  return shells;
}

void SolidConverter::run(const SolidSource& source) {
  Solid solid;
  solid.info = source.info;
  if (solid.info.instance) place_instance(source.shape, solid.info.instance);
  solid_ = scene_.solids.push_back(solid);
  const auto first_shell = ShellId{scene_.shells.size()};
  const std::size_t first_edge = scene_.edges.size();
  const std::size_t first_vertex = scene_.vertices.size();
  const std::size_t first_face = scene_.faces.size();
  try {
    for (const TopoDS_Shape& shell : shells_of(without_scaling(source.shape))) add_shell(shell);
  } catch (const Standard_Failure& error) {
    scene_.findings.push_back({Severity::error,
                               source.info.path,
                               {},
                               label_of(source.info.step_entity),
                               std::string("the solid can't be converted: ") + error.GetMessageString(),
                               "repair it in the CAD system and export again"});
    failed_ = true;
  }

  Solid& stored = scene_.solids[solid_];
  stored.shells = {first_shell, static_cast<std::uint32_t>(scene_.shells.size() - first_shell.value())};
  double& worst = stored.info.max_tolerance;
  for (std::size_t i = first_edge; i < scene_.edges.size(); ++i)
    worst = std::max(worst, scene_.edges[EdgeId{i}].tolerance);
  for (std::size_t i = first_vertex; i < scene_.vertices.size(); ++i) {
    worst = std::max(worst, scene_.vertices[VertexId{i}].tolerance);
  }
  if (failed_) stored.info.status = SolidStatus::invalid;
  if (scene_.faces.size() == first_face) stored.info.status = SolidStatus::empty;
}

void SolidConverter::add_shell(const TopoDS_Shape& shape) {
  Shell shell;
  shell.solid = solid_;
  shell.step_entity = entities_.item(shape).number;
  shell_ = scene_.shells.push_back(shell);
  const FaceId first{scene_.faces.size()};
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) add_face(TopoDS::Face(it.Current()));
  scene_.shells[shell_].faces = {first, static_cast<std::uint32_t>(scene_.faces.size() - first.value())};
}

void SolidConverter::add_face(const TopoDS_Face& face) {
  ++face_number_;
  if (face.Orientation() == TopAbs_INTERNAL || face.Orientation() == TopAbs_EXTERNAL) {
    return report(face, "the face doesn't bound the solid and is left out");
  }
  try {
    FaceDraft draft = draft_face(face);
    cover_deviations(draft);
    commit(std::move(draft));
    return;
  } catch (const Unconvertible& error) {
    report(face, error.what());
  } catch (const GeometryError& error) {
    report(face, error.what());
  } catch (const Standard_Failure& error) {
    report(face, std::string("the face can't be converted: ") + error.GetMessageString());
  }
  failed_ = true;
}

void SolidConverter::report(const TopoDS_Face& face, const std::string& what) {
  const EntityRef entity = entities_.item(face);
  const SolidInfo& info = scene_.solids[solid_].info;
  scene_.findings.push_back({Severity::error, info.path,
                             entity.name.empty() ? "face " + std::to_string(face_number_) : entity.name,
                             label_of(entity.number), what, "repair the face in the CAD system and export again"});
}

FaceDraft SolidConverter::draft_face(const TopoDS_Face& oriented) {
  const TopoDS_Face face = TopoDS::Face(oriented.Oriented(TopAbs_FORWARD));
  TopLoc_Location location;
  const Handle(Geom_Surface) surface = BRep_Tool::Surface(face, location);
  if (surface.IsNull()) throw Unconvertible("the face has no surface");
  const Placement placement = placement_of(location.Transformation());

  FaceDraft draft;
  const bool planar = is_plane(surface);
  if (planar) draft.face.surface = convert_surface(surface, placement, Box2());
  for (TopoDS_Iterator it(face); it.More(); it.Next()) {
    if (it.Value().ShapeType() != TopAbs_WIRE) continue;
    Chain chain = draft_wire(it.Value(), face, planar ? &draft.face.surface : nullptr);
    for (Chain& loop : order_loops(std::move(chain), scene_)) draft.loops.push_back(std::move(loop));
  }
  if (draft.loops.empty()) throw Unconvertible("the face has no boundary");
  Box2& bounds = draft.face.uv_bounds;
  for (const Chain& loop : draft.loops) {
    for (const HalfEdge& half_edge : loop) bounds.extend(curve_box(half_edge.pcurve, half_edge.prange));
  }
  constexpr double kInfinite = 1e50;
  // Written so that NaN fails.
  if (!(bounds.min().minCoeff() > -kInfinite && bounds.max().maxCoeff() < kInfinite)) {
    throw Unconvertible("the face is infinite: its surface is not trimmed");
  }
  if (!planar) draft.face.surface = convert_surface(surface, placement, bounds);

  // Du x Dv of a mirrored surface is the mirrored normal, turned round.
  const bool reversed = oriented.Orientation() == TopAbs_REVERSED;
  draft.face.same_sense = reversed == placement.mirrors();
  draft.face.tolerance = BRep_Tool::Tolerance(face);
  const EntityRef entity = entities_.item(face);
  draft.face.step_entity = entity.number;
  draft.face.name = entity.name;
  if (const auto color = colors_.find(face.TShape().get()); color != colors_.end()) draft.face.color = color->second;
  return draft;
}

Chain SolidConverter::draft_wire(const TopoDS_Shape& wire, const TopoDS_Face& face, const Surface* plane) {
  Chain chain;
  for (TopoDS_Iterator it(wire); it.More(); it.Next()) {
    const TopoDS_Edge edge = TopoDS::Edge(it.Value());
    if (edge.Orientation() == TopAbs_INTERNAL || edge.Orientation() == TopAbs_EXTERNAL) continue;
    HalfEdge half_edge;
    half_edge.edge = edge_id(edge);
    half_edge.forward = edge.Orientation() == TopAbs_FORWARD;
    const Edge& stored = scene_.edges[half_edge.edge];
    if (plane != nullptr && !stored.degenerate) {
      half_edge.prange = stored.range;
      half_edge.pcurve = project_onto(std::get<Plane>(*plane), stored.curve);
    } else {
      Interval& range = half_edge.prange;
      Handle(Geom2d_Curve) pcurve = BRep_Tool::CurveOnSurface(edge, face, range.lo, range.hi);
      if (pcurve.IsNull() && ShapeFix_Edge().FixAddPCurve(edge, face, BRep_Tool::IsClosed(edge, face))) {
        pcurve = BRep_Tool::CurveOnSurface(edge, face, range.lo, range.hi);
      }
      if (pcurve.IsNull()) throw Unconvertible("an edge has no curve in the surface's parameters");
      half_edge.pcurve = convert_curve(pcurve, range);
    }
    chain.push_back(std::move(half_edge));
  }
  return chain;
}

/// Enough to see every wave of a spline between its knots.
int deviation_samples(const Curve2& curve) {
  constexpr int kLeast = 24;
  constexpr int kMost = 400;
  const auto* spline = std::get_if<BSplineCurve<2>>(&curve);
  return spline == nullptr ? kLeast : std::clamp(3 * static_cast<int>(spline->poles.size()), kLeast, kMost);
}

/// Raises the edges' tolerances to what the distance between curve and pcurve needs: the import states less where it
/// doesn't measure, on planes above all.
void SolidConverter::cover_deviations(const FaceDraft& draft) {
  constexpr double kBetweenSamples = 1.1;  // the largest distance may lie between two samples
  for (const Chain& loop : draft.loops) {
    for (const HalfEdge& half_edge : loop) {
      Edge& edge = scene_.edges[half_edge.edge];
      if (edge.degenerate) continue;
      double worst = 0.0;
      const int samples = deviation_samples(half_edge.pcurve);
      for (int i = 0; i <= samples; ++i) {
        const double s = static_cast<double>(i) / samples;
        const Vec3 in_space = evaluate<3>(edge.curve, edge.range.lo + s * edge.range.length()).point;
        const Vec2 uv = evaluate<2>(half_edge.pcurve, half_edge.prange.lo + s * half_edge.prange.length()).point;
        worst = std::max(worst, (evaluate_point(draft.face.surface, uv) - in_space).norm());
      }
      edge.tolerance = std::max(edge.tolerance, kBetweenSamples * worst);
    }
  }
}

void SolidConverter::commit(FaceDraft draft) {
  const FaceId face_id{scene_.faces.size()};
  draft.face.shell = shell_;
  draft.face.loops = {LoopId{scene_.loops.size()}, static_cast<std::uint32_t>(draft.loops.size())};
  for (Chain& chain : draft.loops) {
    // Wires have the material on their left in (u, v). Half-edges follow the outward normal instead.
    if (!draft.face.same_sense) {
      std::reverse(chain.begin(), chain.end());
      for (HalfEdge& half_edge : chain) half_edge.forward = !half_edge.forward;
    }
    Loop loop;
    loop.face = face_id;
    loop.half_edges = {HalfEdgeId{scene_.half_edges.size()}, static_cast<std::uint32_t>(chain.size())};
    const LoopId loop_id = scene_.loops.push_back(loop);
    for (HalfEdge& half_edge : chain) {
      half_edge.loop = loop_id;
      scene_.half_edges.push_back(std::move(half_edge));
    }
  }
  scene_.faces.push_back(std::move(draft.face));
}

EdgeId SolidConverter::edge_id(const TopoDS_Edge& edge) {
  if (const EdgeId* known = edges_.Seek(edge)) return *known;
  const EdgeId id = scene_.edges.push_back(convert_edge(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD))));
  edges_.Bind(edge, id);
  return id;
}

Edge SolidConverter::convert_edge(const TopoDS_Edge& edge) {
  Edge result;
  result.tolerance = BRep_Tool::Tolerance(edge);
  result.degenerate = BRep_Tool::Degenerated(edge);
  result.step_entity = entities_.item(edge).number;
  const TopoDS_Vertex start = TopExp::FirstVertex(edge);
  const TopoDS_Vertex end = TopExp::LastVertex(edge);
  if (start.IsNull() || end.IsNull()) throw Unconvertible("an edge has no vertices: it may be infinite");
  result.start = vertex_id(start);
  result.end = vertex_id(end);
  const auto require_finite = [&result] {
    constexpr double kInfinite = 1e50;  // OpenCASCADE's own infinity is 2e100
    const bool finite = std::abs(result.range.lo) < kInfinite && std::abs(result.range.hi) < kInfinite;
    if (!finite) throw Unconvertible("an edge is infinite: the face is not trimmed");
  };
  if (result.degenerate) {
    BRep_Tool::Range(edge, result.range.lo, result.range.hi);
    return result;
  }
  TopLoc_Location location;
  Handle(Geom_Curve) curve = BRep_Tool::Curve(edge, location, result.range.lo, result.range.hi);
  if (curve.IsNull() && BRepLib::BuildCurve3d(edge)) {
    curve = BRep_Tool::Curve(edge, location, result.range.lo, result.range.hi);
  }
  if (curve.IsNull()) throw Unconvertible("an edge has no curve in space");
  require_finite();
  if (!(result.range.lo < result.range.hi)) throw Unconvertible("an edge has no length in its curve's parameter");
  result.curve = convert_curve(curve, placement_of(location.Transformation()), result.range);
  return result;
}

VertexId SolidConverter::vertex_id(const TopoDS_Vertex& vertex) {
  if (const VertexId* known = vertices_.Seek(vertex)) return *known;
  const gp_Pnt p = BRep_Tool::Pnt(vertex);
  const VertexId id = scene_.vertices.push_back({Vec3{p.X(), p.Y(), p.Z()}, BRep_Tool::Tolerance(vertex)});
  vertices_.Bind(vertex, id);
  return id;
}

}  // namespace

TopoDS_Shape without_scaling(const TopoDS_Shape& shape) {
  const gp_Trsf placement = shape.Location().Transformation();
  if (!is_scaled(placement)) return shape;
  const TopoDS_Shape bare = shape.Located(TopLoc_Location());
  return BRepBuilderAPI_Transform(bare, placement, Standard_True).Shape();
}

void append_solid(Scene& scene, const SolidSource& source, const EntityIndex& entities, const FaceColors& colors) {
  SolidConverter(scene, entities, colors).run(source);
}

}  // namespace lamella::step
