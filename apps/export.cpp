#include <fmt/format.h>

#include "apps/layer_range.h"
#include "apps/options.h"
#include "apps/outputs.h"
#include "apps/table.h"
#include "apps/verbs.h"
#include "slicing/store/store.h"

namespace lamella::apps {

namespace {

struct ExportOptions {
  std::string build;
  Output output;
  FormatOptions format;
  LayerRange layers;
};

ExitCode run(const Session& session, const ExportOptions& options) {
  std::vector<std::string> inputs{options.build};
  if (options.format.plan) inputs.push_back(*options.format.plan);
  if (options.format.machine) inputs.push_back(*options.format.machine);
  refuse_inputs_as_outputs(places_of(options.output, options.format), inputs);
  check_writable(options.output);
  const StoreReader reader(options.build);
  const LayerRange range = clip(options.layers, reader.info().plan.layers.size());
  const auto sink = make_sink(options.output, options.format);
  reader.replay(*sink, range, session.progress());

  const std::vector<WrittenFile> files = list_files(options.output.path);
  if (session.json()) session.print(files_json(options.output.format, files));
  session.print(fmt::format("{}: {} layers, {} files, {} in {}\n", options.output.format, range.last - range.first,
                            files.size(), short_bytes(total_bytes(files)), options.output.path.string()));
  if (options.output.format == "gcode" && range.first > 0) {
    session.warn(
        {Finding{Severity::warning, "", "", "", "the file begins in the air, at layer " + std::to_string(range.first),
                 "print it on top of the layers below, or export them too"}});
  }
  if (!reader.report().within_budget()) session.warn(reader.report().findings);
  return reader.report().within_budget() ? ExitCode::ok : ExitCode::budget;
}

ExportOptions read_options(const CLI::App& verb, const std::string& build) {
  ExportOptions options;
  options.build = build;
  options.output = {*given(verb, "--to"), *given(verb, "--output")};
  check_format(options.output.format);
  if (given(verb, "--coverage-rows")) {
    throw UsageError("a build keeps no lines but those in the middle of pixels", "--coverage-rows",
                     "slice with --png-coverage");
  }
  options.format = read_format_options(verb);
  check_format_options(verb, options.format, {options.output});
  if (const auto layers = given(verb, "--layers")) options.layers = parse_layers(*layers);
  return options;
}

}  // namespace

void add_export(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("export", "any format from a build");
  auto build = std::make_shared<std::string>();
  verb->add_option("build", *build, "the folder that lamella slice wrote")->required()->type_name("BUILD");
  add_value(*verb, "--to", "one of the formats below", "FORMAT")->required();
  add_value(*verb, "-o,--output", "the file or folder to write", "OUT")->required();
  add_value(*verb, "--layers", "only layers A to B - 1, from 0; either may be missing", "A:B");
  add_format_options(*verb);
  add_value(*verb, "--machine", "the machine that the plan is for, for G-code", "X.xml");
  add_common(*verb, common);
  std::string formats = "Formats:\n";
  for (const Format& format : available_formats()) {
    formats += fmt::format("  {:<12} {}{}\n", format.name, format.summary, format.is_folder ? " (a folder)" : "");
  }
  verb->footer(formats +
               "Examples:\n"
               "  lamella export build --to png -o images\n"
               "  lamella export build --to vdb -o grip.vdb\n"
               "  lamella export build --to xml -o grip.xml --xml-payload text --layers 10:20\n"
               "  lamella export build --to gcode --plan plan.xml --machine mine.xml -o grip.gcode\n"
               "Exit code 3 repeats that the slicing itself exceeded its error budget.");
  verb->final_callback([verb, build, &action] {
    const ExportOptions options = read_options(*verb, *build);
    action = [options](const Session& session) { return run(session, options); };
  });
}

}  // namespace lamella::apps
