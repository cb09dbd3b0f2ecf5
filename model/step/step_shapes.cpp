#include "model/step/step_shapes.h"

#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <IMeshTools_Parameters.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressRange.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Face.hxx>
#include <algorithm>
#include <chrono>
#include <fstream>
#include <gp_Lin.hxx>
#include <mutex>
#include <unistd.h>

#include "model/step/convert_solid.h"
#include "model/step/shape_list.h"

namespace lamella {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Bytes of memory that the process holds; zero where the system doesn't say.
double resident_bytes() {
  std::ifstream statm("/proc/self/statm");  // proc(5): pages, total and resident
  double total = 0.0;
  double resident = 0.0;
  if (!(statm >> total >> resident)) return 0.0;
  return resident * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

/// OpenCASCADE's progress as ours; stops the mesher at a limit. It is asked from several threads.
class MeshingProgress : public Message_ProgressIndicator {
 public:
  MeshingProgress(const TessellationOptions& options, const Progress& progress)
      : options_(options), progress_(progress) {}

  Standard_Boolean UserBreak() override {
    if (progress_.cancelled()) return true;
    const std::lock_guard lock(mutex_);
    if (!stopped_.empty()) return true;
    const double seconds = seconds_since(start_);
    if (seconds - looked_at_ < 0.05) return false;
    looked_at_ = seconds;
    if (seconds > options_.max_seconds) stopped_ = "time";
    if (resident_bytes() - start_bytes_ > options_.max_bytes) stopped_ = "memory";
    return !stopped_.empty();
  }
  [[nodiscard]] const std::string& stopped() const { return stopped_; }

 protected:
  void Show(const Message_ProgressScope&, const Standard_Boolean) override {
    progress_.report("tessellating", GetPosition());
  }

 private:
  const TessellationOptions& options_;
  const Progress& progress_;
  const Clock::time_point start_ = Clock::now();
  const double start_bytes_ = resident_bytes();
  std::mutex mutex_;
  double looked_at_ = 0.0;
  std::string stopped_;
};

/// Appends one face's triangles, turned so that they look outward where the face is reversed or mirrored.
void append_face(const TopoDS_Face& face, const Poly_Triangulation& triangulation, const TopLoc_Location& location,
                 TriangleMesh& mesh) {
  const gp_Trsf placement = location.Transformation();
  const bool is_turned = (face.Orientation() == TopAbs_REVERSED) != static_cast<bool>(placement.IsNegative());
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int i = 1; i <= triangulation.NbNodes(); ++i) {
    const gp_Pnt point = triangulation.Node(i).Transformed(placement);
    mesh.vertices.emplace_back(point.X(), point.Y(), point.Z());
  }
  for (int i = 1; i <= triangulation.NbTriangles(); ++i) {
    int a = 0;
    int b = 0;
    int c = 0;
    triangulation.Triangle(i).Get(a, b, c);
    if (is_turned) std::swap(b, c);
    mesh.triangles.push_back({first + a - 1, first + b - 1, first + c - 1});
  }
}

/// Calls visit(face, triangulation or null, location) for the faces of a shape.
template <class Visit>
void for_each_face(const TopoDS_Shape& shape, const Visit& visit) {
  for (TopExp_Explorer it(shape, TopAbs_FACE); it.More(); it.Next()) {
    const TopoDS_Face face = TopoDS::Face(it.Current());
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    visit(face, triangulation.get(), location);
  }
}

void count(const TopoDS_Shape& shape, Tessellation& result) {
  for_each_face(shape, [&](const TopoDS_Face&, const Poly_Triangulation* triangulation, const TopLoc_Location&) {
    if (triangulation == nullptr) {
      ++result.faces_without;
    } else {
      result.triangles += static_cast<std::size_t>(triangulation->NbTriangles());
    }
  });
}

TriangleMesh mesh_of(const TopoDS_Shape& shape) {
  TriangleMesh mesh;
  for_each_face(shape,
                [&](const TopoDS_Face& face, const Poly_Triangulation* triangulation, const TopLoc_Location& location) {
                  if (triangulation != nullptr) append_face(face, *triangulation, location, mesh);
                });
  return mesh;
}

std::vector<TopoDS_Shape> solids_of(const step::ShapeList& list, std::span<const SolidId> solids) {
  std::vector<TopoDS_Shape> shapes;
  for (const SolidId solid : solids) shapes.push_back(step::without_scaling(list.shapes.at(solid.value())));
  return shapes;
}

Tessellation run(const std::vector<TopoDS_Shape>& solids, const TessellationOptions& options,
                 const Progress& progress) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const TopoDS_Shape& solid : solids) builder.Add(compound, solid);
  // A finer mesh of an earlier run would be kept, and its time would be nothing.
  BRepTools::Clean(compound);
  IMeshTools_Parameters parameters;
  parameters.Deflection = options.deflection;
  parameters.Angle = options.angle;
  parameters.InParallel = options.in_parallel;
  const Handle(MeshingProgress) indicator = new MeshingProgress(options, progress);
  Tessellation result;
  const Clock::time_point start = Clock::now();
  BRepMesh_IncrementalMesh(compound, parameters, indicator->Start());
  result.seconds = seconds_since(start);
  result.stopped = indicator->stopped();
  progress.throw_if_cancelled();
  if (result.stopped.empty()) {
    for (const TopoDS_Shape& solid : solids) count(solid, result);
    if (result.triangles > options.max_triangles) result.stopped = "triangles";
  }
  if (result.stopped.empty()) {
    for (const TopoDS_Shape& solid : solids) result.solids.push_back(mesh_of(solid));
  }
  BRepTools::Clean(compound);
  return result;
}

