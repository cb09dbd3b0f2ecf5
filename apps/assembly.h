#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/session.h"
#include "materials/material_rules.h"
#include "model/measure.h"
#include "model/scene.h"
#include "model/step/read_step.h"
#include "model/step/step_shapes.h"

namespace lamella::apps {

/// The model as the verbs need it: geometry, materials and exact integrals.
struct Assembly {
  Scene scene;
  MaterialTable table;
  IdVector<SolidId, SolidMeasure> measures;
  std::vector<Finding> findings;            ///< the reader's, and rules that decide about nothing
  std::vector<std::string> material_files;  ///< that the materials file names
};

/// Reads STEP files as one assembly and says on stderr what is doubtful. The materials file, if any, is read first, so
/// that a slip in it costs no waiting. Throws InputError, UsageError, Cancelled.
/// `shapes`, if given, gets what tessellations are made of.
[[nodiscard]] Assembly read_assembly(const Session& session, std::span<const StepPart> parts,
                                     const std::optional<std::string>& materials, StepShapes* shapes = nullptr);
[[nodiscard]] Assembly read_assembly(const Session& session, const std::vector<std::string>& files,
                                     const std::optional<std::string>& materials, StepShapes* shapes = nullptr);

/// Fills `measures`.
void measure_assembly(const Session& session, Assembly& assembly);

/// Bounds of what a run lays its lattice over. Solids that are left out count too, so that they don't depend on
/// --allow-open; but not where a broken one claims to be larger than 1000 km.
[[nodiscard]] Box3 bounds_of(const Assembly& assembly);
/// Whether the solid counts for bounds_of().
[[nodiscard]] bool has_bounds(const Assembly& assembly, SolidId solid);

/// Whether a run takes the solid without being asked: it is closed, and something is left of it.
[[nodiscard]] bool is_sliceable(const SolidInfo& solid);

/// Throws InputError that lists the solids when there is none to slice.
void require_solid(const Scene& scene, bool allow_open);

}  // namespace lamella::apps
