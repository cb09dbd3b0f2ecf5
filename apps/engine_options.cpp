#include "apps/engine_options.h"

#include <array>
#include <utility>

#include "apps/options.h"
#include "core/error.h"

namespace lamella::apps {

namespace {

constexpr double kMaxLength = 1e3;  // mm; a tolerance or flatness beyond it is a slip

/// The value that an option's word stands for.
template <class Value, std::size_t N>
Value choose(const CLI::App& verb, const char* option, const std::array<std::pair<const char*, Value>, N>& words,
             Value fallback) {
  const auto text = given(verb, option);
  if (!text) return fallback;
  std::string known;
  for (const auto& [word, value] : words) {
    if (*text == word) return value;
    known += (known.empty() ? "" : ", ") + std::string(word);
  }
  throw UsageError("'" + *text + "' isn't known", option, "one of: " + known);
}

double read_length(const CLI::App& verb, const char* option, double fallback) {
  const auto text = given(verb, option);
  if (!text) return fallback;
  const double value = parse_positive(option, *text);
  if (value > kMaxLength) throw UsageError("'" + *text + "' is more than 1000 mm", option, "give mm, e.g. 0.01");
  return value;
}

}  // namespace

void add_engine_options(CLI::App& verb) {
  add_value(verb, "--engine", "reference (the default) or span", "ENGINE");
  add_value(verb, "--solver", "of the reference engine: certified (the default), bisection or newton", "SOLVER");
  add_value(verb, "--tolerance", "success criterion of bisection and newton (default 0.01)", "MM");
  add_value(verb, "--subdivision", "flatness at which refinement stops (default 0.1)", "MM");
}

ReferenceOptions read_engine_options(const CLI::App& verb) {
  constexpr std::array<std::pair<const char*, bool>, 2> kEngines{{{"reference", false}, {"span", true}}};
  if (choose(verb, "--engine", kEngines, false)) {
    throw UsageError("the span engine isn't there yet", "--engine", "use --engine reference, or leave it out");
  }
  constexpr std::array<std::pair<const char*, Solver>, 3> kSolvers{
      {{"certified", Solver::certified}, {"bisection", Solver::bisection}, {"newton", Solver::newton}}};
  ReferenceOptions options;
  options.solver = choose(verb, "--solver", kSolvers, options.solver);
  options.tolerance = read_length(verb, "--tolerance", options.tolerance);
  options.subdivision = read_length(verb, "--subdivision", options.subdivision);
  return options;
}

void add_overlap_option(CLI::App& verb) {
  add_value(verb, "--overlap",
            "who wins among equal priorities: priority (the smaller solid, the default), error, entry, exit, "
            "average",
            "POLICY");
}

OverlapPolicy read_overlap_policy(const CLI::App& verb) {
  constexpr std::array<std::pair<const char*, OverlapPolicy>, 5> kPolicies{{{"priority", OverlapPolicy::priority},
                                                                            {"error", OverlapPolicy::error},
                                                                            {"entry", OverlapPolicy::entry},
                                                                            {"exit", OverlapPolicy::exit},
                                                                            {"average", OverlapPolicy::average}}};
  return choose(verb, "--overlap", kPolicies, OverlapPolicy::priority);
}

}  // namespace lamella::apps
