#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <IntCurvesFace_ShapeIntersector.hxx>
#include <algorithm>
#include <gp_Lin.hxx>

#include "bench/model_occt.h"
#include "bench/occt_peer.h"

namespace lamella::bench {
namespace {

constexpr double kTolerance = 1e-7;     ///< OpenCASCADE's own confusion of points, mm
constexpr double kSameCrossing = 1e-6;  ///< mm: two of the same sense within it are an edge's, met on both faces

struct Crossing {
  double x;
  bool enters;
};

struct Solid {
  IntCurvesFace_ShapeIntersector intersector;
  Box3 box;
};

struct FoundRow {
  std::size_t solid;
  std::int32_t layer;
  std::int32_t row;
  std::vector<double> x;
};

class OcctPeer : public Peer {
 public:
  OcctPeer(const std::filesystem::path& file, const Lattice& lattice) : shapes_(occt_solids(file)), lattice_(lattice) {}

  void prepare() override {
    for (const TopoDS_Solid& shape : shapes_) {
      Bnd_Box box;
      BRepBndLib::Add(shape, box, Standard_False);
      Vec3 lo;
      Vec3 hi;
      box.Get(lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z());
      solids_.push_back(std::make_unique<Solid>());
      solids_.back()->box = Box3(lo, hi);
      solids_.back()->intersector.Load(shape, kTolerance);
    }
  }

  void cast(const Batch& batch) override {
    found_.clear();
    for (std::int32_t layer = batch.first_layer; layer < batch.last_layer; ++layer) {
      for (const std::int32_t row : batch.rows) cast_row(layer, row);
    }
  }

  void visit(const RowVisitor& visitor) const override {
    for (const FoundRow& row : found_) visitor(row.solid, row.layer, row.row, row.x);
  }

  [[nodiscard]] bool casts_single_rows() const override { return true; }

 private:
  void cast_row(std::int32_t layer, std::int32_t row) {
    const double y = lattice_.y(row);
    const double z = lattice_.z(layer);
    for (std::size_t s = 0; s < solids_.size(); ++s) {
      const Box3& box = solids_[s]->box;
      if (!(box.min().y() <= y && y <= box.max().y() && box.min().z() <= z && z <= box.max().z())) continue;
      FoundRow found{s, layer, row, crossings(*solids_[s], y, z)};
      if (!found.x.empty()) found_.push_back(std::move(found));
    }
  }

  std::vector<double> crossings(Solid& solid, double y, double z) {
    const double length = solid.box.sizes().x();
    const gp_Lin line(gp_Pnt(solid.box.min().x(), y, z), gp_Dir(1.0, 0.0, 0.0));
    solid.intersector.Perform(line, -0.1 * length, 1.1 * length);
    crossings_.clear();
    for (int k = 1; solid.intersector.IsDone() && k <= solid.intersector.NbPnt(); ++k) {
      crossings_.push_back({solid.box.min().x() + solid.intersector.WParameter(k),
                            solid.intersector.Transition(k) == IntCurveSurface_In});
    }
    std::sort(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    const auto last = std::unique(crossings_.begin(), crossings_.end(), [](const Crossing& a, const Crossing& b) {
      return b.x - a.x < kSameCrossing && a.enters == b.enters;
    });
    std::vector<double> x;
    for (auto it = crossings_.begin(); it != last; ++it) x.push_back(it->x);
    return x;
  }

  std::vector<TopoDS_Solid> shapes_;
  Lattice lattice_;
  std::vector<std::unique_ptr<Solid>> solids_;
  std::vector<Crossing> crossings_;
  std::vector<FoundRow> found_;
};

}  // namespace

std::unique_ptr<Peer> make_occt_peer(const std::filesystem::path& file, const Lattice& lattice) {
  return std::make_unique<OcctPeer>(file, lattice);
}

}  // namespace lamella::bench
