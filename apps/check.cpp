#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

#include "apps/assembly.h"
#include "apps/job.h"
#include "apps/options.h"
#include "apps/slice_options.h"
#include "apps/table.h"
#include "apps/verbs.h"
#include "export/build_check.h"
#include "export/xml_slices.h"
#include "materials/machine.h"
#include "model/solid_status.h"
#include "model/step/read_step.h"
#include "slicing/plan/build_plan.h"
#include "slicing/store/build_file.h"
#include "slicing/store/store.h"

namespace lamella::apps {

namespace fs = std::filesystem;

namespace {

/// One thing that is wrong, or worth knowing.
struct CheckFinding {
  Severity severity = Severity::error;
  std::string where;
  std::string what;
  std::string hint;
};

using Findings = std::vector<CheckFinding>;

CheckFinding from_error(const Error& error) { return {Severity::error, error.where(), error.what(), error.hint()}; }

/// Looks through layers without keeping them.
class CheckingSink final : public LayerSink {
 public:
  void begin(const BuildInfo& info) override {
    check_build(info);
    info_ = info;
  }
  void write(const Layer& layer) override {
    check_layer(layer, info_);
    ++layers_;
    segments_ += layer.raster.segments.size();
  }
  void finish(const SliceReport& report) override {
    report_ = report;
    reported_layers_ = report.layers;
    reported_segments_ = report.segments;
    is_within_budget_ = report.within_budget();
  }

  /// What only all layers together show.
  [[nodiscard]] Findings judge(const std::string& where) const {
    Findings findings;
    const auto compare = [&](const char* what, std::uint64_t counted, std::uint64_t reported) {
      if (counted == reported) return;
      findings.push_back(
          {Severity::error, where,
           std::string(what) + ": " + std::to_string(counted) + " found, " + std::to_string(reported) + " reported",
           "slice again"});
    };
    compare("layers", layers_, reported_layers_);
    compare("raster segments", segments_, reported_segments_);
    if (!is_within_budget_) {
      findings.push_back({Severity::warning, where, "the slicing exceeded its error budget", "see the report in it"});
    }
    add_pairs(findings);
    return findings;
  }

 private:
  /// What the report says of how solids lie to one another, as notes.
  void add_pairs(Findings& findings) const {
    const auto note = [&](SolidId first, SolidId second, std::string what) {
      findings.push_back(
          {Severity::note, info_.solids[first].path + ", " + info_.solids[second].path, std::move(what), ""});
    };
    for (const PairReport& pair : report_.overlaps) {
      note(pair.first, pair.second,
           fmt::format("overlap of {} mm^3 on {} layers, up to {} mm deep", short_number(pair.volume), pair.layers,
                       short_number(pair.largest_depth)));
    }
    for (const PairReport& pair : report_.gaps) {
      note(pair.first, pair.second,
           fmt::format("gap of {} mm^3 on {} layers filled, up to {} mm wide", short_number(pair.volume), pair.layers,
                       short_number(pair.largest_depth)));
    }
    for (const ContactReport& contact : report_.interfaces) {
      note(contact.first, contact.second,
           fmt::format("interface of {} mm^2 over {} layers, gap up to {} mm", short_number(contact.area),
                       contact.layers, short_number(contact.largest_gap)));
    }
    for (const ContactReport& contact : report_.open_gaps) {
      note(contact.first, contact.second,
           fmt::format("open gap of {} mm^2 over {} layers, {} to {} mm wide", short_number(contact.area),
                       contact.layers, short_number(contact.least_gap), short_number(contact.largest_gap)));
    }
  }

