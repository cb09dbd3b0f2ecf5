/// The long comparison with OpenCASCADE, run by hand:
///   compare_with_occt RAYS_PER_SOLID [--seed N] [--seconds S] [--list] FILE...
/// prints one line a file: rays, agreement, disputes by kind and verdict, times; --list adds every disputed ray.
/// Its table is in docs/methods/reference-engine.md.

#include <cstdio>
#include <exception>
#include <string>

#include "tests/slicing/reference/occt_comparison.h"

namespace {

using namespace lamella;
using namespace lamella::test;

void list(const Dispute& dispute) {
  const Vec3& o = dispute.ray.origin;
  const Vec3& d = dispute.ray.direction;
  static constexpr const char* kVerdicts[] = {"engine right", "OCCT right", "on the boundary"};
  std::printf("  solid %u %s, %s, %.3g mm: %.17g %.17g %.17g %.17g %.17g %.17g\n    engine", dispute.solid.value(),
              kind_name(dispute.kind), kVerdicts[static_cast<int>(dispute.verdict)], dispute.length, o.x(), o.y(),
              o.z(), d.x(), d.y(), d.z());
  for (const Span& span : dispute.engine) std::printf(" [%.9g, %.9g]", span.begin, span.end);
  std::printf("\n    occt  ");
  for (const double t : dispute.occt) std::printf(" %.9g", t);
  std::printf("\n");
}

void print(const std::string& name, const OcctComparison& comparison, bool with_list) {
  std::printf("%s\trays %llu\tmet %llu\tagreed %llu\t(%.3f%%)", name.c_str(),
              static_cast<unsigned long long>(comparison.rays), static_cast<unsigned long long>(comparison.met),
              static_cast<unsigned long long>(comparison.agreed),
              comparison.rays == 0 ? 100.0 : 100.0 * comparison.agreed / comparison.rays);
  for (int kind = 0; kind < kKinds; ++kind) {
    for (const Verdict verdict : {Verdict::engine, Verdict::occt, Verdict::boundary}) {
      std::printf("%c%llu", verdict == Verdict::engine ? '\t' : '/',
                  static_cast<unsigned long long>(comparison.count(static_cast<Kind>(kind), verdict)));
    }
  }
  std::printf("\trep %llu\tengine %.2f s\tocct %.2f s\n",
              static_cast<unsigned long long>(comparison.counters.repaired_rays + comparison.counters.unclosed_rays),
              comparison.engine_seconds, comparison.occt_seconds);
  if (with_list) {
    for (const Dispute& dispute : comparison.disputes) list(dispute);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: compare_with_occt RAYS_PER_SOLID [--seed N] [--seconds S] [--list] FILE...\n");
    return 1;
  }
  std::printf("# disputes: odd, fewer, more, depth, each as engine right / OCCT right / on the boundary\n");
  std::uint32_t seed = 1;
  double seconds = 1e300;
  bool with_list = false;
  for (int k = 2; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument == "--list") {
      with_list = true;
    } else if (argument == "--seed" && k + 1 < argc) {
      seed = static_cast<std::uint32_t>(std::stoul(argv[++k]));
    } else if (argument == "--seconds" && k + 1 < argc) {
      seconds = std::stod(argv[++k]);
    } else {
      try {
        const auto comparison = compare_with_occt(argument, std::stoi(argv[1]), seed, 1e-6, seconds);
        print(std::filesystem::path(argument).filename(), comparison, with_list);
      } catch (const std::exception& error) {
        std::printf("%s\tfailed: %s\n", argument.c_str(), error.what());
      }
    }
  }
}
