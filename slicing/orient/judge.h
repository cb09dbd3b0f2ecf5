#pragma once

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "materials/machine.h"
#include "materials/material_table.h"
#include "model/measure.h"
#include "slicing/orient/footprint.h"
#include "slicing/orient/surface_samples.h"

namespace lamella {

/// What an orientation is judged by. Lengths mm, areas mm^2, volumes mm^3.
struct OrientationFigures {
  double height = 0.0;        ///< exact
  long layers = 0;            ///< of the layer height that was asked for
  double support_area = 0.0;  ///< of the surface that faces down flatter than the critical angle and isn't on the plate
  double support_volume = 0.0;  ///< between that surface and what is straight below it
  double cusp_error = 0.0;      ///< layer height times |n . up|, mean over the outside, flat tops and bottoms left out
  double largest_cusp = 0.0;
  double contact_area = 0.0;  ///< of plane faces that lie on the plate
  long tool_changes = 0;      ///< estimate
  double touched_area = 0.0;  ///< of faces that are to stay free of support, but have it on or below them
};

/// What is judged by it.
struct JudgeOptions {
  double layer_height = 0.1;                   ///< mm
  double critical_angle = 45.0 / 180.0 * kPi;  ///< radians from the plate; flatter undersides need support
  std::vector<FaceId> free_faces = {};         ///< that support must not touch
  bool counts_tools = false;                   ///< the machine changes tools between materials within a layer
};

/// Judges orientations of an assembly. Immutable; may be asked from several threads.
class OrientationJudge {
 public:
  /// The scene must outlive it. `measures`, `table`: one a solid of the scene.
  OrientationJudge(const Scene& scene, std::span<const SolidId> solids, const MaterialTable& table,
                   const IdVector<SolidId, SolidMeasure>& measures, const SupportFunction& support,
                   SurfaceSamples samples, JudgeOptions options, const Progress& progress = {}, int threads = 0);

  /// With `up` pointing up, a unit vector.
  [[nodiscard]] OrientationFigures judge(const Vec3& up) const;

  /// How far the sampled volume of support is off, about: half the difference of the two halves of the samples.
  [[nodiscard]] double support_error(const Vec3& up) const;

  /// The figures' sizes that make them comparable: each divided by its own is about 1 at worst.
  [[nodiscard]] const OrientationFigures& scale() const { return scale_; }
  [[nodiscard]] const SurfaceSamples& samples() const { return samples_; }
  /// Vertices and samples, for outlines.
  [[nodiscard]] std::vector<Vec3> outline_points() const;
  /// Outward normal and area of every plane face.
  [[nodiscard]] std::vector<std::pair<Vec3, double>> plane_areas() const;
  [[nodiscard]] const JudgeOptions& options() const { return options_; }

 private:
  struct PlaneFace {
    FaceId face;
    Vec3 normal;  ///< outward
    Vec3 point;
    double area = 0.0;
  };
  /// Solids of one material by themselves, for heights.
  struct Part {
    MaterialId material;
    SupportFunction support;
  };
  struct SupportNeed {
    double area = 0.0;
    double volume = 0.0;
    double touched = 0.0;
  };

  void find_planes(const Scene& scene, std::span<const SolidId> solids);
  void set_scale(const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids);
  [[nodiscard]] double contact_area(const Vec3& up, double plate) const;
  void add_cusps(const Vec3& up, OrientationFigures& figures) const;
  /// Of every `stride`-th sample from `first` on.
  [[nodiscard]] SupportNeed support_need(const Vec3& up, double plate, std::size_t first, std::size_t stride) const;
  [[nodiscard]] long count_tool_changes(const Vec3& up, double plate, long layers) const;

  const SupportFunction& support_;
  SurfaceSamples samples_;
  JudgeOptions options_;
  std::vector<PlaneFace> planes_;
  std::vector<Part> parts_;
  std::size_t materials_ = 0;
  std::vector<char> is_free_;  ///< per face of the scene
  OrientationFigures scale_;
};

}  // namespace lamella
