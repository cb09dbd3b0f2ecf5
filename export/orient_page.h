#pragma once

#include <ostream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slicing/orient/orientations.h"

namespace lamella {

/// All that the page of `lamella orient` tells.
struct OrientPage {
  std::string source;                                   ///< the files
  std::vector<std::pair<std::string, double>> weights;  ///< by their names
  double layer_height = 0.0;                            ///< mm
  double present_height = 0.0;                          ///< mm
  std::string machine;                                  ///< empty: none
  std::vector<Color> colors;                            ///< one a sample of the judge
};

/// A page to read, with nothing to load: the least height with its proof, a picture, figures and bars of each
/// candidate.
void write_orient_page(const Orientations& found, const LeastWidth& least, const OrientationJudge& judge,
                       const OrientPage& page, std::ostream& out);

}  // namespace lamella
