#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "apps/layer_range.h"
#include "apps/options.h"
#include "apps/outputs.h"
#include "apps/table.h"
#include "apps/verbs.h"
#include "export/view_page.h"

namespace lamella::apps {

namespace {

struct ViewOptions {
  std::string build;
  std::filesystem::path page;
  LayerRange layers;
  ViewPageOptions page_options;
};

/// Says at once what the page would say after a long time. Exact for whole builds only: of a range of layers nobody
/// knows the segments before they are read.
void refuse_what_is_too_large(const StoreReader& reader, const ViewOptions& options) {
  const LayerPlan& plan = reader.info().plan;
  const bool is_whole = options.layers.first == 0 && options.layers.last >= plan.layers.size();
  if (!is_whole || options.page_options.every > 1) return;
  const double segments = static_cast<double>(reader.report().segments) / kMostViewSegments;
  const double rows = static_cast<double>(reader.report().rows) / kMostViewRows;
  const double share = std::max(segments, rows);
  if (share <= 1.0) return;
  throw UsageError(fmt::format("a page of {} segments is too much for a browser", reader.report().segments),
                   options.build,
                   fmt::format("take fewer layers with --every {} or --layers A:B", std::lround(std::ceil(share))));
}

ExitCode run(const Session& session, const ViewOptions& options) {
  refuse_inputs_as_outputs({options.page}, {options.build});
  check_writable({"xml", options.page});  // any format of one file
  const StoreReader reader(options.build);
  const LayerRange range = clip(options.layers, reader.info().plan.layers.size());
  refuse_what_is_too_large(reader, options);
  const auto sink = make_view_sink(options.page, options.page_options);
  reader.replay(*sink, range, session.progress());

  const std::vector<WrittenFile> files = list_files(options.page);
  if (session.json()) session.print(files_json("html", files));
  session.print(fmt::format("html: {} layers, {} in {}\n",
                            (range.last - range.first + options.page_options.every - 1) / options.page_options.every,
                            short_bytes(total_bytes(files)), options.page.string()));
  if (!reader.report().within_budget()) session.warn(reader.report().findings);
  return reader.report().within_budget() ? ExitCode::ok : ExitCode::budget;
}

ViewOptions read_options(const CLI::App& verb, const std::string& build) {
  constexpr long kMostEvery = 1'000'000;
  ViewOptions options;
  options.build = build;
  options.page = *given(verb, "--output");
  if (const auto layers = given(verb, "--layers")) options.layers = parse_layers(*layers);
  if (const auto every = given(verb, "--every")) {
    options.page_options.every = static_cast<std::uint32_t>(parse_whole("--every", *every, 1, kMostEvery));
  }
  options.page_options.hatches = verb.count("--hatches") > 0;
  return options;
}

}  // namespace

void add_view(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("view", "a page to look through layers and voxels");
  auto build = std::make_shared<std::string>();
  verb->add_option("build", *build, "the folder that lamella slice wrote")->required()->type_name("BUILD");
  add_value(*verb, "-o,--output", "the page to write; it needs no other file and no network", "view.html")->required();
  add_value(*verb, "--layers", "only layers A to B - 1, from 0; either may be missing", "A:B");
  add_value(*verb, "--every", "only every Nth layer, for builds that are too large for a browser", "N");
  add_switch(*verb, "--hatches", "also the hatch rows, to be shown as lines");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella view build -o view.html\n"
      "  lamella view build -o bottom.html --layers 0:200\n"
      "  lamella view tray -o tray.html --every 10 --json\n"
      "Exit code 3 repeats that the slicing itself exceeded its error budget.");
  verb->final_callback([verb, build, &action] {
    action = [options = read_options(*verb, *build)](const Session& session) { return run(session, options); };
  });
}

}  // namespace lamella::apps
