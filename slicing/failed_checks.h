#pragma once

#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "core/error.h"
#include "model/scene.h"
#include "slicing/slab.h"

namespace lamella {

/// What failed an engine's own checks, gathered over all layers.
class FailedChecks {
 public:
  /// Adds what was found on one layer; layers come in increasing z (mm).
  void add(const FailedCheck& failed, std::size_t layer, double z);

  /// Names check, solid, face and first layer, one finding each; beyond a bound only how many more there are.
  void report(const Scene& scene, std::vector<Finding>& findings) const;

 private:
  struct Sum {
    std::size_t first_layer = 0;
    double first_z = 0.0;
    std::size_t layers = 0;
    std::size_t last_layer = 0;
    std::uint64_t count = 0;
    double longest = 0.0;
  };
  std::map<std::tuple<SolidId, FaceId, Check>, Sum> sums_;
};

}  // namespace lamella
