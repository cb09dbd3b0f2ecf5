#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/assembly.h"
#include "apps/slice_options.h"

namespace lamella::apps {

/// What a run will probably take, from slicing a few of its layers into a temporary folder.
struct Estimate {
  struct Bytes {
    Output output;
    double bytes = 0.0;
  };
  std::size_t sampled_layers = 0;
  double seconds = 0.0;       ///< of slicing and writing, reading and preparing not included
  double memory_bytes = 0.0;  ///< largest resident memory
  std::vector<Bytes> outputs;
};

/// Slices evenly spread blocks of layers with `engine`, writes every output of the request beside them, and scales up.
/// Leaves nothing behind.
[[nodiscard]] Estimate estimate_run(const Session& session, const SliceRequest& request, const Assembly& assembly,
                                    const LayerPlan& plan, const SlabEngine& engine);

[[nodiscard]] Json estimate_json(const Estimate& estimate, const LayerPlan& plan);
[[nodiscard]] std::string estimate_text(const Estimate& estimate);

}  // namespace lamella::apps
