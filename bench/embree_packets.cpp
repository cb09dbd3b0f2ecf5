#include <algorithm>
#include <array>
#include <embree3/rtcore.h>
#include <limits>
#include <stdexcept>

#include "bench/mesh_peers.h"

namespace lamella::bench {
namespace {

constexpr std::int32_t kLanes = 16;
constexpr std::int32_t kSlab = 16;  ///< layers

struct RayHit {
  unsigned solid;
  float t;

  bool operator<(const RayHit& other) const { return solid != other.solid ? solid < other.solid : t < other.t; }
};

/// What the filter function gets: the hits of each ray of the packet so far.
struct Collector {
  RTCIntersectContext context;  ///< first, so that Embree's pointer to it is one to this
  std::array<std::vector<RayHit>, kLanes> hits;
};

/// Notes every hit and refuses it, so that the traversal goes on to the next: one traversal finds all hits. (Starting
/// again behind each hit takes as many traversals as hits, twice the time on these models, and loses those that
/// coincide.)
void collect(const RTCFilterFunctionNArguments* arguments) {
  auto* collector = reinterpret_cast<Collector*>(arguments->context);
  for (unsigned lane = 0; lane < arguments->N; ++lane) {
    if (arguments->valid[lane] == 0) continue;
    const unsigned ray = RTCRayN_id(arguments->ray, arguments->N, lane);
    collector->hits[ray].push_back(
        {RTCHitN_geomID(arguments->hit, arguments->N, lane), RTCRayN_tfar(arguments->ray, arguments->N, lane)});
    arguments->valid[lane] = 0;
  }
}

/// Hits of the rows of a slab, one after another.
struct FoundRows {
  std::vector<std::size_t> start{0};
  std::vector<RayHit> hits;

  void clear() {
    start.resize(1);
    hits.clear();
  }
};

class EmbreePeer : public Peer {
 public:
  EmbreePeer(const ModelMesh& mesh, const Lattice& lattice) : mesh_(mesh), lattice_(lattice) {}
  ~EmbreePeer() override {
    if (scene_ != nullptr) rtcReleaseScene(scene_);
    if (device_ != nullptr) rtcReleaseDevice(device_);
  }

  void prepare() override {
    device_ = rtcNewDevice("threads=1");
    if (device_ == nullptr) throw std::runtime_error("Embree has no device");
    scene_ = rtcNewScene(device_);
    // Robust: no ray slips between two triangles of a shared edge.
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    for (std::size_t s = 0; s < mesh_.solids.size(); ++s) attach(mesh_.solids[s], static_cast<unsigned>(s));
    rtcCommitScene(scene_);
    rtcInitIntersectContext(&collector_.context);
    collector_.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  }

  void cast(const Batch& batch) override {
    batch_ = batch;
    found_.clear();
    for (std::int32_t layer = batch.first_layer; layer < batch.last_layer; ++layer) {
      for (std::int32_t row = 0; row < lattice_.rows; row += kLanes) cast_packet(layer, row);
    }
  }

  void visit(const RowVisitor& visitor) const override {
    std::vector<double> x;
    for (std::size_t r = 0; r + 1 < found_.start.size(); ++r) {
      const auto layer = batch_.first_layer + static_cast<std::int32_t>(r) / lattice_.rows;
      const auto row = static_cast<std::int32_t>(r) % lattice_.rows;
      for (std::size_t i = found_.start[r]; i < found_.start[r + 1];) {
        const unsigned solid = found_.hits[i].solid;
        x.clear();
        for (; i < found_.start[r + 1] && found_.hits[i].solid == solid; ++i) x.push_back(origin() + found_.hits[i].t);
        visitor(solid, layer, row, x);
      }
    }
  }

  [[nodiscard]] std::int32_t slab_layers() const override { return kSlab; }

 private:
  [[nodiscard]] float origin() const { return static_cast<float>(lattice_.bounds.min().x() - 1.0); }

  void attach(const SolidMesh& solid, unsigned id) {
    if (solid.triangles.empty()) return;
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float), solid.vertices.size()));
    auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                   3 * sizeof(unsigned), solid.triangles.size()));
    for (const Vec3& vertex : solid.vertices) {
      for (int i = 0; i < 3; ++i) *vertices++ = static_cast<float>(vertex[i]);
    }
    for (const auto& triangle : solid.triangles) indices = std::copy(triangle.begin(), triangle.end(), indices);
    rtcSetGeometryIntersectFilterFunction(geometry, collect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene_, geometry, id);
    rtcReleaseGeometry(geometry);
  }

  void cast_packet(std::int32_t layer, std::int32_t first_row) {
    alignas(64) RTCRayHit16 packet;
    alignas(64) std::array<int, kLanes> valid;
    const std::int32_t lanes = std::min(kLanes, lattice_.rows - first_row);
    for (std::int32_t i = 0; i < kLanes; ++i) {
      valid[i] = i < lanes ? -1 : 0;
      packet.ray.org_x[i] = origin();
      packet.ray.org_y[i] = static_cast<float>(lattice_.y(first_row + i));
      packet.ray.org_z[i] = static_cast<float>(lattice_.z(layer));
      packet.ray.dir_x[i] = 1.0F;
      packet.ray.dir_y[i] = packet.ray.dir_z[i] = 0.0F;
      packet.ray.tnear[i] = packet.ray.time[i] = 0.0F;
      packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
      packet.ray.mask[i] = ~0U;
      packet.ray.id[i] = static_cast<unsigned>(i);
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
      collector_.hits[i].clear();
    }
    rtcIntersect16(valid.data(), scene_, &collector_.context, &packet);
    for (std::int32_t i = 0; i < lanes; ++i) {
      std::sort(collector_.hits[i].begin(), collector_.hits[i].end());
      found_.hits.insert(found_.hits.end(), collector_.hits[i].begin(), collector_.hits[i].end());
      found_.start.push_back(found_.hits.size());
    }
  }

  const ModelMesh& mesh_;
  Lattice lattice_;
  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  Collector collector_{};
  Batch batch_;
  FoundRows found_;
};

}  // namespace

std::unique_ptr<Peer> make_embree_peer(const ModelMesh& mesh, const Lattice& lattice) {
  return std::make_unique<EmbreePeer>(mesh, lattice);
}

}  // namespace lamella::bench
