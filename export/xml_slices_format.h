#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/error.h"
#include "materials/material_table.h"

/// What the writer and the reader of schemas/slices.xsd share.
namespace lamella::slices_xml {

inline constexpr std::string_view kNamespace = "urn:lamella:slices:1";
inline constexpr std::string_view kVersion = "1.0";
inline constexpr std::string_view kGradedVersion = "1.1";  ///< of builds with graded materials
inline constexpr std::string_view kTurnedVersion = "1.2";  ///< turned before they were sliced, graded or not

/// Bounds on what one layer may ask a reader to hold: 8 MiB of offsets, 800 MiB of segments.
inline constexpr std::int64_t kMaxRows = std::int64_t{1} << 20;
inline constexpr std::int64_t kMaxSegments = std::int64_t{1} << 25;

/// The same for graded segments: 256 MiB of knots, 512 MiB of fractions.
inline constexpr std::int64_t kMaxKnots = std::int64_t{1} << 25;
inline constexpr std::int64_t kMaxFractions = std::int64_t{1} << 27;

/// Segments in one <row> of the text form; a longer row goes on in a second element of the same index.
inline constexpr std::size_t kMaxRowPart = std::size_t{1} << 16;

inline constexpr std::array<std::string_view, 5> kPolicies = {"priority", "error", "entry", "exit", "average"};
inline constexpr std::array<std::string_view, 3> kSeverities = {"note", "warning", "error"};

static_assert(static_cast<std::size_t>(OverlapPolicy::average) + 1 == kPolicies.size());
static_assert(static_cast<std::size_t>(Severity::error) + 1 == kSeverities.size());

}  // namespace lamella::slices_xml
