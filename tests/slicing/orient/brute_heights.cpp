// Writes the least height over all orientations of STEP files, by brute force and by OpenCASCADE alone, one line each:
// file, height in mm, the direction that points up, number of points.
//   brute_heights FILE... > brute_heights.tsv
// Points lie on the exact edges (chord error 1e-6 of the model's size) and on meshes of faces that are curved both ways
// (deflection 5e-5 of it, nodes on the surface). Every quarter of a degree of the half sphere is tried on the vertices
// and some 3000 of the rest; the lowest 40 local minima of that are refined on all points, by ever finer grids of 9 x 9
// directions. Of these, those within 1e-3 of the lowest are refined again with exact heights: from the furthest points
// of every face and edge Newton's method climbs to the furthest of the curve or surface itself; it counts if the face
// has it.
#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTopAdaptor_FClass2d.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <GCPnts_QuasiUniformDeflection.hxx>
#include <Geom_Surface.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

namespace {

using Eigen::Vector3d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 3>;

constexpr double kPi = 3.14159265358979323846;
constexpr double kStep = 0.25 / 180.0 * kPi;

Vector3d vector_of(const gp_Pnt& point) { return {point.X(), point.Y(), point.Z()}; }

double size_of(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::Add(shape, box);
  return std::sqrt(box.SquareExtent());
}

constexpr double kChord = 1e-6;       // of the size
constexpr double kDeflection = 5e-5;  // of the size

/// Of what exact furthest points are sought: an edge, or a face that is curved both ways.
class Piece {
 public:
  virtual ~Piece() = default;
  /// How far along `up` the piece reaches near its point `i`.
  [[nodiscard]] virtual double climb(Eigen::Index i, const Vector3d& up) const = 0;

  Points points;
  double slack = 0.0;  ///< how far the piece may reach beyond its points
};

class EdgePiece : public Piece {
 public:
  EdgePiece(const TopoDS_Edge& edge, double size) : curve_(edge) {
    const GCPnts_QuasiUniformDeflection places(curve_, kChord * size);
    if (!places.IsDone()) return;
    points.resize(places.NbPoints(), 3);
    for (int i = 1; i <= places.NbPoints(); ++i) {
      points.row(i - 1) = vector_of(places.Value(i));
      parameters_.push_back(places.Parameter(i));
    }
    slack = 2.0 * kChord * size;
  }

  [[nodiscard]] double climb(Eigen::Index i, const Vector3d& up) const override {
    double t = parameters_[i];
    double best = points.row(i).dot(up);
    for (int k = 0; k < 20; ++k) {
      gp_Pnt p;
      gp_Vec first;
      gp_Vec second;
      curve_.D2(t, p, first, second);
      best = std::max(best, vector_of(p).dot(up));
      const double slope = along(first, up);
      const double bend = along(second, up);
      if (!(bend < 0.0)) break;
      const double step = -slope / bend;
      t = std::clamp(t + step, curve_.FirstParameter(), curve_.LastParameter());
      if (std::abs(step) <= 1e-14 * (1.0 + std::abs(t))) break;
    }
    return best;
  }

  static double along(const gp_Vec& v, const Vector3d& up) { return v.X() * up.x() + v.Y() * up.y() + v.Z() * up.z(); }

 private:
  BRepAdaptor_Curve curve_;
  std::vector<double> parameters_;
};

class FacePiece : public Piece {
 public:
  FacePiece(const TopoDS_Face& face, double size)
      : surface_(BRep_Tool::Surface(face)), region_(std::make_unique<BRepTopAdaptor_FClass2d>(face, 1e-9)) {
    BRepMesh_IncrementalMesh(face, kDeflection * size, Standard_False, 0.05);
    TopLoc_Location place;
    const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
    if (mesh.IsNull() || !mesh->HasUVNodes()) return;
    points.resize(mesh->NbNodes(), 3);
    for (int i = 1; i <= mesh->NbNodes(); ++i) {
      points.row(i - 1) = vector_of(mesh->Node(i).Transformed(place.Transformation()));
      parameters_.push_back(mesh->UVNode(i));
    }
    slack = 4.0 * kDeflection * size;
  }

