#include "apps/adaptive_options.h"

#include <string>

#include "apps/options.h"
#include "core/error.h"

namespace lamella::apps {

void add_adaptive_options(CLI::App& verb) {
  add_value(verb, "--adaptive",
            "layers as thick as lets their extruded sections deviate by this much (auto: what --accuracy leaves)",
            "MM|auto");
  add_value(verb, "--adaptive-range", "least and largest thickness (default: the machine's, else by --adaptive)",
            "MIN,MAX");
  add_value(verb, "--adaptive-step", "thicknesses are multiples of it (default: the machine's, else by --adaptive)",
            "MM");
  add_value(verb, "--adaptive-chart", "also draw thickness and deviation over the height", "FILE.svg");
}

std::optional<AdaptiveOptions> read_adaptive_options(const CLI::App& verb) {
  const auto deviation = given(verb, "--adaptive");
  if (!deviation) {
    for (const char* option : {"--adaptive-range", "--adaptive-step", "--adaptive-chart"}) {
      if (given(verb, option)) {
        throw UsageError(std::string(option) + " needs --adaptive", {}, "give the largest deviation in mm");
      }
    }
    return std::nullopt;
  }
  if (given(verb, "--layer-height")) {
    throw UsageError("--adaptive and --layer-height exclude each other", {},
                     "give the least and the largest thickness with --adaptive-range");
  }
  AdaptiveOptions options;
  if (*deviation != "auto") {
    options.deviation = parse_positive("--adaptive", *deviation);
  } else if (!given(verb, "--accuracy")) {
    throw UsageError("--adaptive auto needs --accuracy", {}, "give the largest deviation in mm, or --accuracy too");
  }
  if (const auto range = given(verb, "--adaptive-range")) {
    const std::vector<double> ends = parse_numbers("--adaptive-range", *range, 2);
    options.range = Interval{ends[0], ends[1]};
  }
  if (const auto step = given(verb, "--adaptive-step")) options.step = parse_positive("--adaptive-step", *step);
  return options;
}

}  // namespace lamella::apps