constexpr double kSameDepth = 1e-6;  ///< mm

/// Depths of the intersections of one line, copies at edges dropped.
std::vector<double> intersect_ray(IntCurvesFace_ShapeIntersector& intersector, const Ray& ray) {
  const gp_Lin line(gp_Pnt(ray.origin.x(), ray.origin.y(), ray.origin.z()),
                    gp_Dir(ray.direction.x(), ray.direction.y(), ray.direction.z()));
  constexpr double kFar = 1e10;  // mm
  intersector.Perform(line, -kFar, kFar);
  std::vector<std::pair<double, bool>> found;
  for (int k = 1; intersector.IsDone() && k <= intersector.NbPnt(); ++k) {
    found.emplace_back(intersector.WParameter(k), intersector.Transition(k) == IntCurveSurface_In);
  }
  std::sort(found.begin(), found.end());
  const auto last = std::unique(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return b.first - a.first < kSameDepth && a.second == b.second;
  });
  std::vector<double> depths;
  for (auto it = found.begin(); it != last; ++it) depths.push_back(it->first);
  return depths;
}

}  // namespace

StepShapes::StepShapes() : list_(std::make_unique<step::ShapeList>()) {}
StepShapes::~StepShapes() = default;
StepShapes::StepShapes(StepShapes&&) noexcept = default;
StepShapes& StepShapes::operator=(StepShapes&&) noexcept = default;

std::size_t StepShapes::size() const { return list_->shapes.size(); }

Tessellation StepShapes::tessellate(std::span<const SolidId> solids, const TessellationOptions& options,
                                    const Progress& progress) {
  try {
    return run(solids_of(*list_, solids), options, progress);
  } catch (const Standard_Failure& failure) {
    throw GeometryError(std::string("OpenCASCADE can't tessellate the model: ") + failure.GetMessageString(), {},
                        "choose another deflection");
  }
}

std::vector<std::vector<double>> StepShapes::intersect(SolidId solid, std::span<const Ray> rays,
                                                       const Progress& progress) const {
  constexpr double kConfusion = 1e-7;  // mm, OpenCASCADE's own
  std::vector<std::vector<double>> depths;
  try {
    IntCurvesFace_ShapeIntersector intersector;
    intersector.Load(step::without_scaling(list_->shapes.at(solid.value())), kConfusion);
    for (const Ray& ray : rays) {
      progress.throw_if_cancelled();
      depths.push_back(intersect_ray(intersector, ray));
    }
  } catch (const Standard_Failure& failure) {
    throw GeometryError(std::string("OpenCASCADE can't intersect the model with rays: ") + failure.GetMessageString(),
                        {}, "leave its oracle out");
  }
  return depths;
}

}  // namespace lamella
