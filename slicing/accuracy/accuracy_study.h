#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.h"
#include "model/measure.h"
#include "model/scene.h"
#include "model/step/step_shapes.h"
#include "slicing/accuracy/crossings.h"
#include "slicing/hit.h"

/// Direct slicing measured against slicing STL files of the same model (docs/methods/accuracy.md).
namespace lamella::accuracy {

struct StudyOptions {
  std::vector<double> deflections{1.0, 0.3, 0.1, 0.03, 0.01, 0.003, 0.001};  ///< mm
  double angle = 0.5;                                                        ///< radians, of the tessellation
  std::size_t rays = 40'000;             ///< about as many, over the box of all solids
  std::size_t oracle_rays = 2'000;       ///< of them, asked of the certified reference engine
  std::size_t occt_rays = 300;           ///< of them, intersected by OpenCASCADE too, solid by solid
  double occt_seconds = 20.0;            ///< after which it is asked no more
  std::size_t distance_samples = 4'000;  ///< crossings of a mesh whose distance from the surface is measured
  std::vector<double> pitches;           ///< mm, of lattices to integrate on; empty: chosen by the model's size
  std::size_t max_triangles = 4'000'000;
  double max_seconds = 300.0;                ///< of tessellating at one deflection, wall time
  std::optional<std::filesystem::path> stl;  ///< keep the STL files in this folder, one a deflection and solid
  int threads = 0;                           ///< 0: all cores
};

/// How far values found lie from exact ones.
struct ValueErrors {
  double largest = 0.0;
  double rms = 0.0;
};

struct DirectResult {
  std::uint64_t rays = 0;  ///< rows times layers
  std::uint64_t hits = 0;
  CastCounters counters;
  double prepare_seconds = 0.0;
  double slice_seconds = 0.0;
  std::uint64_t oracle_rays = 0;  ///< rays of the lattice that the certified engine cast as well
  CrossingErrors errors;          ///< on them, against the certified engine
  CastCounters oracle_counters;
  double oracle_seconds = 0.0;
  std::uint64_t occt_rays = 0;      ///< solid-rays that OpenCASCADE intersected as well
  std::uint64_t occt_odd_rays = 0;  ///< of them with an odd number of intersections, which aren't compared
  CrossingErrors occt_errors;       ///< on the others; "missed" are intersections that direct slicing doesn't have
  double occt_seconds = 0.0;
};

/// The STL side at one deflection.
struct StlResult {
  double deflection = 0.0;          ///< mm, as asked for
  std::string skipped;              ///< why nothing was measured, empty if it was
  std::uint64_t triangles = 0;      ///< of all solids' files
  std::uint64_t bytes = 0;          ///< of all solids' files
  std::uint64_t faces_without = 0;  ///< that the mesher gave up
  CrossingErrors errors;            ///< along the rays, against direct slicing
  ValueErrors distance;             ///< mm, of sampled crossings from the exact surface
  std::uint64_t distance_samples = 0;
  ValueErrors area;           ///< mm^2, of the sections of all solids on all layers
  double section_area = 0.0;  ///< mm^2, rms of the exact sections
  double volume_error = 0.0;  ///< mm^3, sum over the solids of the absolute differences
  std::uint64_t unclosed_rays = 0;
  double tessellate_seconds = 0.0;
  double file_seconds = 0.0;  ///< writing and reading
  double slice_seconds = 0.0;
  double peak_bytes = 0.0;  ///< by which the process grew; zero if the system doesn't say

  [[nodiscard]] double seconds() const { return tessellate_seconds + file_seconds + slice_seconds; }
};

/// Quadrature on a lattice of equal pitch along y and z.
struct LatticeResult {
  double pitch = 0.0;  ///< mm
  std::uint64_t rays = 0;
  double volume_error = 0.0;  ///< mm^3, sum over the solids of the absolute differences of sliced and exact volume
  double volume_bound = 0.0;  ///< mm^3, sum of p_y A_y + p_z A_z
  double surface_bound =
      0.0;  ///< mm, half the diagonal of a voxel of this pitch: how far voxels may reach from the exact surface
  double seconds = 0.0;
};

struct StudyResult {
  std::vector<SolidId> solids;  ///< that were studied: the closed ones
  double volume = 0.0;          ///< mm^3, exact, of them
  double area = 0.0;            ///< mm^2
  Vec3 size = Vec3::Zero();     ///< mm, of their box
  std::uint64_t step_bytes = 0;
  double file_tolerance = 0.0;  ///< mm, the largest edge or vertex tolerance of them
  std::size_t rows = 0;
  std::size_t layers = 0;
  double pitch = 0.0;  ///< mm, of the rays of the comparison
  DirectResult direct;
  std::vector<StlResult> stl;           ///< from coarse to fine
  std::vector<LatticeResult> lattices;  ///< from coarse to fine
};

/// Runs the study on the closed solids of a scene. `shapes` are those that the scene was read with. Throws InputError
/// when there is no closed solid, ExportError when STL files can't be written, Cancelled when asked. Everything but
/// times and memory is the same for any number of threads as long as OpenCASCADE's meshes are.
[[nodiscard]] StudyResult run_study(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures,
                                    StepShapes& shapes, const StudyOptions& options, const Progress& progress = {});

}  // namespace lamella::accuracy