  [[nodiscard]] double climb(Eigen::Index i, const Vector3d& up) const override {
    gp_Pnt2d at = parameters_[i];
    for (int k = 0; k < 40; ++k) {
      gp_Pnt p;
      gp_Vec u, v, uu, vv, uv;
      surface_->D2(at.X(), at.Y(), p, u, v, uu, vv, uv);
      double a = EdgePiece::along(uu, up);
      const double b = EdgePiece::along(uv, up);
      double c = EdgePiece::along(vv, up);
      // No hill, or one that is flat one way: bent down until it is.
      const double bend =
          (std::abs(a) + std::abs(b)) / u.SquareMagnitude() + (std::abs(c) + std::abs(b)) / v.SquareMagnitude();
      for (double more = 1e-6 * bend; !(a < 0.0 && a * c - b * b > 1e-9 * a * c) && more > 0.0 && std::isfinite(more);
           more *= 10.0) {
        a -= more * u.SquareMagnitude();
        c -= more * v.SquareMagnitude();
      }
      const double det = a * c - b * b;
      if (!(a < 0.0 && det > 0.0)) break;
      const double gu = EdgePiece::along(u, up);
      const double gv = EdgePiece::along(v, up);
      const double du = -(c * gu - b * gv) / det;
      const double dv = -(a * gv - b * gu) / det;
      at.SetCoord(at.X() + du, at.Y() + dv);
      if (std::abs(du) + std::abs(dv) > 1e-13 * (1.0 + std::abs(at.X()) + std::abs(at.Y()))) continue;
      break;
    }
    if (region_->Perform(at) == TopAbs_OUT) return points.row(i).dot(up);
    return std::max(points.row(i).dot(up), vector_of(surface_->Value(at.X(), at.Y())).dot(up));
  }

 private:
  Handle(Geom_Surface) surface_;
  std::unique_ptr<BRepTopAdaptor_FClass2d> region_;
  std::vector<gp_Pnt2d> parameters_;
};

/// Faces that are straight one way have what is furthest on an edge.
bool is_curved_both_ways(const TopoDS_Face& face) {
  switch (BRepAdaptor_Surface(face).GetType()) {
    case GeomAbs_Plane:
    case GeomAbs_Cylinder:
    case GeomAbs_Cone:
    case GeomAbs_SurfaceOfExtrusion:
      return false;
    default:
      return true;
  }
}
Points matrix_of(const std::vector<Vector3d>& list) {
  Points points(list.size(), 3);
  for (std::size_t i = 0; i < list.size(); ++i) points.row(i) = list[i];
  return points;
}

Points corners_of(const TopoDS_Shape& all) {
  std::vector<Vector3d> found;
  for (TopExp_Explorer solid(all, TopAbs_SOLID); solid.More(); solid.Next()) {
    for (TopExp_Explorer vertex(solid.Current(), TopAbs_VERTEX); vertex.More(); vertex.Next())
      found.push_back(vector_of(BRep_Tool::Pnt(TopoDS::Vertex(vertex.Current()))));
  }
  return matrix_of(found);
}

using Pieces = std::vector<std::unique_ptr<Piece>>;

Pieces pieces_of(const TopoDS_Shape& all) {
  Pieces found;
  const double size = size_of(all);
  for (TopExp_Explorer solid(all, TopAbs_SOLID); solid.More(); solid.Next()) {
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(solid.Current(), TopAbs_EDGE, edges);
    for (int i = 1; i <= edges.Extent(); ++i) {
      const TopoDS_Edge& edge = TopoDS::Edge(edges(i));
      if (!BRep_Tool::Degenerated(edge)) found.push_back(std::make_unique<EdgePiece>(edge, size));
    }
    for (TopExp_Explorer it(solid.Current(), TopAbs_FACE); it.More(); it.Next()) {
      const TopoDS_Face& face = TopoDS::Face(it.Current());
      if (is_curved_both_ways(face)) found.push_back(std::make_unique<FacePiece>(face, size));
    }
  }
  std::erase_if(found, [](const auto& piece) { return piece->points.rows() == 0; });
  return found;
}

Points points_of(const Pieces& pieces) {
  Eigen::Index rows = 0;
  for (const auto& piece : pieces) rows += piece->points.rows();
  Points points(rows, 3);
  rows = 0;
  for (const auto& piece : pieces) {
    points.middleRows(rows, piece->points.rows()) = piece->points;
    rows += piece->points.rows();
  }
  return points;
}

double height(const Points& points, const Vector3d& up) {
  const Eigen::VectorXd along = points * up;
  return along.maxCoeff() - along.minCoeff();
}

struct Place {
  double height;
  Vector3d up;
};

Vector3d direction(double polar, double around) {
  return {std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)};
}

