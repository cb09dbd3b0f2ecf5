#include "tests/slicing/adaptive/occt_deviation.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Section.hxx>
#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepClass3d_SolidClassifier.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Geom_Surface.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <gp_Lin.hxx>
#include <gp_Pln.hxx>
#include <limits>
#include <random>
#include <stdexcept>

namespace lamella::test {

namespace {

constexpr double kFar = 1e6;  // mm
constexpr int kDirections = 12;
constexpr double kOnSurface = 1e-6;  // mm
constexpr double kInfinity = std::numeric_limits<double>::infinity();

gp_Pnt point_of(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
Vec3 vector_of(const gp_Pnt& p) { return {p.X(), p.Y(), p.Z()}; }

/// A triangle of a rough mesh by the parameters of its corners: random points of it lie on the exact surface.
struct Facet {
  Handle(Geom_Surface) surface;
  TopLoc_Location place;
  std::array<Vec2, 3> uv;
};

/// A face and where it lies.
struct BoxedFace {
  TopoDS_Shape face;
  Bnd_Box box;
};

class SolidMeter {
 public:
  SolidMeter(const TopoDS_Shape& solid, const std::vector<double>& borders, std::uint32_t seed)
      : solid_(solid), borders_(borders), random_(seed), classifier_(solid) {
    BRep_Builder builder;
    builder.MakeCompound(boundary_);
    for (TopExp_Explorer shell(solid, TopAbs_SHELL); shell.More(); shell.Next())
      builder.Add(boundary_, shell.Current());
    caster_.Load(boundary_, 1e-9);
    Bnd_Box box;
    BRepBndLib::AddOptimal(solid, box, false, false);
    double x0 = 0.0, y0 = 0.0, z0 = 0.0, x1 = 0.0, y1 = 0.0, z1 = 0.0;
    box.Get(x0, y0, z0, x1, y1, z1);
    low_ = {x0, y0, z0};
    high_ = {x1, y1, z1};
    collect_facets();
    for (TopExp_Explorer face(solid, TopAbs_FACE); face.More(); face.Next()) {
      faces_.push_back({face.Current(), {}});
      BRepBndLib::Add(face.Current(), faces_.back().box, false);
    }
    TopExp::MapShapes(solid, TopAbs_EDGE, edges_);
  }

  /// From a place of the solid's surface to that of the extruded sections, mm, if it is more than `least`, else less.
  double distance_to_built(const Vec3& p, double least) {
    const std::size_t k = layer_at(p.z());
    double nearest = distance_to_step(k, p, [this](std::size_t j, const Vec3& at) { return is_built(j, at); });
    std::vector<std::size_t> walls{k};
    if (k > 0) walls.push_back(k - 1);
    if (k + 1 < layers()) walls.push_back(k + 1);
    for (const std::size_t j : walls) {
      if (nearest > least) nearest = std::min(nearest, estimate_to_wall(j, p));
    }
    // Rays may all miss what is near, and the classifier err.
    for (const std::size_t j : walls) {
      if (nearest > least) nearest = distance_to_wall(j, p, nearest);
    }
    if (nearest > least) {
      const auto by_rays = [this](std::size_t j, const Vec3& at) { return is_built_by_rays(j, at); };
      nearest = std::min(nearest, distance_to_step(k, p, by_rays));
    }
    return nearest;
  }

  void measure(const MeasureOptions& options, MeasuredDeviation& out) {
    repeat(options, out.built_samples, [&] { sample_built(out); });
    repeat(options, out.surface_samples, [&] { sample_surface(out); });
  }

 private:
  template <class Body>
  static void repeat(const MeasureOptions& options, std::uint64_t& samples, const Body& body) {
    const auto begin = std::chrono::steady_clock::now();
    const std::uint64_t end = samples + options.samples;
    for (std::uint64_t tries = 0; samples < end && tries < 4 * options.samples; ++tries) {
      body();
      const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
      if (taken.count() > options.seconds) return;
    }
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  [[nodiscard]] std::size_t layers() const { return borders_.size() - 1; }
  [[nodiscard]] double middle(std::size_t k) const { return 0.5 * (borders_[k] + borders_[k + 1]); }
  [[nodiscard]] std::size_t layer_at(double z) const {
    const auto above = std::upper_bound(borders_.begin(), borders_.end(), z);
    const auto k = std::max<std::ptrdiff_t>(above - borders_.begin() - 1, 0);
    return std::min(static_cast<std::size_t>(k), layers() - 1);
  }

  void collect_facets() {
    const double size = (high_ - low_).norm();
    BRepMesh_IncrementalMesh(solid_, 0.002 * size, false, 0.3);
    for (TopExp_Explorer face(solid_, TopAbs_FACE); face.More(); face.Next()) {
      TopLoc_Location place;
      const auto mesh = BRep_Tool::Triangulation(TopoDS::Face(face.Current()), place);
      if (mesh.IsNull() || !mesh->HasUVNodes()) continue;
      TopLoc_Location surface_place;
      const auto surface = BRep_Tool::Surface(TopoDS::Face(face.Current()), surface_place);
      for (int t = 1; t <= mesh->NbTriangles(); ++t) {
        std::array<int, 3> n{};
        mesh->Triangle(t).Get(n[0], n[1], n[2]);
        Facet facet{surface, surface_place, {}};
        for (std::size_t c = 0; c < 3; ++c) facet.uv[c] = {mesh->UVNode(n[c]).X(), mesh->UVNode(n[c]).Y()};
        const gp_Pnt a = mesh->Node(n[0]);
        const gp_Vec normal = gp_Vec(a, mesh->Node(n[1])).Crossed(gp_Vec(a, mesh->Node(n[2])));
        areas_.push_back((areas_.empty() ? 0.0 : areas_.back()) + 0.5 * normal.Magnitude());
        facets_.push_back(facet);
      }
    }
  }

  /// Intersections with the whole line, depths along the unit direction.
  std::vector<double> cast(const Vec3& from, const Vec2& along) {
    caster_.Perform(gp_Lin(point_of(from), gp_Dir(along.x(), along.y(), 0.0)), -kFar, kFar);
    std::vector<double> depths;
    if (!caster_.IsDone()) return depths;
    for (int i = 1; i <= caster_.NbPnt(); ++i) depths.push_back(caster_.WParameter(i));
    return depths;
  }

  [[nodiscard]] double distance_to_surface(const Vec3& p) const {
    const BRepExtrema_DistShapeShape extrema(BRepBuilderAPI_MakeVertex(point_of(p)).Vertex(), boundary_);
    return extrema.IsDone() ? extrema.Value() : 0.0;
  }

  /// A point of a section, moved up or down its layer's wall: to its rims half of the time.
  void sample_built(MeasuredDeviation& out) {
    const double z = uniform(std::max(low_.z(), borders_.front()), std::min(high_.z(), borders_.back()));
    const std::size_t k = layer_at(z);
    const bool along_x = uniform(0.0, 1.0) < 0.5;
    const Vec3 from(uniform(low_.x(), high_.x()), uniform(low_.y(), high_.y()), middle(k));
    const Vec2 along = along_x ? Vec2::UnitX() : Vec2::UnitY();
    for (const double depth : cast(from, along)) {
      const double at = uniform(0.0, 1.0);
      Vec3 p = from;
      p.head<2>() += depth * along;
      p.z() = at < 0.25 ? borders_[k] : at < 0.5 ? borders_[k + 1] : uniform(borders_[k], borders_[k + 1]);
      const double distance = distance_to_surface(p);
      ++out.built_samples;
      if (distance > out.built) out.built_at = p;
      out.built = std::max(out.built, distance);
    }
  }

  Vec3 random_surface_point() {
    if (edges_.Extent() > 0 && uniform(0.0, 1.0) < 0.25) {
      const auto& edge = TopoDS::Edge(edges_(1 + static_cast<int>(uniform(0.0, edges_.Extent() - 1e-9))));
      if (!BRep_Tool::Degenerated(edge)) {
        const BRepAdaptor_Curve curve(edge);
        return vector_of(curve.Value(uniform(curve.FirstParameter(), curve.LastParameter())));
      }
    }
    const auto found = std::lower_bound(areas_.begin(), areas_.end(), uniform(0.0, areas_.back()));
    const Facet& facet = facets_[std::min<std::size_t>(found - areas_.begin(), facets_.size() - 1)];
    const double root = std::sqrt(uniform(0.0, 1.0));
    const double share = uniform(0.0, 1.0);
    const Vec2 uv = (1.0 - root) * facet.uv[0] + root * (1.0 - share) * facet.uv[1] + root * share * facet.uv[2];
    gp_Pnt p;
    facet.surface->D0(uv.x(), uv.y(), p);
    return vector_of(p.Transformed(facet.place.Transformation()));
  }

  /// Whether layer k has the place, by OpenCASCADE's classifier, which errs at times: it follows one line, and which
  /// one depends on what it was asked before.
  bool is_built(std::size_t k, const Vec3& p) {
    classifier_.Perform({p.x(), p.y(), middle(k)}, 1e-9);
    return classifier_.State() == TopAbs_IN;
  }

  /// The same by the majority of rays in the plane of its section.
  bool is_built_by_rays(std::size_t k, const Vec3& p) {
    int votes = 0;
    for (int d = 0; d < kDirections; ++d) {
      const double angle = kPi * d / kDirections;
      int ahead = 0;
      int behind = 0;
      for (const double depth : cast({p.x(), p.y(), middle(k)}, {std::cos(angle), std::sin(angle)})) {
        ++(depth > 0.0 ? ahead : behind);
      }
      votes += (ahead % 2 == 1 ? 1 : -1) + (behind % 2 == 1 ? 1 : -1);
    }
    return votes > 0;
  }

  [[nodiscard]] double height_above_layer(std::size_t k, const Vec3& p) const {
    return std::max({0.0, p.z() - borders_[k + 1], borders_[k] - p.z()});
  }

  /// Distance to the wall of layer k, by rays along its section in a few directions: no less than it is.
  double estimate_to_wall(std::size_t k, const Vec3& p) {
    const double up = height_above_layer(k, p);
    double across = kInfinity;
    for (int d = 0; d < kDirections; ++d) {
      const double angle = kPi * d / kDirections;
      for (const double depth : cast({p.x(), p.y(), middle(k)}, {std::cos(angle), std::sin(angle)})) {
        across = std::min(across, std::abs(depth));
      }
    }
    return std::hypot(across, up);
  }

  /// Distance to the wall of layer k, by the curves in which its plane cuts the faces, if it is less than `limit`, else
  /// `limit`. Curves that aren't found make it larger, never less.
  [[nodiscard]] double distance_to_wall(std::size_t k, const Vec3& p, double limit) const {
    const double up = height_above_layer(k, p);
    if (up >= limit) return limit;
    const double reach = std::min(limit, (high_ - low_).norm());
    const gp_Pnt at(p.x(), p.y(), middle(k));
    Bnd_Box near;
    near.Set(at);
    near.Enlarge(reach);
    TopoDS_Compound faces;
    BRep_Builder builder;
    builder.MakeCompound(faces);
    for (const BoxedFace& one : faces_) {
      if (!one.box.IsOut(near)) builder.Add(faces, one.face);
    }
    BRepAlgoAPI_Section section(faces, gp_Pln(at, gp_Dir(0.0, 0.0, 1.0)), false);
    section.Approximation(true);
    section.Build();
    if (!section.IsDone()) return limit;
    const BRepExtrema_DistShapeShape extrema(BRepBuilderAPI_MakeVertex(at).Vertex(), section.Shape());
    return extrema.IsDone() && extrema.NbSolution() > 0 ? std::min(limit, std::hypot(extrema.Value(), up)) : limit;
  }

  /// Distance to the steps above and below the place's layer k, where just one of two layers has it.
  template <class IsBuilt>
  double distance_to_step(std::size_t k, const Vec3& p, const IsBuilt& is_built) {
    double nearest = kInfinity;
    for (std::size_t j = k; j <= k + 1; ++j) {
      const bool below = j > 0 && is_built(j - 1, p);
      const bool above = j < layers() && is_built(j, p);
      if (below != above) nearest = std::min(nearest, std::abs(p.z() - borders_[j]));
    }
    return nearest;
  }

  /// From a point of the solid's surface to the steps above and below and to the walls of its layer and its neighbours.
  void sample_surface(MeasuredDeviation& out) {
    if (facets_.empty()) return;
    const Vec3 p = random_surface_point();
    const double nearest = distance_to_built(p, out.surface);
    // Triangles in the surface's parameters may lie across the face's border.
    if (nearest > out.surface && distance_to_surface(p) > kOnSurface) return;
    ++out.surface_samples;
    if (nearest <= out.surface) return;
    out.surface = nearest;
    out.surface_at = p;
  }

  const TopoDS_Shape& solid_;
  const std::vector<double>& borders_;
  std::mt19937 random_;
  TopoDS_Compound boundary_;
  IntCurvesFace_ShapeIntersector caster_;
  BRepClass3d_SolidClassifier classifier_;
  Vec3 low_ = Vec3::Zero();
  Vec3 high_ = Vec3::Zero();
  std::vector<Facet> facets_;
  std::vector<double> areas_;  ///< running sums
  TopTools_IndexedMapOfShape edges_;
  std::vector<BoxedFace> faces_;
};

}  // namespace

namespace {

std::vector<TopoDS_Shape> solids_of(const std::filesystem::path& step_file) {
  STEPControl_Reader reader;
  if (reader.ReadFile(step_file.c_str()) != IFSelect_RetDone) {
    throw std::runtime_error("OpenCASCADE can't read " + step_file.string());
  }
  reader.TransferRoots();
  std::vector<TopoDS_Shape> out;
  for (TopExp_Explorer solid(reader.OneShape(), TopAbs_SOLID); solid.More(); solid.Next()) {
    out.push_back(solid.Current());
  }
  return out;
}

}  // namespace

MeasuredDeviation measure_deviation(const std::filesystem::path& step_file, const std::vector<double>& borders,
                                    const MeasureOptions& options) {
  MeasuredDeviation out;
  for (const TopoDS_Shape& solid : solids_of(step_file)) {
    SolidMeter(solid, borders, options.seed).measure(options, out);
  }
  return out;
}

double surface_deviation_at(const std::filesystem::path& step_file, std::size_t solid,
                            const std::vector<double>& borders, const Vec3& place) {
  return SolidMeter(solids_of(step_file).at(solid), borders, 1).distance_to_built(place, 0.0);
}

}  // namespace lamella::test
