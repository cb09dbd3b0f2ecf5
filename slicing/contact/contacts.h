#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/progress.h"
#include "model/measure.h"
#include "slicing/contact/solid_distances.h"

namespace lamella {

/// A piece of a face along which another solid lies within the gap tolerance.
struct ContactPatch {
  Vec3 center = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  ///< of unit length; zero where the surface has none
  Mat3 form = Mat3::Zero();    ///< 1/mm; the surface is normal . d = d . form d, to second order, d from the centre
  double radius = 0.0;         ///< mm; the piece lies within it of the centre
  double bend = 0.0;           ///< mm; and, as sampled, within it of the quadric
};

/// Where two solids lie along one another: within the gap tolerance, where they touch, and beyond it up to the reach.
struct Contact {
  SolidId first;  ///< the lower id
  SolidId second;
  /// Where they touch, ascending by height of the centres; nothing if they don't. Copies share them, each at its
  /// offset.
  std::shared_ptr<const std::vector<ContactPatch>> patches;
  Vec3 offset = Vec3::Zero();  ///< mm, to be added to the centres
  std::vector<FaceId> faces;   ///< that touch, of both solids, ascending
  double tolerance = 0.0;      ///< mm, the largest of the pairs of faces
  Box3 box;                    ///< of the patches and their radii, moved by the offset
  double touching_area =
      0.0;  ///< mm^2, to its perimeter times 1/16 of a face's size; exact where faces are covered whole
  double largest_gap = 0.0;  ///< mm, of what touches
  double gap_area = 0.0;     ///< mm^2 of what is wider than the tolerance
  double gap_volume = 0.0;   ///< mm^3 of it
  double least_gap = 0.0;    ///< mm
  double widest_gap = 0.0;   ///< mm
  Interval touching_z;       ///< mm; lo > hi if nothing touches
  Interval gap_z;            ///< mm; likewise
};

struct ContactOptions {
  std::optional<double> gap_tolerance;  ///< mm; default: the larger of the two faces' own, at least kMinGap
  double reach = 0.0;                   ///< mm: wider gaps aren't looked for
  int threads = 0;
};

/// All contacts of pairs of `solids`, in the order of their ids. Faces of the solid of higher `rank` are divided until
/// their pieces are small, and the distance of each piece's middle from the other solid is asked for, so the result
/// doesn't depend on ids. Pairs that are shifted copies of others with all that is near them (find_alike_pairs) take
/// over the contact of the first of them. Throws Cancelled when asked.
[[nodiscard]] std::vector<Contact> find_contacts(const SolidDistances& distances,
                                                 const IdVector<SolidId, SolidMeasure>& measures,
                                                 const IdVector<SolidId, int>& rank, std::span<const SolidId> solids,
                                                 const ContactOptions& options, const Progress& progress = {});

/// Distance in mm within which two faces touch.
[[nodiscard]] double touching_distance(const Scene& scene, FaceId a, FaceId b,
                                       const std::optional<double>& gap_tolerance);

}  // namespace lamella