  BuildInfo info_;
  SliceReport report_;
  std::uint64_t layers_ = 0;
  std::uint64_t segments_ = 0;
  std::uint64_t reported_layers_ = 0;
  std::uint64_t reported_segments_ = 0;
  bool is_within_budget_ = true;
};

/// Runs `read`, whose complaints become findings; what stops the program (cancel, usage) passes through.
Findings collect(const auto& read) {
  try {
    return read();
  } catch (const Cancelled&) {
    throw;
  } catch (const UsageError&) {
    throw;
  } catch (const Error& error) {
    return {from_error(error)};
  }
}

Findings check_stored_build(const Session& session, const fs::path& folder) {
  return collect([&] {
    const StoreReader reader(folder);
    CheckingSink sink;
    reader.replay(sink, {}, session.progress());
    reader.check_links();
    return sink.judge(folder.string());
  });
}

Findings check_slices(const Session& session, const fs::path& file) {
  return collect([&] {
    CheckingSink sink;
    read_xml_slices(file, sink, session.progress());
    return sink.judge(file.string());
  });
}

Findings check_materials(const fs::path& file) {
  return collect([&] {
    (void)read_material_rules(file);
    return Findings{};
  });
}

Findings check_job(const fs::path& file) {
  return collect([&] {
    CLI::App slice;
    CommonOptions common;
    add_slice_options(slice);
    add_common(slice, common);
    (void)read_job(file, slice);
    return Findings{};
  });
}

Findings check_machine(const fs::path& file) {
  return collect([&] {
    (void)read_machine(file);
    return Findings{};
  });
}

/// What the plan itself found counts as found here.
Findings check_plan(const fs::path& file) {
  return collect([&] {
    Findings findings;
    for (const PlanFinding& finding : read_plan_xml(file).findings) {
      std::string where = file.string();
      if (finding.layer) where += ", layer " + std::to_string(*finding.layer);
      if (!finding.material.empty()) where += ", " + finding.material;
      findings.push_back({finding.severity, where, finding.what, finding.hint});
    }
    return findings;
  });
}

std::string where_of(const Finding& finding) {
  std::string where;
  for (const std::string& part : {finding.solid, finding.face, finding.entity}) {
    if (!part.empty()) where += (where.empty() ? "" : ", ") + part;
  }
  return where;
}

/// The reader's findings, and every solid that can't be trusted. An unreadable file is an error of the run.
Findings check_step(const Session& session, const fs::path& file) {
  const std::vector<fs::path> files{file};
  const Scene scene = read_step(files, {}, session.progress());
  Findings findings;
  for (const Finding& finding : scene.findings) {
    findings.push_back({finding.severity, where_of(finding), finding.what, finding.hint});
  }
  for (const Solid& solid : scene.solids) {
    const std::string status = status_word(solid.info);
    const std::string entity = solid.info.step_entity > 0 ? ", #" + std::to_string(solid.info.step_entity) : "";
    for (const std::string& healed : solid.info.healed) {
      findings.push_back({Severity::note, solid.info.path + entity, "healed: " + healed, ""});
    }
    if (status == "ok") continue;
    findings.push_back(
        {Severity::error, solid.info.path + entity, "the solid is " + status, "repair it in the CAD system"});
  }
  return findings;
}

/// The beginning of a file. Throws InputError when it can't be read.
std::string read_head(const fs::path& file) {
  std::error_code failure;
  // To open a pipe is to wait for who writes into it.
  if (fs::exists(file, failure) && !fs::is_regular_file(file, failure)) {
    throw InputError("not a regular file", file.string(), "check a build folder or a file");
  }
  std::ifstream stream(file, std::ios::binary);
  std::string head(1 << 16, '\0');
  stream.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (!stream.is_open() || stream.bad()) throw InputError("can't read the file", file.string(), "does it exist?");
  head.resize(static_cast<std::size_t>(stream.gcount()));
  return head;
}

/// The name of the root element, empty when the text isn't XML that starts with one.
std::string root_name(std::string_view head) {
  if (head.starts_with("\xEF\xBB\xBF")) head.remove_prefix(3);
  for (;;) {
    head.remove_prefix(std::min(head.find_first_not_of(" \t\r\n"), head.size()));
    const std::string_view end = head.starts_with("<?") ? "?>" : head.starts_with("<!--") ? "-->" : "";
    if (end.empty()) break;
    const std::size_t found = head.find(end);
    if (found == std::string_view::npos) return {};
    head.remove_prefix(found + end.size());
  }
  if (!head.starts_with('<')) return {};
  head.remove_prefix(1);
  return std::string(head.substr(0, head.find_first_of(" \t\r\n/>")));
}

Findings check_file(const Session& session, const fs::path& file) {
  const std::string head = read_head(file);
  const std::string root = root_name(head);
  if (root == "materials") return check_materials(file);
  if (root == "job") return check_job(file);
  if (root == "machine") return check_machine(file);
  if (root == "plan") return check_plan(file);
  if (root == "slices") return check_slices(session, file);
  if (root == "build") return check_stored_build(session, fs::absolute(file).parent_path());
  if (root == "!DOCTYPE") {
    return {{Severity::error, file.string(), "a document type declaration, which is refused", "remove <!DOCTYPE ...>"}};
  }
  if (!root.empty()) {
    throw InputError("XML of another kind: <" + root + ">", file.string(),
                     "materials, job, machine, plan, slices and build files can be checked");
  }
  if (head.find("ISO-10303-21") != std::string::npos) return check_step(session, file);
  throw InputError("neither a STEP file nor an XML file of ours", file.string(),
                   "check a build folder, a STEP file, or a materials, job, machine, plan, slices or build file");
}

Findings check_path(const Session& session, const fs::path& path) {
  std::error_code failure;
  if (!fs::exists(path, failure)) throw InputError("no such file or folder", path.string());
  if (!fs::is_directory(path, failure)) return check_file(session, path);
  if (fs::exists(path / kBuildName, failure)) return check_stored_build(session, path);
  throw InputError(fs::exists(path / kUnfinishedName, failure) ? "an unfinished build" : "not a build: no build.xml",
                   path.string(), "lamella slice writes builds; slice again if it was stopped");
}

ExitCode run(const Session& session, const std::string& path) {
  const Findings findings = check_path(session, path);
  const bool ok = std::none_of(findings.begin(), findings.end(),
                               [](const CheckFinding& finding) { return finding.severity == Severity::error; });
  Json list = Json::array();
  for (const CheckFinding& finding : findings) {
    list.push_back({{"severity", word_of(finding.severity)},
                    {"where", finding.where},
                    {"what", finding.what},
                    {"hint", finding.hint}});
    session.print(
        printable(std::string(word_of(finding.severity)) + ": " + one_line(finding.what, finding.where, finding.hint)) +
        "\n");
  }
  if (session.json()) session.print(Json{{"ok", ok}, {"findings", list}});
  session.print(path + (ok ? ": ok\n" : ": not ok\n"));
  return ok ? ExitCode::ok : ExitCode::budget;
}

}  // namespace

void add_check(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("check", "what is wrong where: a build, our XML files, a STEP file");
  auto path = std::make_shared<std::string>();
  verb->add_option("path", *path,
                   "a build folder, a materials, job, machine, plan, slices or build file, or a STEP file")
      ->required()
      ->type_name("PATH");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella check build\n"
      "  lamella check materials.xml\n"
      "  lamella check grip.step --json\n"
      "Exit code 0: no error found, 2: unreadable, 3: errors found.");
  verb->final_callback(
      [path, &action] { action = [path = *path](const Session& session) { return run(session, path); }; });
}

}  // namespace lamella::apps
