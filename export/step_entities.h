#pragma once

#include <ostream>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lamella {

/// Number of an entity: #12.
using StepId = std::size_t;

/// Writes the data section of an exchange file of ISO 10303-21 as a stream, one entity a line, numbered from 1.
class StepEntities {
 public:
  explicit StepEntities(std::ostream& stream) : stream_(stream) {}

  /// Writes "#id=text;" and returns the id.
  StepId add(std::string_view text);

 private:
  std::ostream& stream_;
  StepId last_ = 0;
};

/// A string with its quotes; what isn't printable ASCII as \X2\ and \X4\, bytes that aren't UTF-8 as U+FFFD.
[[nodiscard]] std::string step_string(std::string_view text);

/// A real to 1e-6, with the decimal point that the format wants.
[[nodiscard]] std::string step_real(double value);

/// A real with all its digits.
[[nodiscard]] std::string step_exact_real(double value);

/// "#12"
[[nodiscard]] std::string step_reference(StepId id);

/// "(#12,#13)"
[[nodiscard]] std::string step_list(std::span<const StepId> ids);

}  // namespace lamella
