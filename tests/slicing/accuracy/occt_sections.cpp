#include "tests/slicing/accuracy/occt_sections.h"

#include <BRepAdaptor_Curve.hxx>
#include <BRepAlgoAPI_Section.hxx>
#include <BRep_Tool.hxx>
#include <Geom2d_Curve.hxx>
#include <Geom_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Pln.hxx>
#include <optional>
#include <vector>

#include "core/geometry.h"

namespace lamella::test {

namespace {

/// Polygons of edges are refined until areas change by no more than this times the length, mm.
constexpr double kOffset = 1e-9;
constexpr int kSides = 50;
constexpr int kMostSides = 25600;

/// The surface of a face with its derivatives, where the file has it.
class PlacedSurface {
 public:
  explicit PlacedSurface(const TopoDS_Face& face)
      : surface_(BRep_Tool::Surface(face)), sense_(face.Orientation() == TopAbs_REVERSED ? -1.0 : 1.0) {}

  struct At {
    Vec3 point;
    Vec3 du;
    Vec3 dv;
  };
  [[nodiscard]] At at(const Vec2& uv) const {
    gp_Pnt p;
    gp_Vec u;
    gp_Vec v;
    surface_->D1(uv.x(), uv.y(), p, u, v);
    return {{p.X(), p.Y(), p.Z()}, {u.X(), u.Y(), u.Z()}, {v.X(), v.Y(), v.Z()}};
  }
  /// Not a unit vector.
  [[nodiscard]] Vec3 outward(const Vec2& uv) const {
    const At here = at(uv);
    return sense_ * here.du.cross(here.dv);
  }

  /// The place of the surface at a height that is nearest to one, about: down or up its steepest way.
  [[nodiscard]] Vec3 at_height(Vec2 uv, double z) const {
    At here = at(uv);
    for (int k = 0; k < 8; ++k) {
      const double missing = z - here.point.z();
      const Vec3 normal = here.du.cross(here.dv);
      const double squared = normal.squaredNorm();
      const Vec3 way = squared > 0.0 ? Vec3(Vec3::UnitZ() - normal.z() / squared * normal) : Vec3(Vec3::Zero());
      if (std::abs(missing) < 1e-12 || !(way.squaredNorm() > 1e-12)) break;
      const Vec3 step = missing / way.squaredNorm() * way;
      // step = a du + b dv
      const double uu = here.du.squaredNorm();
      const double vv = here.dv.squaredNorm();
      const double both = here.du.dot(here.dv);
      const double det = uu * vv - both * both;
      const double su = step.dot(here.du);
      const double sv = step.dot(here.dv);
      uv += Vec2(su * vv - sv * both, sv * uu - su * both) / det;
      here = at(uv);
    }
    return here.point;
  }

