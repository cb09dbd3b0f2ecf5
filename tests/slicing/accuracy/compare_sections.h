#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace lamella::test {

/// One section by the span engine and by OpenCASCADE.
struct ComparedSection {
  std::size_t solid = 0;
  double z = 0.0;         ///< mm
  double area = 0.0;      ///< mm^2, direct slicing's
  double occt = 0.0;      ///< mm^2
  double length = 0.0;    ///< mm, of the border
  bool is_whole = false;  ///< OpenCASCADE's edges close

  [[nodiscard]] double difference() const;  ///< of the areas, mm^2
};

struct SectionComparison {
  std::size_t solids = 0;     ///< closed ones
  std::size_t unmatched = 0;  ///< those that OpenCASCADE reads otherwise
  double tolerance = 0.0;     ///< mm, the largest that the file states of its edges and vertices
  std::vector<ComparedSection> sections;
};

/// Sections of the closed solids of a file at random heights, `per_solid` of each, while there are seconds left.
[[nodiscard]] SectionComparison compare_sections(const std::filesystem::path& file, int per_solid, double seconds,
                                                 std::uint32_t seed = 1);

}  // namespace lamella::test
