/// Areas of sections against OpenCASCADE's, run by hand: `compare_sections SECTIONS_PER_SOLID SECONDS [--list] FILE...`
/// prints a row of docs/accuracy.md for each file: closed solids, those that OpenCASCADE reads otherwise, sections,
/// those where its edges don't close, the median and the largest relative difference, the largest difference over the
/// border's length and the file's tolerance (mm). --list adds the sections that don't close or differ by more than a
/// millionth.

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

#include "tests/slicing/accuracy/compare_sections.h"

namespace {

using lamella::test::ComparedSection;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void print(const std::filesystem::path& file, const lamella::test::SectionComparison& found, bool with_list) {
  std::vector<double> relative;
  double offset = 0.0;
  std::size_t open = 0;
  for (const ComparedSection& section : found.sections) {
    if (!section.is_whole) {
      ++open;
      if (with_list)
        std::printf("  open: solid %zu z %.9g area %.9g occt %.9g\n", section.solid, section.z, section.area,
                    section.occt);
      continue;
    }
    if (section.area == 0.0 && section.occt == 0.0) continue;
    relative.push_back(section.difference() / std::max(std::abs(section.area), std::abs(section.occt)));
    if (section.length > 0.0) offset = std::max(offset, section.difference() / section.length);
    if (with_list && relative.back() > 1e-6) {
      std::printf("  solid %zu z %.9g area %.12g occt %.12g length %.6g\n", section.solid, section.z, section.area,
                  section.occt, section.length);
    }
  }
  std::printf("| `%s` | %zu | %zu | %zu | %zu | %.1e | %.1e | %.1e | %.1e |\n", file.stem().c_str(), found.solids,
              found.unmatched, found.sections.size(), open, median(relative),
              relative.empty() ? 0.0 : *std::max_element(relative.begin(), relative.end()), offset, found.tolerance);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: compare_sections SECTIONS_PER_SOLID SECONDS [--list] FILE...\n");
    return 1;
  }
  bool with_list = false;
  for (int i = 3; i < argc; ++i) {
    if (std::strcmp(argv[i], "--list") == 0) {
      with_list = true;
      continue;
    }
    try {
      print(argv[i], lamella::test::compare_sections(argv[i], std::atoi(argv[1]), std::atof(argv[2])), with_list);
    } catch (const std::exception& error) {
      std::printf("| `%s` | refused: %s |\n", argv[i], error.what());
    }
  }
  return 0;
}
