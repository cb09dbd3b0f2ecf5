#include <fmt/format.h>
#include <set>

#include "apps/accuracy_report.h"
#include "apps/assembly.h"
#include "apps/options.h"
#include "apps/outputs.h"
#include "apps/verbs.h"
#include "core/tolerances.h"
#include "export/accuracy_page.h"
#include "export/output_file.h"
#include "slicing/accuracy/accuracy_study.h"
#include "slicing/slicer.h"

namespace lamella::apps {

namespace {

constexpr std::size_t kMaxLevels = 50;
constexpr double kSmallestLength = 1e-7;  ///< mm; STL files don't hold a hundredth of it
constexpr double kLargestLength = 1e6;    ///< mm

struct AccuracyRequest {
  std::vector<std::string> files;
  accuracy::StudyOptions study;
  std::optional<std::filesystem::path> page;
  std::optional<std::filesystem::path> csv;
};

/// Positive lengths with commas between.
std::vector<double> parse_lengths(const char* option, const std::string& text) {
  std::vector<double> lengths;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    lengths.push_back(parse_positive(option, rest.substr(0, comma)));
    if (!(lengths.back() >= kSmallestLength && lengths.back() <= kLargestLength)) {
      throw UsageError("'" + std::string(rest.substr(0, comma)) + "' is out of range", option,
                       "give 1e-7 to 1e6, in mm");
    }
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (lengths.size() <= kMaxLevels) return lengths;
  throw UsageError("more than " + std::to_string(kMaxLevels) + " lengths", option, "give fewer");
}

std::vector<std::filesystem::path> places_of(const AccuracyRequest& request) {
  std::vector<std::filesystem::path> places;
  if (request.page) places.push_back(*request.page);
  if (request.csv) places.push_back(*request.csv);
  return places;
}

void check_places(const AccuracyRequest& request) {
  std::vector<std::filesystem::path> all = places_of(request);
  for (const auto& place : all) check_writable({"xml", place});
  if (request.study.stl) {
    check_writable({"png", *request.study.stl});
    all.push_back(*request.study.stl);
  }
  refuse_inputs_as_outputs(all, request.files);
}

template <class Write>
void write_output(const std::filesystem::path& path, const Write& write) {
  OutputFile file(path);
  write(file.stream());
  file.commit();
}

/// Names the solids that aren't studied.
std::vector<Finding> left_out(const Scene& scene, const accuracy::StudyResult& result) {
  const std::set<SolidId> studied(result.solids.begin(), result.solids.end());
  std::vector<Finding> findings;
  for (const SolidId solid : scene.solids.ids()) {
    if (studied.contains(solid)) continue;
    findings.push_back({Severity::warning, scene.solids[solid].info.path, "", "", "the solid is left out: not closed",
                        "repair it; only closed solids can be measured"});
  }
  return findings;
}

/// Whether direct slicing kept the budgets of every slicing run.
bool is_trustworthy(const accuracy::DirectResult& direct) {
  const auto& met = direct.counters;
  const double rays = static_cast<double>(direct.rays);
  const double hits = static_cast<double>(direct.hits);
  return static_cast<double>(met.unclosed_rays + met.repaired_rays) <= tolerance::kRepairedBudget * rays &&
         static_cast<double>(met.uncertain_hits) <= tolerance::kUncertainBudget * hits;
}

std::string title_of(const Scene& scene) {
  std::string title;
  for (const SourceFile& file : scene.files) {
    title += (title.empty() ? "" : ", ") + std::filesystem::path(file.path).filename().string();
  }
  return title;
}

ExitCode run(const Session& session, const AccuracyRequest& request) {
  check_places(request);
  StepShapes shapes;
  Assembly assembly = read_assembly(session, request.files, std::nullopt, &shapes);
  require_solid(assembly.scene, false);
  measure_assembly(session, assembly);
  accuracy::StudyOptions options = request.study;
  options.threads = session.threads();
  const accuracy::StudyResult result =
      accuracy::run_study(assembly.scene, assembly.measures, shapes, options, session.progress());
  session.progress().throw_if_cancelled();
  if (request.csv) write_output(*request.csv, [&](std::ostream& stream) { write_accuracy_csv(result, stream); });
  if (request.page) {
    write_output(*request.page,
                 [&](std::ostream& stream) { write_accuracy_page(result, title_of(assembly.scene), stream); });
  }
  const std::vector<Finding> findings = left_out(assembly.scene, result);
  session.warn(findings);
  const bool is_trusted = is_trustworthy(result.direct);
  if (!is_trusted) session.terminal().warn("the error budget of direct slicing is exceeded; compare with care");
  if (session.json()) {
    Json object = accuracy_json(result);
    object["warnings"] = json_of(findings);
    session.print(object);
  }
  session.print(accuracy_text(result));
  for (const auto& place : places_of(request)) session.print("written: " + place.string() + "\n");
  return findings.empty() && is_trusted ? ExitCode::ok : ExitCode::budget;
}

AccuracyRequest read_request(const CLI::App& verb, const std::vector<std::string>& files) {
  AccuracyRequest request;
  request.files = files;
  accuracy::StudyOptions& study = request.study;
  if (const auto list = given(verb, "--deflections")) study.deflections = parse_lengths("--deflections", *list);
  if (const auto list = given(verb, "--pitches")) study.pitches = parse_lengths("--pitches", *list);
  if (const auto angle = given(verb, "--angle")) {
    const double degrees = parse_positive("--angle", *angle);
    if (degrees > 90.0) throw UsageError("'" + *angle + "' is more than 90 degrees", "--angle", "give less");
    study.angle = degrees / 180.0 * kPi;
  }
  const auto whole = [&](const char* option, std::size_t& value, long low, long high) {
    if (const auto text = given(verb, option)) {
      value = static_cast<std::size_t>(parse_whole(option, *text, low, high));
    }
  };
  whole("--rays", study.rays, 1, 20'000'000);
  whole("--oracle-rays", study.oracle_rays, 0, 1'000'000);
  whole("--occt-rays", study.occt_rays, 0, 1'000'000);
  whole("--max-triangles", study.max_triangles, 1, 100'000'000);
  if (const auto most = given(verb, "--max-seconds")) study.max_seconds = parse_positive("--max-seconds", *most);
  if (const auto page = given(verb, "--output")) request.page = *page;
  if (const auto csv = given(verb, "--csv")) request.csv = *csv;
  if (const auto folder = given(verb, "--keep-stl")) study.stl = *folder;
  return request;
}

}  // namespace

void add_accuracy(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb =
      program.add_subcommand("accuracy", "errors of slicing STL files of the model, and of direct slicing");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("files", *files, "STEP files; several are one assembly")->required()->type_name("FILE");
  add_value(*verb, "-o,--output", "a page with charts", "page.html");
  add_value(*verb, "--csv", "the figures as a table", "FILE");
  add_value(*verb, "--deflections", "of the tessellations, mm (default: 1,0.3,0.1,0.03,0.01,0.003,0.001)", "MM,...");
  add_value(*verb, "--angle", "of the tessellations, degree (default: OpenCASCADE's 0.5 rad)", "DEG");
  add_value(*verb, "--rays", "about so many are compared (default: 40000)", "N");
  add_value(*verb, "--oracle-rays", "of them, so many are asked of the certified engine too (default: 2000)", "N");
  add_value(*verb, "--occt-rays", "and so many of OpenCASCADE, for 20 s at most (default: 300)", "N");
  add_value(*verb, "--pitches", "of lattices to integrate on, mm (default: by the model's size)", "MM,...");
  add_value(*verb, "--max-triangles", "finer tessellations are skipped (default: 4000000)", "N");
  add_value(*verb, "--max-seconds", "a tessellation that takes longer is given up (default: 300)", "S");
  add_value(*verb, "--keep-stl", "keep the STL files", "DIR");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella accuracy grip.step -o accuracy.html\n"
      "  lamella accuracy grip.step --deflections 0.1,0.01 --rays 100000 --json\n"
      "  lamella accuracy grip.step --csv accuracy.csv --keep-stl meshes\n"
      "Both sides are cut by the same rays along +x: the exact surfaces, and binary STL files that OpenCASCADE's "
      "mesher\n"
      "made, written and read back. How crossings are matched is in docs/methods/accuracy.md.");
  verb->final_callback([verb, files, &action] {
    action = [request = read_request(*verb, *files)](const Session& session) { return run(session, request); };
  });
}

}  // namespace lamella::apps
