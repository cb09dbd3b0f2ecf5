#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "model/scene.h"
#include "model/step/import_report.h"
#include "model/step/raw_topology.h"

/// Private to model/step: brings what the file states and what the import says to the solids it concerns.
namespace lamella::step {

/// Findings on the solids of one file, from the solid `first` of the scene to its last.
class SolidReport {
 public:
  SolidReport(Scene& scene, SolidId first, const RawTopology& topology);

  /// Repairs go to SolidInfo::healed and, as notes, to the findings; failures are errors. Each text once per solid,
  /// with its number and the first entity.
  void add_remarks(const std::vector<ImportRemark>& remarks);
  /// Entities of solids that could not be read.
  void add_refused(const std::vector<RefusedEntity>& refused);
  /// Faces that the file states and the scene lacks; their solids become invalid.
  void add_lost_faces();
  /// Faults that the import left in the shape of these solids; they become invalid.
  void add_shape_faults(SolidId solid, const std::vector<ShapeFault>& faults);
  /// Bodies that the file states as one solid; no finding for a single one.
  void add_split(const std::vector<SolidId>& bodies);
  /// Edges that close only within a tolerance beyond what counts as accurate.
  void add_wide_tolerances();

 private:
  /// Equal texts on one solid.
  struct Group {
    int count = 0;
    int first = 0;  ///< entity
  };
  using Groups = std::map<std::pair<int, std::string>, Group>;  ///< by the solid's entity and the text

  void collect(Groups& groups, int entity, const std::string& text) const;
  [[nodiscard]] std::vector<SolidId> solids_of(int solid_entity) const;
  [[nodiscard]] int solid_entity_of(int entity) const;
  void add(Severity severity, const std::vector<SolidId>& solids, int face, int entity, const std::string& what,
           const std::string& hint);
  void worsen(const std::vector<SolidId>& solids, SolidStatus status);

  Scene& scene_;
  SolidId first_;
  const RawTopology& topology_;
  std::map<int, std::vector<SolidId>> solids_;
};

/// Faults of a file's own text, kept until the topology of the scene is known.
struct PendingFaults {
  SolidId first;  ///< solids of the file
  SolidId end;
  std::vector<RawFault> faults;
};

/// Reports them: where the scene's solid is closed all the same, the import has healed the fault, else it is an error.
void settle_raw_faults(Scene& scene, const PendingFaults& pending);

}  // namespace lamella::step
