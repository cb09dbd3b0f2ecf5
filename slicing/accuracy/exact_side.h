#pragma once

#include <vector>

#include "model/measure.h"
#include "model/scene.h"
#include "slicing/accuracy/accuracy_study.h"
#include "slicing/slab_engine.h"

namespace lamella::accuracy {

/// Crossings of all solids studied, in their order, with one lattice.
using SolidCrossings = std::vector<Crossings>;

/// The span engine's crossings with the rows of a plan, by solid. Adds what it met to `counters`.
[[nodiscard]] SolidCrossings cut_exactly(const SlabEngine& engine, const LayerPlan& plan,
                                         std::span<const SolidId> solids, CastCounters& counters,
                                         const Progress& progress, int threads);

/// Volumes of the solids by the rows of a plan, mm^3: sums of lengths times p_y p_z.
[[nodiscard]] std::vector<double> integrate(const SlabEngine& engine, const LayerPlan& plan,
                                            std::span<const SolidId> solids, const Progress& progress, int threads);

/// What the certified reference engine says on every n-th ray, about `count` of them, and how far `exact` is from it.
void ask_oracle(const Scene& scene, const IdVector<SolidId, SolidMeasure>& measures, std::span<const SolidId> solids,
                const RayLattice& lattice, const SolidCrossings& exact, std::size_t count, const Progress& progress,
                int threads, DirectResult& result);

/// The same for OpenCASCADE's intersector, on rays in an order at random, until the time is over.
void ask_occt(const StepShapes& shapes, const IdVector<SolidId, SolidMeasure>& measures,
              std::span<const SolidId> solids, const RayLattice& lattice, const SolidCrossings& exact,
              const StudyOptions& options, const Progress& progress, DirectResult& result);

/// Exact areas of the sections of each solid at the layers, mm^2; zero beyond its box.
[[nodiscard]] std::vector<std::vector<double>> exact_section_areas(const Scene& scene,
                                                                   const IdVector<SolidId, SolidMeasure>& measures,
                                                                   std::span<const SolidId> solids,
                                                                   const std::vector<double>& heights,
                                                                   const Progress& progress, int threads);

}  // namespace lamella::accuracy
