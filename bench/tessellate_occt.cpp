#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <numeric>
#include <unordered_map>

#include "bench/child.h"
#include "bench/model_occt.h"
#include "bench/tessellation.h"

namespace lamella::bench {
namespace {

constexpr double kAngle = 0.5;  ///< rad

/// Joins the triangulations of a solid's faces, each with nodes of its own, along their shared edges.
class Welder {
 public:
  explicit Welder(const TopoDS_Solid& solid) {
    TopExp::MapShapes(solid, TopAbs_EDGE, edges_);
    TopExp::MapShapes(solid, TopAbs_VERTEX, vertices_);
    edge_nodes_.resize(static_cast<std::size_t>(edges_.Extent()) + 1);
    vertex_node_.assign(static_cast<std::size_t>(vertices_.Extent()) + 1, kNone);
    for (TopExp_Explorer it(solid, TopAbs_FACE); it.More(); it.Next()) add_face(TopoDS::Face(it.Current()));
  }

  SolidMesh mesh() {
    SolidMesh mesh;
    std::vector<std::uint32_t> number(points_.size(), kNone);
    for (std::array<std::uint32_t, 3> triangle : triangles_) {
      for (std::uint32_t& corner : triangle) {
        corner = root(corner);
        if (number[corner] == kNone) {
          number[corner] = static_cast<std::uint32_t>(mesh.vertices.size());
          mesh.vertices.push_back(points_[corner]);
        }
        corner = number[corner];
      }
      const bool is_flat = triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
      if (!is_flat) mesh.triangles.push_back(triangle);
    }
    return mesh;
  }

 private:
  static constexpr std::uint32_t kNone = ~std::uint32_t{0};

  std::uint32_t root(std::uint32_t node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

  void add_face(const TopoDS_Face& face) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull()) return;  // the rays will find the hole
    const auto offset = static_cast<std::uint32_t>(points_.size());
    for (int i = 1; i <= triangulation->NbNodes(); ++i) {
      const gp_Pnt point = triangulation->Node(i).Transformed(location.Transformation());
      points_.emplace_back(point.X(), point.Y(), point.Z());
      parent_.push_back(offset + static_cast<std::uint32_t>(i) - 1);
    }
    for (int i = 1; i <= triangulation->NbTriangles(); ++i) {
      int a = 0;
      int b = 0;
      int c = 0;
      triangulation->Triangle(i).Get(a, b, c);
      triangles_.push_back({offset + a - 1, offset + b - 1, offset + c - 1});
    }
    for (TopExp_Explorer it(face, TopAbs_EDGE); it.More(); it.Next()) {
      add_edge(TopoDS::Edge(it.Current()), triangulation, location, offset);
    }
  }

  /// Joins the nodes of one use of an edge with those of its first use. BRepMesh puts both in the edge's own order.
  void add_edge(const TopoDS_Edge& edge, const Handle(Poly_Triangulation) & triangulation,
                const TopLoc_Location& location, std::uint32_t offset) {
    const Handle(Poly_PolygonOnTriangulation) polygon =
        BRep_Tool::PolygonOnTriangulation(edge, triangulation, location);
    if (polygon.IsNull()) return;
    std::vector<std::uint32_t> nodes;
    for (int i = 1; i <= polygon->NbNodes(); ++i) nodes.push_back(offset + polygon->Node(i) - 1);
    std::vector<std::uint32_t>& first = edge_nodes_[static_cast<std::size_t>(edges_.FindIndex(edge))];
    if (first.empty()) first = nodes;
    if (first.size() == nodes.size()) {
      for (std::size_t i = 0; i < nodes.size(); ++i) join(first[i], nodes[i]);
    }
    const TopoDS_Edge forward = TopoDS::Edge(edge.Oriented(TopAbs_FORWARD));
    join_vertex(TopExp::FirstVertex(forward), nodes.front());
    join_vertex(TopExp::LastVertex(forward), nodes.back());
  }

  void join_vertex(const TopoDS_Vertex& vertex, std::uint32_t node) {
    if (vertex.IsNull()) return;
    std::uint32_t& first = vertex_node_[static_cast<std::size_t>(vertices_.FindIndex(vertex))];
    if (first == kNone) first = node;
    join(first, node);
  }

  TopTools_IndexedMapOfShape edges_;
  TopTools_IndexedMapOfShape vertices_;
  std::vector<std::vector<std::uint32_t>> edge_nodes_;
  std::vector<std::uint32_t> vertex_node_;
  std::vector<std::uint32_t> parent_;
  std::vector<Vec3> points_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

}  // namespace

ModelMesh tessellate(const std::filesystem::path& file, double deflection) {
  const std::vector<TopoDS_Solid> solids = occt_solids(file);
  ModelMesh mesh;
  const double start = cpu_seconds();
  for (const TopoDS_Solid& solid : solids) {
    BRepMesh_IncrementalMesh(solid, deflection, Standard_False, kAngle, Standard_False);
  }
  mesh.seconds = cpu_seconds() - start;
  for (const TopoDS_Solid& solid : solids) mesh.solids.push_back(Welder(solid).mesh());
  return mesh;
}

}  // namespace lamella::bench
