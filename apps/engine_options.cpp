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

void add_engine_options(CLI::App& verb, const std::string& fallback) {
  add_value(verb, "--engine", "span or reference (default: " + fallback + ")", "ENGINE");
  add_value(verb, "--solver", "of the reference engine: certified (the default), bisection or newton", "SOLVER");
  add_value(verb, "--tolerance", "success criterion of bisection and newton (default 0.01)", "MM");
  add_value(verb, "--subdivision", "flatness at which refinement stops (default 0.1)", "MM");
}

EngineChoice read_engine_options(const CLI::App& verb) {
  EngineChoice choice;
  constexpr std::array<std::pair<const char*, EngineKind>, 2> kEngines{
      {{"span", EngineKind::span}, {"reference", EngineKind::reference}}};
  if (given(verb, "--engine")) choice.engine = choose(verb, "--engine", kEngines, EngineKind::span);
  constexpr std::array<std::pair<const char*, Solver>, 3> kSolvers{
      {{"certified", Solver::certified}, {"bisection", Solver::bisection}, {"newton", Solver::newton}}};
  choice.reference.solver = choose(verb, "--solver", kSolvers, choice.reference.solver);
  choice.reference.tolerance = read_length(verb, "--tolerance", choice.reference.tolerance);
  choice.reference.subdivision = read_length(verb, "--subdivision", choice.reference.subdivision);
  if (choice.engine == EngineKind::reference) return choice;
  for (const char* option : {"--solver", "--tolerance", "--subdivision"}) {
    if (!given(verb, option)) continue;
    throw UsageError(std::string(option) + " is of the reference engine", option, "add --engine reference");
  }
  return choice;
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
