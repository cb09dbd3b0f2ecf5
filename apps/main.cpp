#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <new>
#include <string_view>

#include "apps/session.h"
#include "apps/signals.h"
#include "apps/verbs.h"

namespace lamella::apps {

namespace {

/// What went wrong, as one of our errors, so that every failure has a code and one line.
Error as_error(const std::exception_ptr& exception) {
  try {
    std::rethrow_exception(exception);
  } catch (const Error& error) {
    return error;
  } catch (const CLI::ParseError& error) {
    return UsageError(error.what(), {}, "see lamella --help, or lamella VERB --help");
  } catch (const std::bad_alloc&) {
    return Error(ExitCode::input, "not enough memory", {}, "choose a coarser lattice, or fewer outputs at once");
  } catch (const std::exception& error) {
    return Error(ExitCode::input, std::string("unexpected: ") + error.what(), {}, "please report this with the input");
  }
}

/// A word in the verb's place that is no verb: CLI11 would only say that one is missing.
void refuse_unknown_verb(const CLI::App& program, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return;
  std::string known;
  for (const CLI::App* verb : program.get_subcommands([](const CLI::App*) { return true; })) {
    if (verb->get_name() == argv[1]) return;
    known += (known.empty() ? "" : ", ") + verb->get_name();
  }
  throw UsageError("unknown verb '" + std::string(argv[1]) + "'", {}, "one of: " + known);
}

/// Reads the command line. Returns true when only help or the version was asked for, which has been printed then.
bool parse(CLI::App& program, int argc, char** argv) {
  try {
    program.parse(argc, argv);
    return false;
  } catch (const CLI::Success& help) {
    program.exit(help);
    return true;
  }
}

ExitCode run(int argc, char** argv, Terminal& terminal, CommonOptions& common) {
  Action action;
  CLI::App program("Slices assemblies of STEP solids directly, each solid of its material.", "lamella");
  program.set_version_flag("--version", std::string("lamella ") + LAMELLA_VERSION);
  program.require_subcommand(1);
  add_info(program, common, action);
  add_slice(program, common, action);
  add_orient(program, common, action);
  add_ray(program, common, action);
  add_export(program, common, action);
  add_plan(program, common, action);
  add_view(program, common, action);
  add_accuracy(program, common, action);
  add_check(program, common, action);
  program.footer(
      "Examples:\n"
      "  lamella info grip.step\n"
      "  lamella slice grip.step -o build --layer-height 0.1 --pitch 0.05 --png images\n"
      "  lamella export build --to vdb -o grip.vdb\n"
      "lamella VERB --help tells more.");
  refuse_unknown_verb(program, argc, argv);
  if (parse(program, argc, argv)) return ExitCode::ok;
  return action(Session(common, terminal));
}

/// Whether --json was given, even where the command line can't be understood.
bool wants_json(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--json") return true;
  }
  return false;
}

int run_to_the_end(int argc, char** argv) {
  Terminal terminal;
  CommonOptions common;
  common.arguments.assign(argv + std::min(argc, 1), argv + argc);
  ExitCode code = ExitCode::ok;
  try {
    code = run(argc, argv, terminal, common);
  } catch (...) {
    const Error error = as_error(std::current_exception());
    terminal.error(error);
    if (wants_json(argc, argv)) terminal.write(dump(Json{{"error", json_of(error)}}) + "\n");
    code = error.code();
  }
  if (terminal.flush()) return static_cast<int>(code);
  terminal.error(ExportError("can't write to stdout", {}, "is the disk full?"));
  return static_cast<int>(std::max(code, ExitCode::output));
}

}  // namespace

}  // namespace lamella::apps

int main(int argc, char** argv) {
  lamella::apps::watch_signals();
  return lamella::apps::run_to_the_end(argc, argv);
}
