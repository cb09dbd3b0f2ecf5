// The span engine against the certified reference engine on random rows, run by hand:
//   oracle_study [--rays N] [--seed N] [FILE...]
// At least N solid-rays in all (100 000 unless told), over all files of the corpus, the benchmark and the data sets
// unless some are named. Prints the table of docs/methods/span-engine-oracle.md; examples of differences go to stderr.

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "tests/slicing/span/oracle_comparison.h"
#include "tests/support/step_scenes.h"

using namespace lamella;

namespace {

void print_row(const std::string& name, const test::OracleTally& tally) {
  std::printf("| %s | %zu | %zu | %zu | %zu | %zu | %.1e |\n", name.c_str(), tally.solid_rays, tally.agree,
              tally.in_zone, tally.grazing, tally.differ, tally.worst);
  std::fflush(stdout);
}

test::OracleTally study(const std::filesystem::path& file, std::size_t rays, std::uint64_t seed) {
  const Scene scene = test::read_scene(file);
  test::OracleOptions options;
  options.solids = 24;
  options.layers = 8;
  options.rows = 8;
  test::OracleTally tally;
  for (std::uint64_t round = 0; tally.solid_rays < rays && round < 64; ++round) {
    options.seed = seed + round;
    const test::OracleTally part = test::compare_with_oracle(scene, options);
    tally += part;
    if (part.solid_rays == 0) break;
  }
  for (const std::string& example : tally.examples) {
    std::fprintf(stderr, "%s: %s\n", file.filename().c_str(), example.c_str());
  }
  if (tally.unclosed > 0) {
    std::fprintf(stderr, "%s: %zu unclosed\n", file.filename().c_str(), static_cast<std::size_t>(tally.unclosed));
  }
  return tally;
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t rays = 100'000;
  std::uint64_t seed = 1;
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--rays" && i + 1 < argc) {
      rays = std::stoul(argv[++i]);
    } else if (word == "--seed" && i + 1 < argc) {
      seed = std::stoul(argv[++i]);
    } else {
      files.emplace_back(word);
    }
  }
  if (files.empty()) {
    for (const auto& group : {test::dataset_files(), test::bench_files(), test::sound_corpus_files()}) {
      files.insert(files.end(), group.begin(), group.end());
    }
  }
  std::printf("| file | solid-rays | agree | in zone | grazing | differ | worst x error times abs(n.d), mm |\n");
  std::printf("|---|---:|---:|---:|---:|---:|---:|\n");
  test::OracleTally total;
  for (const std::filesystem::path& file : files) {
    try {
      const test::OracleTally tally = study(file, (rays + files.size() - 1) / files.size(), seed);
      print_row(file.stem().string(), tally);
      total += tally;
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), error.what());
    }
  }
  print_row("all", total);
  return total.differ == 0 ? 0 : 1;
}
