#include <fmt/format.h>

#include "apps/options.h"
#include "apps/outputs.h"
#include "apps/plan_report.h"
#include "apps/verbs.h"
#include "export/output_file.h"
#include "export/plan_page.h"
#include "slicing/plan/build_plan.h"
#include "slicing/plan/statistics_sink.h"
#include "slicing/store/store.h"

namespace lamella::apps {

namespace {

struct PlanRequest {
  std::string build;
  std::string machine;
  std::filesystem::path output;
  std::optional<std::filesystem::path> page;
};

template <class Write>
void write_output(const std::filesystem::path& path, const Write& write) {
  OutputFile file(path);
  write(file.stream());
  file.commit();
}

std::vector<std::filesystem::path> places_of(const PlanRequest& request) {
  std::vector<std::filesystem::path> places{request.output};
  if (request.page) places.push_back(*request.page);
  return places;
}

void check_places(const PlanRequest& request) {
  refuse_inputs_as_outputs(places_of(request), {request.build, request.machine});
  for (const auto& place : places_of(request)) check_writable({"xml", place});
}

std::vector<Finding> as_findings(const BuildPlan& plan) {
  std::vector<Finding> findings;
  for (const PlanFinding& one : plan.findings) {
    Finding finding{one.severity, "", "", one.material, one.what, one.hint};
    if (one.layer) finding.entity += (finding.entity.empty() ? "layer " : ", layer ") + std::to_string(*one.layer);
    findings.push_back(std::move(finding));
  }
  return findings;
}

Json outputs_json(const PlanRequest& request) {
  Json list = Json::array();
  for (const auto& place : places_of(request)) {
    const bool is_page = request.page && place == *request.page;
    list.push_back({{"format", is_page ? "html" : "plan"}, {"path", place.string()}});
  }
  return list;
}

ExitCode run(const Session& session, const PlanRequest& request) {
  check_places(request);
  const Machine machine = read_machine(request.machine);
  const StoreReader reader(request.build);
  StatisticsSink statistics(machine);
  reader.replay(statistics, {}, session.progress());
  const BuildPlan plan = make_plan(statistics.info(), statistics.layers(), machine);
  session.progress().throw_if_cancelled();
  write_output(request.output, [&](std::ostream& stream) { write_plan_xml(plan, stream); });
  if (request.page) {
    write_output(*request.page, [&](std::ostream& stream) { write_plan_page(plan, statistics.info(), stream); });
  }
  session.warn(as_findings(plan));
  if (!reader.report().within_budget()) session.warn(reader.report().findings);
  if (session.json()) {
    Json object = plan_json(plan);
    object["outputs"] = outputs_json(request);
    session.print(object);
  }
  session.print(plan_text(plan) + "plan: " + request.output.string() + "\n");
  return plan.fits && reader.report().within_budget() ? ExitCode::ok : ExitCode::budget;
}

PlanRequest read_request(const CLI::App& verb, const std::string& build) {
  PlanRequest request{build, *given(verb, "--machine"), *given(verb, "--output"), std::nullopt};
  if (const auto page = given(verb, "--page")) request.page = *page;
  return request;
}

}  // namespace

void add_plan(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("plan", "tools, times, masses and costs of a build on a machine");
  auto build = std::make_shared<std::string>();
  verb->add_option("build", *build, "the folder that lamella slice wrote")->required()->type_name("BUILD");
  add_value(*verb, "--machine", "the machine (docs/formats/machine.md)", "X.xml")->required();
  add_value(*verb, "-o,--output", "the plan to write (docs/formats/plan.md)", "plan.xml")->required();
  add_value(*verb, "--page", "also a page to read, with charts", "plan.html");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella plan build --machine datasets/machines/multi_nozzle.xml -o plan.xml\n"
      "  lamella plan build --machine mine.xml -o plan.xml --page plan.html\n"
      "  lamella plan build --machine mine.xml -o plan.xml --json\n"
      "Exit code 2: the machine can't build these layers or hold what they need; 3: the part is larger than the build\n"
      "volume, or the slicing had exceeded its error budget.");
  verb->final_callback([verb, build, &action] {
    action = [request = read_request(*verb, *build)](const Session& session) { return run(session, request); };
  });
}

}  // namespace lamella::apps
