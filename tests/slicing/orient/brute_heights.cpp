// Writes the least height over all orientations of STEP files, by brute force and by OpenCASCADE alone, one line each:
// file, height in mm, the direction that points up, number of points.
//   brute_heights FILE... > brute_heights.tsv
// Points lie on the exact edges (chord error 1e-7 of the model's size) and on meshes of faces that are curved both ways
// (deflection 2e-6 of it, nodes on the surface). Every quarter of a degree of the half sphere is tried on the
// vertices and some 3000 of the rest; the lowest 40 local minima of that are refined on all points, by ever finer grids
// of 9 x 9 directions.
#include <BRepAdaptor_Curve.hxx>
#include <BRepAdaptor_Surface.hxx>
#include <BRepBndLib.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Bnd_Box.hxx>
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <GCPnts_QuasiUniformDeflection.hxx>
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

void add_edge(const TopoDS_Edge& edge, double size, std::vector<Vector3d>& points) {
  if (BRep_Tool::Degenerated(edge)) return;
  const BRepAdaptor_Curve curve(edge);
  const GCPnts_QuasiUniformDeflection places(curve, 1e-7 * size);
  for (int i = 1; places.IsDone() && i <= places.NbPoints(); ++i) points.push_back(vector_of(places.Value(i)));
}

void add_face(const TopoDS_Face& face, double size, std::vector<Vector3d>& points) {
  switch (BRepAdaptor_Surface(face).GetType()) {
    case GeomAbs_Plane:
    case GeomAbs_Cylinder:
    case GeomAbs_Cone:
    case GeomAbs_SurfaceOfExtrusion:
      return;  // straight one way: what is furthest lies on an edge
    default:
      break;
  }
  BRepMesh_IncrementalMesh(face, 2e-6 * size, Standard_False, 0.02);
  TopLoc_Location place;
  const Handle(Poly_Triangulation) mesh = BRep_Tool::Triangulation(face, place);
  for (int i = 1; !mesh.IsNull() && i <= mesh->NbNodes(); ++i)
    points.push_back(vector_of(mesh->Node(i).Transformed(place.Transformation())));
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

Points points_of(const TopoDS_Shape& all) {
  std::vector<Vector3d> found;
  const double size = size_of(all);
  for (TopExp_Explorer solid(all, TopAbs_SOLID); solid.More(); solid.Next()) {
    TopTools_IndexedMapOfShape edges;
    TopExp::MapShapes(solid.Current(), TopAbs_EDGE, edges);
    for (int i = 1; i <= edges.Extent(); ++i) add_edge(TopoDS::Edge(edges(i)), size, found);
    for (TopExp_Explorer face(solid.Current(), TopAbs_FACE); face.More(); face.Next())
      add_face(TopoDS::Face(face.Current()), size, found);
  }
  return matrix_of(found);
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

/// All steps together lead less than 0.9 degrees away.
Place refine(const Points& all, Place best) {
  const Points points = points_near(all, best.up);
  best.height = height(points, best.up);
  for (double step = kStep; step > 1e-11; step *= 0.6) {
    const Vector3d x = best.up.unitOrthogonal();
    const Vector3d y = best.up.cross(x);
    const Vector3d middle = best.up;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const Vector3d up = (middle + 0.25 * step * (i * x + j * y)).normalized();
        const double own = height(points, up);
        if (own < best.height) best = {own, up};
      }
    }
  }
  return best;
}

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
  const Points curves = outer_points(points_of(reader.OneShape()));
  if (corners.rows() == 0 || curves.rows() == 0) return false;
  // The vertices and, of the rest, about 3000: what the quarters of a degree are tried on.
  Points points(corners.rows() + curves.rows(), 3);
  points << corners, curves;
  points = outer_points(points);
  const Eigen::Index stride = std::max<Eigen::Index>(1, curves.rows() / 3000);
  std::vector<Vector3d> few;
  for (Eigen::Index i = 0; i < corners.rows(); ++i) few.push_back(corners.row(i));
  for (Eigen::Index i = 0; i < curves.rows(); i += stride) few.push_back(curves.row(i));
  Place best{1e300, Vector3d::UnitZ()};
  for (const Place& start : try_sphere(outer_points(matrix_of(few)))) {
    const Place found = refine(points, start);
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
