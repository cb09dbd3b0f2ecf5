#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include "core/error.h"
#include "materials/material_table.h"

/// The words that build.xml has for enumerations, in the order of their values.
namespace lamella {

inline constexpr std::array<std::string_view, 5> kPolicyWords{"priority", "error", "entry", "exit", "average"};
/// Of build.xml; a build without graded materials is what it was before there were any.
inline constexpr std::string_view kPlainVersion = "1";
inline constexpr std::string_view kGradedVersion = "1.1";
inline constexpr std::string_view kContourVersion = "1.2";  ///< with contours, graded or not
inline constexpr std::string_view kTurnedVersion = "1.3";   ///< turned before it was sliced
inline constexpr std::string_view kCurvesVersion = "1.4";   ///< with the curves of contours, turned or not

/// Numbers of graded segments, knots and fractions of a layer's lattices.
inline constexpr std::array<const char*, 3> kMixtureNames{"graded_segments", "knots", "fractions"};
inline constexpr std::array<const char*, 3> kHatchMixtureNames{"hatch_graded_segments", "hatch_knots",
                                                               "hatch_fractions"};

inline constexpr std::array<std::string_view, 3> kSeverityWords{"note", "warning", "error"};

[[nodiscard]] inline std::string_view name_of(OverlapPolicy policy) {
  return kPolicyWords[static_cast<std::size_t>(policy)];
}
[[nodiscard]] inline std::string_view name_of(Severity severity) {
  return kSeverityWords[static_cast<std::size_t>(severity)];
}

/// The value whose word is `word`, if there is one.
template <class Enum, std::size_t N>
[[nodiscard]] std::optional<Enum> value_named(std::string_view word, const std::array<std::string_view, N>& words) {
  for (std::size_t i = 0; i < N; ++i) {
    if (words[i] == word) return static_cast<Enum>(i);
  }
  return std::nullopt;
}

}  // namespace lamella
