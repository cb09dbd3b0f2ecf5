#include "apps/orientation.h"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <sstream>

#include "apps/machine_options.h"
#include "apps/options.h"
#include "apps/table.h"
#include "model/move_scene.h"
#include "slicing/orient/face_choice.h"
#include "slicing/orient/natural_directions.h"

namespace lamella::apps {

namespace {

struct WeightName {
  const char* name;
  double OrientationWeights::*weight;
};

constexpr std::array<WeightName, 7> kWeights{{{"height", &OrientationWeights::height},
                                              {"layers", &OrientationWeights::layers},
                                              {"support", &OrientationWeights::support_volume},
                                              {"support_area", &OrientationWeights::support_area},
                                              {"cusp", &OrientationWeights::cusp},
                                              {"contact", &OrientationWeights::contact},
                                              {"tools", &OrientationWeights::tool_changes}}};

double* find_weight(OrientationWeights& weights, const std::string& name) {
  for (const WeightName& one : kWeights) {
    if (name == one.name) return &(weights.*one.weight);
  }
  return nullptr;
}

std::string weight_list() {
  std::string list;
  for (const WeightName& one : kWeights) list += (list.empty() ? "" : ", ") + std::string(one.name);
  return list;
}

/// "#12,#15" are several; a name may have commas.
std::vector<std::string> split_faces(const std::string& text) {
  if (!text.starts_with("#")) return {text};
  std::vector<std::string> names;
  std::istringstream stream(text);
  for (std::string name; std::getline(stream, name, ',');) names.push_back(name);
  return names;
}

std::vector<FaceId> faces_of(const Scene& scene, const std::string& text, const char* option) {
  std::vector<FaceId> faces;
  for (const std::string& name : split_faces(text)) {
    const std::vector<FaceId> more = find_named_faces(scene, name, option);
    faces.insert(faces.end(), more.begin(), more.end());
  }
  return faces;
}

std::vector<SolidId> counted_solids(const Assembly& assembly, bool sliceable_only) {
  std::vector<SolidId> solids;
  for (const SolidId id : assembly.scene.solids.ids()) {
    if (sliceable_only ? is_sliceable(assembly.scene.solids[id].info) && has_bounds(assembly, id)
                       : has_bounds(assembly, id))
      solids.push_back(id);
  }
  return solids;
}

void judge_outcome(const OrientRequest& request, OrientOutcome& outcome) {
  const auto& candidates = outcome.found.candidates;
  if (request.unsupported && (candidates.empty() || !candidates.front().is_free)) {
    throw InputError(
        fmt::format("none of {} orientations keeps '{}' free of support", outcome.found.tried, *request.unsupported),
        "--unsupported", "name fewer faces, or raise what needs no support: --critical-angle");
  }
  if (outcome.machine && !candidates.front().fits) {
    const Vec3& size = candidates.front().lying.size;
    const Vec3& volume = outcome.machine->volume;
    outcome.findings.push_back(
        {Severity::error, "", "", "",
         fmt::format(
             "no orientation fits in the machine: the best of {} needs {:.4g} x {:.4g} x {:.4g} mm, the machine "
             "has {:.4g} x {:.4g} x {:.4g} mm",
             outcome.found.tried, size.x(), size.y(), size.z(), volume.x(), volume.y(), volume.z()),
         "divide the part or choose a larger machine"});
  }
  if (request.down && !(candidates.front().figures.contact_area > 0.0)) {
    outcome.findings.push_back({Severity::warning, "", "", "",
                                "the face named by --down looks down but isn't the lowest: the plate doesn't touch it",
                                "name a face of the outside"});
  }
  if (!outcome.least.converged) {
    outcome.findings.push_back({Severity::warning, "", "", "",
                                "heights of some faces couldn't be searched to the end: something may reach further",
                                "check the height of the sliced build"});
  }
}

}  // namespace

OrientationWeights parse_weights(const char* option, const std::string& text) {
  OrientationWeights weights;
  std::istringstream stream(text);
  for (std::string item; std::getline(stream, item, ',');) {
    const std::size_t equals = item.find('=');
    const std::string name = item.substr(0, equals);
    double* weight = find_weight(weights, name);
    if (weight == nullptr)
      throw UsageError("'" + name + "' is nothing that orientations are judged by", option, "one of: " + weight_list());
    *weight = equals == std::string::npos ? 1.0 : parse_number(option, item.substr(equals + 1));
    if (!(*weight >= 0.0 && *weight <= 1e9))
      throw UsageError("the weight of " + name + " has to lie between 0 and 1e9", option, "e.g. height=1,support=2");
  }
  if (!(weights.sum() > 0.0)) throw UsageError("no weight is more than 0", option, "e.g. height=1,support=2");
  return weights;
}

std::vector<std::pair<const char*, double>> named_weights(const OrientationWeights& weights) {
  std::vector<std::pair<const char*, double>> named;
  for (const WeightName& one : kWeights) {
    if (weights.*one.weight > 0.0) named.emplace_back(one.name, weights.*one.weight);
  }
  return named;
}

void add_orient_options(CLI::App& verb) {
  add_value(verb, "--down", "this plane face on the plate: '#123' (STEP entity), or a face's or solid's name, * and ?",
            "FACE");
  add_value(verb, "--unsupported", "no support on or below these faces", "FACE");
  add_value(verb, "--critical-angle", "undersides flatter than this need support, degree (default: 45)", "DEG");
}

OrientRequest read_orient_options(const CLI::App& verb, const char* option, const std::string& weights) {
  OrientRequest request;
  request.weights = parse_weights(option, weights);
  request.down = given(verb, "--down");
  request.unsupported = given(verb, "--unsupported");
  if (const auto angle = given(verb, "--critical-angle")) {
    const double degrees = parse_number("--critical-angle", *angle);
    if (!(degrees >= 0.0 && degrees < 90.0))
      throw UsageError("'" + *angle + "' isn't between 0 and 90 degrees", "--critical-angle", "45 is usual");
    request.critical_angle = degrees / 180.0 * kPi;
  }
  return request;
}

void refuse_orient_options(const CLI::App& verb) {
  for (const char* option : {"--down", "--unsupported", "--critical-angle"}) {
    if (given(verb, option)) throw UsageError(std::string(option) + " needs --orient", {}, "e.g. --orient height");
  }
}

OrientOutcome find_orientation(const Session& session, const Assembly& assembly, const OrientRequest& request) {
  const Progress& progress = session.progress();
  const int threads = session.threads();
  OrientOutcome outcome;
  const std::vector<SolidId> counted = counted_solids(assembly, false);
  const std::vector<SolidId> solids = counted_solids(assembly, true);
  outcome.layer_height = plan_layers(bounds_of(assembly), request.plan).grid.pitch.z();
  if (request.machine) outcome.machine = read_machine(*request.machine);

  JudgeOptions options;
  options.layer_height = outcome.layer_height;
  options.critical_angle = request.critical_angle;
  options.counts_tools = !outcome.machine || outcome.machine->technology != Technology::material_jetting;
  OrientationWishes wishes;
  wishes.weights = request.weights;
  wishes.count = request.count;
  if (request.unsupported) options.free_faces = faces_of(assembly.scene, *request.unsupported, "--unsupported");
  if (request.down) {
    wishes.down =
        plane_normals(assembly.scene, faces_of(assembly.scene, *request.down, "--down"), *request.down, "--down");
  }
  if (outcome.machine) wishes.room = outcome.machine->volume.cwiseQuotient(outcome.machine->scale());

  auto support = std::make_shared<SupportFunction>(assembly.scene, counted, progress, threads);
  outcome.support = support;
  outcome.present_height = support->width(Vec3::UnitZ());
  std::vector<Vec3> known = natural_directions(assembly.scene, counted);
  if (request.scan) {
    outcome.scan = scan_axes(*support, *request.scan, progress);
    known.push_back(outcome.scan->turn.row(2).transpose().normalized());
  }
  outcome.least = find_least_width(*support, request.limits, known, progress);
  auto judge = std::make_shared<OrientationJudge>(
      assembly.scene, solids, assembly.table, assembly.measures, *support,
      sample_surfaces(assembly.scene, solids, request.samples, progress, threads), options, progress, threads);
  outcome.judge = judge;
  outcome.found = find_orientations(*judge, *support, outcome.least, outcome.scan, wishes, progress, threads);
  judge_outcome(request, outcome);
  return outcome;
}

Mat3 orient_assembly(const Session& session, Assembly& assembly, const OrientRequest& request) {
  const OrientOutcome outcome = find_orientation(session, assembly, request);
  session.warn(outcome.findings);
  const OrientationCandidate& best = outcome.found.candidates.front();
  session.print(fmt::format("turned ({}): height {} mm, was {} mm\n", best.origin, short_number(best.figures.height),
                            short_number(outcome.present_height)));
  assembly.scene = moved(std::move(assembly.scene), {best.lying.turn, Vec3::Zero()});
  return best.lying.turn;
}

}  // namespace lamella::apps
