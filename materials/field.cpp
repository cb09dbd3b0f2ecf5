#include "materials/field.h"

#include <algorithm>
#include <cmath>

#include "core/xml.h"

namespace lamella {

std::string attribute_text(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + xml_escape(value) + "\"";
}

double repair_fractions(std::span<double> fractions) {
  double change = 0.0;
  double sum = 0.0;
  for (double& fraction : fractions) {
    // Written so that NaN is put right too.
    if (!(fraction >= 0.0) || !std::isfinite(fraction)) {
      change = std::isfinite(fraction) ? std::max(change, -fraction) : 1.0;
      fraction = 0.0;
    }
    sum += fraction;
  }
  if (!(sum > 0.0) || !std::isfinite(sum)) {
    std::fill(fractions.begin(), fractions.end(), 0.0);
    fractions[0] = 1.0;
    return 1.0;
  }
  if (sum != 1.0) {
    for (double& fraction : fractions) fraction /= sum;
  }
  return std::max(change, std::abs(sum - 1.0));
}

}  // namespace lamella