/// The lowest of each ring's local minima along it: enough starts for the grids, which then move across rings.
std::vector<Place> try_sphere(const Points& few) {
  std::vector<Place> minima;
  for (int ring = 0; ring <= 360; ++ring) {
    const double polar = ring * kStep;
    const int count = std::max(1, static_cast<int>(std::ceil(2.0 * kPi * std::sin(polar) / kStep)));
    std::vector<Place> places;
    for (int i = 0; i < count; ++i) {
      const Vector3d up = direction(polar, 2.0 * kPi * i / count);
      places.push_back({height(few, up), up});
    }
    for (int i = 0; i < count; ++i) {
      const double own = places[i].height;
      if (own <= places[(i + 1) % count].height && own <= places[(i + count - 1) % count].height)
        minima.push_back(places[i]);
    }
  }
  std::sort(minima.begin(), minima.end(), [](const Place& a, const Place& b) { return a.height < b.height; });
  std::vector<Place> apart;
  for (const Place& one : minima) {
    const bool is_new = std::none_of(apart.begin(), apart.end(),
                                     [&](const Place& p) { return std::abs(p.up.dot(one.up)) > std::cos(4 * kStep); });
    if (is_new) apart.push_back(one);
    if (apart.size() == 40) break;
  }
  return apart;
}

/// What can be furthest within a degree of `up`.
Points points_near(const Points& points, const Vector3d& up) {
  const double size = (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
  const double slack = size * std::sin(1.0 / 180.0 * kPi);
  const Eigen::VectorXd along = points * up;
  const double high = along.maxCoeff() - slack;
  const double low = along.minCoeff() + slack;
  std::vector<Vector3d> near;
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (along[i] >= high || along[i] <= low) near.push_back(points.row(i));
  }
  return matrix_of(near);
}

/// By ever finer grids, down to 1e-11 rad. Steps of 0.4 degrees at most, all together, lead less than 0.9 degrees away.
template <class Height>
Place refine(Place best, double first_step, const Height& height_along) {
  best.height = height_along(best.up);
  for (double step = first_step; step > 1e-11; step *= 0.6) {
    const Vector3d x = best.up.unitOrthogonal();
    const Vector3d y = best.up.cross(x);
    const Vector3d middle = best.up;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const Vector3d up = (middle + 0.25 * step * (i * x + j * y)).normalized();
        const double own = height_along(up);
        if (own < best.height) best = {own, up};
      }
    }
  }
  return best;
}

/// Exact heights for directions within a degree of one.
class ExactHeight {
 public:
  ExactHeight(const Pieces& pieces, const Points& points, const Vector3d& up) {
    const double size = (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
    const double turn = 2.0 * size * std::sin(1.0 / 180.0 * kPi);
    const Eigen::VectorXd along = points * up;
    for (const auto& piece : pieces) {
      const Eigen::VectorXd own = piece->points * up;
      for (const double way : {1.0, -1.0}) {
        const double furthest = (way * along).maxCoeff();
        if ((way * own).maxCoeff() + piece->slack + turn >= furthest)
          (way > 0.0 ? upper_ : lower_).push_back(piece.get());
      }
    }
  }

  double operator()(const Vector3d& up) const { return reach(upper_, up) + reach(lower_, -up); }

 private:
  /// Climbs from several points of each piece: at a seam the first may be on its wrong side.
  static double reach(const std::vector<const Piece*>& pieces, const Vector3d& up) {
    constexpr std::size_t kStarts = 8;
    std::vector<Eigen::VectorXd> along;
    double far = -1e300;
    for (const Piece* piece : pieces) {
      along.push_back(piece->points * up);
      far = std::max(far, along.back().maxCoeff());
    }
    double exact = far;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      std::vector<Eigen::Index> starts;
      for (Eigen::Index i = 0; i < along[k].size(); ++i) {
        if (along[k][i] + pieces[k]->slack >= far) starts.push_back(i);
      }
      const std::size_t count = std::min(kStarts, starts.size());
      const auto middle = starts.begin() + static_cast<std::ptrdiff_t>(count);
      std::partial_sort(starts.begin(), middle, starts.end(),
                        [&](Eigen::Index a, Eigen::Index b) { return along[k][a] > along[k][b]; });
      for (std::size_t i = 0; i < count; ++i) exact = std::max(exact, pieces[k]->climb(starts[i], up));
    }
    return exact;
  }

