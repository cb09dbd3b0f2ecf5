#pragma once

#include <string>

namespace lamella::step {

/// "#123", or empty when the entity is unknown.
[[nodiscard]] inline std::string label_of(int number) {
  std::string label;
  if (number > 0) (label += '#') += std::to_string(number);
  return label;
}

}  // namespace lamella::step
