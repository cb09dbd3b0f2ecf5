#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "apps/assembly.h"
#include "apps/engine_options.h"
#include "slicing/combine.h"
#include "slicing/reference/reference_engine.h"
#include "slicing/slab_engine.h"

namespace lamella::apps {

/// All that one ray met.
struct RayResult {
  std::vector<Hit> hits;    ///< of all solids, ascending
  std::vector<Span> spans;  ///< solid by solid
  std::vector<Segment> segments;
  CastCounters counters;
};

/// Casts rays at one assembly by the engine that was asked for, else by the span engine where it can (the ray is
/// horizontal and the solid closed) and by the reference engine where it can't.
class RayCaster {
 public:
  RayCaster(const Session& session, const Assembly& assembly, const EngineChoice& choice, OverlapPolicy policy);

  /// Prepares the engines that these rays need.
  void prepare(std::span<const Ray> rays);

  /// Casts a ray of those prepared for. May be called from several threads at once.
  [[nodiscard]] RayResult cast(const Ray& ray) const;

 private:
  [[nodiscard]] bool is_for_spans(const Ray& ray) const;
  void add_spans(const Ray& ray, RayResult& result) const;
  void add_cast(const SolidCast& cast, RayResult& result) const;

  const Session& session_;
  const Assembly& assembly_;
  EngineChoice choice_;
  MaterialTable table_;
  CombineRules rules_;
  std::vector<SolidId> closed_;
  std::vector<SolidId> open_;                           ///< not for the span engine
  std::optional<SlabEngine> span_engine_;               ///< of the closed solids
  std::unique_ptr<const ReferenceEngine> open_engine_;  ///< of the open ones
  std::unique_ptr<const ReferenceEngine> reference_;    ///< of all
};

}  // namespace lamella::apps