  std::vector<const Piece*> upper_;
  std::vector<const Piece*> lower_;
};

/// Points that are within `slack` of the furthest along some direction of a coarse grid: the rest can't matter.
Points outer_points(const Points& points) {
  const double size = (points.colwise().maxCoeff() - points.colwise().minCoeff()).norm();
  // What is furthest along a direction is behind by at most size sin(angle) along its neighbour; on this grid every
  // direction has one within 1.5 degrees.
  const double slack = size * std::sin(1.5 / 180.0 * kPi);
  std::vector<char> is_outer(points.rows(), 0);
  for (int ring = 0; ring <= 90; ++ring) {
    const double polar = ring * kPi / 90.0;
    const int count = std::max(1, static_cast<int>(std::ceil(180.0 * std::sin(polar))));
    for (int i = 0; i < count; ++i) {
      const Eigen::VectorXd along = points * direction(polar, 2.0 * kPi * i / count);
      const double far = along.maxCoeff() - slack;
      for (Eigen::Index p = 0; p < along.size(); ++p) is_outer[p] |= along[p] >= far;
    }
  }
  std::vector<Eigen::Index> kept;
  for (Eigen::Index p = 0; p < points.rows(); ++p) {
    if (is_outer[p]) kept.push_back(p);
  }
  Points outer(kept.size(), 3);
  for (std::size_t i = 0; i < kept.size(); ++i) outer.row(i) = points.row(kept[i]);
  return outer;
}

bool write_height(const std::filesystem::path& path) {
  STEPControl_Reader reader;
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) return false;
  reader.TransferRoots();
  const Points corners = corners_of(reader.OneShape());
  const Pieces pieces = pieces_of(reader.OneShape());
  const Points curves = outer_points(points_of(pieces));
  if (corners.rows() == 0 || curves.rows() == 0) return false;
  // The vertices and, of the rest, about 3000: what the quarters of a degree are tried on.
  Points points(corners.rows() + curves.rows(), 3);
  points << corners, curves;
  points = outer_points(points);
  const Eigen::Index stride = std::max<Eigen::Index>(1, curves.rows() / 3000);
  std::vector<Vector3d> few;
  for (Eigen::Index i = 0; i < corners.rows(); ++i) few.push_back(corners.row(i));
  for (Eigen::Index i = 0; i < curves.rows(); i += stride) few.push_back(curves.row(i));
  std::vector<Place> minima;
  for (const Place& start : try_sphere(outer_points(matrix_of(few)))) {
    const Points near = points_near(points, start.up);
    minima.push_back(refine(start, kStep, [&](const Vector3d& up) { return height(near, up); }));
  }
  std::sort(minima.begin(), minima.end(), [](const Place& a, const Place& b) { return a.height < b.height; });
  Place best{1e300, Vector3d::UnitZ()};
  for (const Place& start : minima) {
    if (start.height > 1.001 * minima.front().height) break;
    const Place found = refine(start, 0.2 * kStep, ExactHeight(pieces, points, start.up));
    if (found.height < best.height) best = found;
  }
  std::printf("%s\t%.12g\t%.9g\t%.9g\t%.9g\t%ld\n", path.filename().c_str(), best.height, best.up.x(), best.up.y(),
              best.up.z(), static_cast<long>(points.rows()));
  std::fflush(stdout);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  Message::DefaultMessenger()->ChangePrinters().Clear();
  for (int i = 1; i < argc; ++i) {
    if (!write_height(argv[i])) std::fprintf(stderr, "can't read %s\n", argv[i]);
  }
  return 0;
}
