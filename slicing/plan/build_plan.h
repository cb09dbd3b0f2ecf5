#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "materials/machine.h"
#include "slicing/layer_sink.h"
#include "slicing/plan/layer_statistics.h"

namespace lamella {

/// One material laid down on one layer by one tool; `change` and `reload` come before it.
struct PlanStep {
  MaterialId material;
  ToolId tool;
  bool is_change = false;  ///< the machine changes to this tool for it
  bool is_reload = false;  ///< an operator loads the tool with this material before the layer
  double time = 0.0;       ///< s, laying it down, without what comes before
  double change_time = 0.0;
  double volume = 0.0;  ///< mm^3
  double purge = 0.0;   ///< mm^3 of this material
  MaterialStatistics statistics;
};

struct PlanLayer {
  std::uint32_t index = 0;
  double z_bottom = 0.0;
  double z_top = 0.0;
  double time = 0.0;            ///< s, all of the layer
  std::vector<PlanStep> steps;  ///< in their order
};

/// A material over the whole build.
struct PlanMaterial {
  std::string name;
  Color color{0.5, 0.5, 0.5};
  std::vector<ToolId> tools;  ///< in the order of their first use; none when no layer holds the material
  std::optional<double> density;
  double volume = 0.0;         ///< mm^3
  double length = 0.0;         ///< mm of segments
  double time = 0.0;           ///< s while it is laid down
  double purge = 0.0;          ///< mm^3
  double unsupported = 0.0;    ///< mm^2, all layers
  std::optional<double> mass;  ///< g, without what is purged; absent when the density is unknown
  std::optional<double> cost;  ///< of the volume and the purge; absent when price or density is unknown
};

struct PlanSupport {
  std::string material;
  double volume = 0.0;  ///< mm^3 of the box that no material takes
  std::optional<double> cost;
};

/// What doesn't suit the machine, or is worth knowing.
struct PlanFinding {
  Severity severity = Severity::note;
  std::optional<std::uint32_t> layer;
  std::string material;  ///< may be empty
  std::string what;
  std::string hint;
};

/// How the tools were chosen where each material can stay in one for the whole build.
struct PlanMatching {
  std::uint64_t weighed =
      1;                  ///< matchings of materials to tools whose cost was found, alike tools standing for each other
  bool is_proved = true;  ///< that none costs less: changes first, then purge, then time
};

/// How a build is made on a machine (docs/methods/build-plan.md). Ids are those of the build and of the machine.
struct BuildPlan {
  std::string machine;
  Technology technology = Technology::extrusion;
  std::string currency;
  bool by_hatch = false;     ///< segments and lengths are those of the hatch rows
  double width = 0.0;        ///< mm, of a track
  Vec3 size = Vec3::Zero();  ///< mm on the machine, shrinkage made up for
  bool fits = true;          ///< within the build volume
  std::optional<Mat3> turn;  ///< how the assembly was turned to be built: p -> turn p, from the files' frame
  std::vector<std::string> tools;
  std::vector<PlanLayer> layers;
  std::vector<PlanMaterial> materials;
  std::uint64_t tool_changes = 0;
  std::uint64_t tool_changes_bound = 0;
  std::uint64_t reloads = 0;
  std::uint64_t reloads_bound = 0;
  std::optional<PlanMatching> matching;  ///< absent where tools are reloaded, and in plans before version 1.2
  double time = 0.0;                     ///< s
  double cost = 0.0;                     ///< of what has a price
  double change_time = 0.0;
  double reload_time = 0.0;
  double machine_cost = 0.0;
  double change_cost = 0.0;
  std::optional<PlanSupport> support;
  std::vector<PlanFinding> findings;

  [[nodiscard]] bool is_optimal() const { return tool_changes == tool_changes_bound && reloads == reloads_bound; }
};

/// Plans a build from the statistics of its layers. Throws InputError when the machine can't build these layers or
/// can't hold what they need.
[[nodiscard]] BuildPlan make_plan(const BuildInfo& info, const std::vector<LayerStatistics>& layers,
                                  const Machine& machine);

/// What the machine makes of the sizes in the build: volume, pitch, thin runs, specks, overhang.
[[nodiscard]] std::vector<PlanFinding> find_misfits(const BuildPlan& plan, const BuildInfo& info,
                                                    const Machine& machine);

/// plan.xml (schemas/plan.xsd, docs/formats/plan.md); the same plan gives the same bytes.
void write_plan_xml(const BuildPlan& plan, std::ostream& stream);

/// Larger plans aren't read: 1.6 million steps. What is read takes as much memory as the file, at most twice as much.
inline constexpr std::uint64_t kMaxPlanBytes = std::uint64_t{512} << 20;

/// Reads plan.xml, layer by layer. Throws InputError with file, line and hint.
[[nodiscard]] BuildPlan read_plan_xml(const std::filesystem::path& path);

}  // namespace lamella
