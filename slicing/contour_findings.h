#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "core/error.h"

namespace lamella {

/// What was found about contours, gathered over all layers.
class ContourFindings {
 public:
  /// Adds one of a layer; layers come in increasing z.
  void add(const Finding& finding);

  /// The first of each solid, face and severity with how many more there are; beyond a bound only their number.
  void report(std::vector<Finding>& findings) const;

 private:
  struct Group {
    Finding first;
    std::size_t more = 0;
  };
  std::map<std::tuple<std::string, std::string, Severity>, Group> groups_;  ///< by solid, entity and severity
};

}  // namespace lamella
