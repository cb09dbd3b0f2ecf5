// How far layers are from the solids of a STEP file, by OpenCASCADE: `measure_deviation FILE BORDERS [SAMPLES
// [SECONDS]]`, BORDERS a text file of heights in mm, ascending. Prints one line of JSON. bench/adaptive_run.py uses it.

#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/slicing/adaptive/occt_deviation.h"

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: measure_deviation FILE.step BORDERS.txt [SAMPLES [SECONDS]]\n");
    return 1;
  }
  std::vector<double> borders;
  std::ifstream stream(argv[2]);
  for (double z = 0.0; stream >> z;) borders.push_back(z);
  if (borders.size() < 2) {
    std::fprintf(stderr, "measure_deviation: fewer than two borders in %s\n", argv[2]);
    return 2;
  }
  lamella::test::MeasureOptions options;
  if (argc > 3) options.samples = std::strtoull(argv[3], nullptr, 10);
  if (argc > 4) options.seconds = std::strtod(argv[4], nullptr);
  const auto found = lamella::test::measure_deviation(argv[1], borders, options);
  std::printf(
      "{\"built\":%.9g,\"built_at\":[%.9g,%.9g,%.9g],\"built_samples\":%llu,\"surface\":%.9g,\"surface_at\":[%.9g,%.9g,"
      "%.9g],\"surface_samples\":%llu}\n",
      found.built, found.built_at.x(), found.built_at.y(), found.built_at.z(),
      static_cast<unsigned long long>(found.built_samples), found.surface, found.surface_at.x(), found.surface_at.y(),
      found.surface_at.z(), static_cast<unsigned long long>(found.surface_samples));
  return 0;
}
