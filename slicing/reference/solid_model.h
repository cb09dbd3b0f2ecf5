#pragma once

#include <cstdint>
#include <vector>

#include "model/rational_form.h"
#include "model/scene.h"
#include "model/trim.h"
#include "slicing/hit.h"
#include "slicing/reference/certified.h"
#include "slicing/reference/edge_zones.h"
#include "slicing/reference/patch_tree.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/reference/sub_patch.h"

namespace lamella::reference {

/// One place where a ray meets the trimmed region of a face.
struct Crossing {
  double t = 0.0;          ///< mm along the ray
  double half_t = 0.0;     ///< mm: half-length of a tangency that stayed undecided
  std::uint32_t face = 0;  ///< number of the face in the solid
  Sense sense = Sense::entry;
  Vec2 uv = Vec2::Zero();
  std::uint8_t flags = 0;
  bool inside = true;  ///< strictly, by the trimmed region alone
  double doubt = 0.0;  ///< mm: size of the zone that puts its existence in doubt, 0 if there is none
};

/// Memory that one thread reuses from ray to ray.
struct CastScratch {
  std::vector<std::uint32_t> candidates;
  PlaneNets nets;
  CertifiedSolver solver;
  std::vector<PatchRoot> roots;
  std::vector<Crossing> crossings;
  std::vector<EdgePass> passes;
};

/// Everything precomputed for the rays through one solid: its sub-patches in a tree of boxes, its trimmed regions and
/// the zones about its edges. The scene must outlive it.
class SolidModel {
 public:
  /// Throws GeometryError for surfaces beyond the stated limits.
  SolidModel(const Scene& scene, SolidId solid, const ReferenceOptions& options);

  /// All crossings of the line into scratch.crossings, ascending in t. Copies of one root on borders that
  /// sub-patches share are dropped for the certified solver; the paper's own solvers are left as they are.
  /// Returns the doubt, mm: the radius of the largest edge zone that the line passes through, at least smallest_step()
  /// where it touches a face or meets the boundary of one in (u, v); 0 if every crossing is certain.
  double find_crossings(const Ray& ray, CastScratch& scratch, CastCounters& counters) const;

  [[nodiscard]] bool meets_box(const Ray& ray) const;
  /// Where `ray` meets face number `face` near `uv`, by Newton's iteration; false if it doesn't converge or strays.
  bool refine_crossing(const Ray& ray, std::uint32_t face, Vec2& uv, double& t) const;
  /// |n.d| where a crossing lies, 0 where the surface has no normal.
  [[nodiscard]] double steepness(const Ray& ray, const Crossing& crossing) const;

  [[nodiscard]] FaceId face_id(std::uint32_t face) const { return faces_[face].id; }
  [[nodiscard]] double size() const { return size_; }                    ///< mm, diagonal of the box
  [[nodiscard]] double smallest_step() const { return smallest_step_; }  ///< mm, least sideways step that breaks a tie
  [[nodiscard]] double merge_distance() const { return merge_distance_; }
  [[nodiscard]] std::size_t patch_count() const { return patches_.size(); }
  [[nodiscard]] std::size_t capped_faces() const { return capped_faces_; }

 private:
  struct FaceModel {
    FaceId id;
    bool same_sense = true;
    RationalForm form;  ///< the maps only; the patches are in patches_
    TrimRegion trim;
  };

  void add_face(FaceId id, const ReferenceOptions& options);
  void solve(const RayPlanes& planes, const SubPatch& patch, CastScratch& scratch, CastCounters& counters) const;
  double add_crossing(const RayPlanes& planes, const SubPatch& patch, const PatchRoot& root, double shift,
                      CastScratch& scratch) const;
  void drop_copies(std::vector<Crossing>& crossings) const;

  const Scene* scene_;
  ReferenceOptions options_;
  std::vector<FaceModel> faces_;
  std::vector<SubPatch> patches_;
  PatchTree tree_;
  Vec3 center_ = Vec3::Zero();
  double size_ = 0.0;
  double accuracy_ = 0.0;  ///< mm, where Newton's iteration stops
  double smallest_step_ = 0.0;
  double merge_distance_ = 0.0;  ///< mm: hits of one face and sense nearer than this are one
  std::size_t capped_faces_ = 0;
  EdgeZones zones_;
};

}  // namespace lamella::reference