 private:
  Handle(Geom_Surface) surface_;
  double sense_;
};

/// What one edge adds, in its own sense.
struct EdgePart {
  double area = 0.0;
  double length = 0.0;
  Vec2 first = Vec2::Zero();
  Vec2 last = Vec2::Zero();
};

EdgePart part_of(const std::vector<Vec2>& points) {
  EdgePart out;
  out.first = points.front();
  out.last = points.back();
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    const Vec2& a = points[i];
    const Vec2& b = points[i + 1];
    out.area += 0.5 * (a.x() * b.y() - a.y() * b.x());
    out.length += (b - a).norm();
  }
  return out;
}

/// A section's edge on one of the solid's faces; the sense with material on the left.
std::optional<EdgePart> measure(const TopoDS_Edge& edge, const TopoDS_Face& face, double z) {
  const PlacedSurface surface(face);
  double first = 0.0;
  double last = 0.0;
  const auto pcurve = BRep_Tool::CurveOnSurface(edge, face, first, last);
  if (pcurve.IsNull()) return {};
  const auto parameters = [&](double share) {
    const gp_Pnt2d uv = pcurve->Value(first + share * (last - first));
    return Vec2(uv.X(), uv.Y());
  };
  // About the first point, so that areas far from the origin don't cancel.
  const Vec2 origin = surface.at_height(parameters(0.0), z).head<2>();
  const auto polygon = [&](int count) {
    std::vector<Vec2> points;
    for (int k = 0; k <= count; ++k) {
      points.emplace_back(surface.at_height(parameters(static_cast<double>(k) / count), z).head<2>() - origin);
    }
    return part_of(points);
  };
  EdgePart coarse = polygon(kSides);
  EdgePart out = coarse;
  for (int count = 2 * kSides; count <= kMostSides; count *= 2) {
    const EdgePart fine = polygon(count);
    const double before = out.area;
    out = fine;
    // Polygons are off by the square of their sides.
    out.area += (fine.area - coarse.area) / 3.0;
    out.length += (fine.length - coarse.length) / 3.0;
    if (std::abs(out.area - before) <= kOffset * out.length) break;
    coarse = fine;
  }
  out.first += origin;
  out.last += origin;
  out.area += 0.5 * (origin.x() * (out.last - out.first).y() - origin.y() * (out.last - out.first).x());
  const Vec2 before = surface.at_height(parameters(0.499), z).head<2>();
  const Vec2 behind = surface.at_height(parameters(0.501), z).head<2>();
  const Vec3 normal = surface.outward(parameters(0.5));
  const Vec2 way = behind - before;
  const double sense = way.y() * normal.x() - way.x() * normal.y();
  if (sense == 0.0) return {};
  if (sense < 0.0) {
    out.area = -out.area;
    std::swap(out.first, out.last);
  }
  return out;
}

/// Ends of edges that lie within a gap of one another are joined by straight lines to the first of them; whether as
/// many edges begin as end at every such place.
bool join_ends(std::vector<EdgePart>& parts, double gap) {
  struct Place {
    Vec2 at;
    int balance = 0;
  };
  std::vector<Place> places;
  const auto place_of = [&](const Vec2& at, int sign) -> Vec2 {
    Place* nearest = nullptr;
    for (Place& place : places) {
      const double distance = (place.at - at).norm();
      if (distance <= gap && (nearest == nullptr || distance < (nearest->at - at).norm())) nearest = &place;
    }
    if (nearest == nullptr) nearest = &places.emplace_back(Place{at, 0});
    nearest->balance += sign;
    return nearest->at;
  };
  const auto line = [](const Vec2& a, const Vec2& b) { return 0.5 * (a.x() * b.y() - a.y() * b.x()); };
  for (EdgePart& part : parts) {
    part.area += line(place_of(part.first, 1), part.first) + line(part.last, place_of(part.last, -1));
  }
  return std::all_of(places.begin(), places.end(), [](const Place& place) { return place.balance == 0; });
}

OcctSection section_of(const TopoDS_Shape& solid, double z, double gap) {
  TopTools_IndexedMapOfShape faces;
  TopExp::MapShapes(solid, TopAbs_FACE, faces);
  BRepAlgoAPI_Section section(solid, gp_Pln(gp_Pnt(0.0, 0.0, z), gp_Dir(0.0, 0.0, 1.0)), false);
  section.ComputePCurveOn1(true);
  section.Approximation(true);
  section.Build();
  OcctSection out;
  if (!section.IsDone()) return out;
  std::vector<EdgePart> parts;
  for (TopExp_Explorer it(section.Shape(), TopAbs_EDGE); it.More(); it.Next()) {
    const TopoDS_Edge& edge = TopoDS::Edge(it.Current());
    TopoDS_Shape face;
    if (!section.HasAncestorFaceOn1(edge, face)) return out;
    const int known = faces.FindIndex(face);
    if (known == 0) return out;
    const auto part = measure(edge, TopoDS::Face(faces(known)), z);
    if (!part) return out;
    parts.push_back(*part);
  }
  out.is_whole = join_ends(parts, gap);
  for (const EdgePart& part : parts) {
    out.area += part.area;
    out.length += part.length;
  }
  return out;
}

}  // namespace

OcctSection occt_section(const TopoDS_Shape& solid, double z, double gap) {
  try {
    return section_of(solid, z, gap);
  } catch (const Standard_Failure&) {
    return {};
  }
}

}  // namespace lamella::test
