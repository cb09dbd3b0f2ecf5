#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>

#include "apps/assembly.h"
#include "apps/engine_options.h"
#include "apps/options.h"
#include "apps/ray_caster.h"
#include "apps/table.h"
#include "apps/verbs.h"
#include "core/parallel.h"

namespace lamella::apps {

namespace {

struct RayOptions {
  std::vector<std::string> files;
  std::optional<std::string> materials;
  std::optional<Ray> ray;
  std::optional<std::string> rays;  ///< file of rays, "-" for stdin
  EngineChoice engine;
  OverlapPolicy policy = OverlapPolicy::priority;
};

const char* word_of(Sense sense) {
  switch (sense) {
    case Sense::entry:
      return "entry";
    case Sense::exit:
      return "exit";
    case Sense::edge:
      break;
  }
  return "edge";
}

/// A ray from a point and a direction of any length.
Ray make_ray(const Vec3& from, const Vec3& direction, const std::string& where) {
  const double length = direction.stableNorm();
  if (!from.allFinite() || !(length > 0.0) || !std::isfinite(length)) {
    throw UsageError("a ray needs a finite point and a direction that isn't zero", where, "e.g. --dir 1,0,0");
  }
  // Beyond it nothing is left of a millimetre's digits (16 of them) that could be called exact.
  constexpr double kFarthest = 1e9;
  if (from.cwiseAbs().maxCoeff() > kFarthest) {
    throw UsageError("the point of a ray lies further than 1e9 mm away", where, "give a point near the model");
  }
  return {from, direction / length};
}

/// The span engine cuts layers, and so knows horizontal rays only.
void require_engine_for(const Ray& ray, const EngineChoice& choice, const std::string& where) {
  if (choice.engine != EngineKind::span || ray.direction.z() == 0.0) return;
  throw UsageError("the span engine takes horizontal rays only", where, "use --engine reference, or leave it out");
}

Json ray_json(const Assembly& assembly, const Ray& ray, const RayResult& result) {
  Json hits = Json::array();
  for (const Hit& hit : result.hits) {
    const Face& face = assembly.scene.faces[hit.face];
    hits.push_back({{"t", hit.t},
                    {"point", json_of(ray.at(hit.t))},
                    {"solid", hit.solid.value()},
                    {"face", hit.face.value()},
                    {"sense", word_of(hit.sense)},
                    {"uv", json_of(hit.uv)},
                    {"entity", face.step_entity > 0 ? Json("#" + std::to_string(face.step_entity)) : Json(nullptr)},
                    {"uncertain", (hit.flags & kUncertain) != 0}});
  }
  Json spans = Json::array();
  for (const Span& span : result.spans) {
    spans.push_back({{"solid", span.solid.value()}, {"t_in", span.begin}, {"t_out", span.end}});
  }
  Json segments = Json::array();
  for (const Segment& segment : result.segments) {
    segments.push_back({{"t_begin", segment.x_begin},
                        {"t_end", segment.x_end},
                        {"material", assembly.table.materials[segment.material].name},
                        {"solid", segment.solid.value()}});
  }
  return {{"hits", hits},
          {"spans", spans},
          {"segments", segments},
          {"unclosed_rays", result.counters.unclosed_rays},
          {"repaired_rays", result.counters.repaired_rays},
          {"uncertain_hits", result.counters.uncertain_hits}};
}

std::string ray_text(const Assembly& assembly, const Ray& ray, const RayResult& result) {
  const Scene& scene = assembly.scene;
  TextTable hits({{"t [mm]", true}, {"point [mm]"}, {"sense"}, {"face"}, {"solid"}});
  for (const Hit& hit : result.hits) {
    const Vec3 point = ray.at(hit.t);
    const int entity = scene.faces[hit.face].step_entity;
    hits.add({fmt::format("{:.9g}", hit.t), fmt::format("{:.6g}, {:.6g}, {:.6g}", point.x(), point.y(), point.z()),
              word_of(hit.sense), entity > 0 ? fmt::format("#{}", entity) : std::to_string(hit.face.value()),
              scene.solids[hit.solid].info.path});
  }
  TextTable segments({{"from t [mm]", true}, {"to t [mm]", true}, {"material"}, {"solid"}});
  for (const Segment& segment : result.segments) {
    segments.add({fmt::format("{:.9g}", segment.x_begin), fmt::format("{:.9g}", segment.x_end),
                  assembly.table.materials[segment.material].name, scene.solids[segment.solid].info.path});
  }
  return "hits\n" + hits.text() + "\nsegments\n" + segments.text();
}

/// Six numbers with blanks between: a point and a direction.
Ray parse_ray_line(const std::string& line, const EngineChoice& choice, const std::string& where) {
  std::array<double, 6> values{};
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto skip_blanks = [&] {
    while (at != end && (*at == ' ' || *at == '\t' || *at == '\r')) ++at;
  };
  for (double& value : values) {
    skip_blanks();
    const auto [next, failure] = std::from_chars(at, end, value);
    if (failure != std::errc{} || !std::isfinite(value)) {
      throw InputError("not a ray", where, "write six numbers: x y z dx dy dz");
    }
    at = next;
  }
  skip_blanks();
  if (at != end) throw InputError("more than six numbers, or no number", where, "write x y z dx dy dz");
  try {
    const Ray ray = make_ray({values[0], values[1], values[2]}, {values[3], values[4], values[5]}, where);
    require_engine_for(ray, choice, where);
    return ray;
  } catch (const UsageError& error) {
    throw InputError(error.what(), where, error.hint());
  }
}

/// Reads up to `count` rays; an empty batch means the end.
std::vector<Ray> read_batch(std::istream& stream, const std::string& name, const EngineChoice& choice,
                            std::size_t count, std::size_t& line_number) {
  std::vector<Ray> rays;
  std::string line;
  while (rays.size() < count && std::getline(stream, line)) {
    ++line_number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    rays.push_back(parse_ray_line(line, choice, name + ":" + std::to_string(line_number)));
  }
  return rays;
}

/// What many rays met, for the exit code.
bool is_trustworthy(const RayResult& result) {
  return result.counters.unclosed_rays + result.counters.repaired_rays + result.counters.uncertain_hits == 0;
}

ExitCode cast_file(const Session& session, const RayOptions& options, const Assembly& assembly, RayCaster& caster) {
  const std::string& name = *options.rays;
  std::ifstream file;
  if (name != "-") file.open(name);
  const bool is_readable = name == "-" || (file && !std::filesystem::is_directory(name));
  if (!is_readable) throw InputError("can't read the file of rays", name, "is it there, and a file?");
  std::istream& stream = name == "-" ? std::cin : file;

  constexpr std::size_t kBatch = 4096;
  bool trustworthy = true;
  std::size_t line_number = 0;
  std::size_t ray_number = 0;
  for (;;) {
    const std::vector<Ray> rays = read_batch(stream, name, options.engine, kBatch, line_number);
    if (rays.empty()) break;
    caster.prepare(rays);
    std::vector<RayResult> results(rays.size());
    parallel_for(
        rays.size(),
        [&](std::size_t i) {
          session.progress().throw_if_cancelled();
          results[i] = caster.cast(rays[i]);
        },
        session.threads());
    for (std::size_t i = 0; i < rays.size(); ++i, ++ray_number) {
      trustworthy = trustworthy && is_trustworthy(results[i]);
      if (session.json()) {
        session.print(ray_json(assembly, rays[i], results[i]));
      } else {
        session.print(fmt::format("ray {}\n{}\n", ray_number, ray_text(assembly, rays[i], results[i])));
      }
    }
  }
  return trustworthy ? ExitCode::ok : ExitCode::budget;
}

ExitCode run(const Session& session, const RayOptions& options) {
  Assembly assembly = read_assembly(session, options.files, options.materials);
  measure_assembly(session, assembly);
  RayCaster caster(session, assembly, options.engine, options.policy);
  if (options.rays) return cast_file(session, options, assembly, caster);
  caster.prepare(std::span(&*options.ray, 1));
  const RayResult result = caster.cast(*options.ray);
  if (session.json()) session.print(ray_json(assembly, *options.ray, result));
  session.print(ray_text(assembly, *options.ray, result));
  return is_trustworthy(result) ? ExitCode::ok : ExitCode::budget;
}

RayOptions read_options(const CLI::App& verb, const std::vector<std::string>& files) {
  RayOptions options;
  options.files = files;
  options.materials = given(verb, "--materials");
  options.rays = given(verb, "--rays");
  options.engine = read_engine_options(verb);
  options.policy = read_overlap_policy(verb);
  const auto from = given(verb, "--from");
  const auto direction = given(verb, "--dir");
  if (options.rays) {
    if (from || direction)
      throw UsageError("--rays and --from, --dir exclude each other", {}, "give one ray or a file");
    return options;
  }
  if (!from || !direction) throw UsageError("a ray needs --from and --dir", {}, "or --rays FILE for many");
  options.ray = make_ray(parse_vector("--from", *from), parse_vector("--dir", *direction), "--dir");
  require_engine_for(*options.ray, options.engine, "--dir");
  return options;
}

}  // namespace

void add_ray(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("ray", "all hits of rays with the exact surfaces");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("files", *files, "STEP files; several are one assembly")->required()->type_name("FILE");
  add_value(*verb, "--from", "a point on the ray, mm", "X,Y,Z");
  add_value(*verb, "--dir", "its direction, of any length", "X,Y,Z");
  add_value(*verb, "--rays", "many rays, one a line: x y z dx dy dz; - reads stdin", "FILE");
  add_value(*verb, "--materials", "materials and their rules (default: what the STEP file says)", "M.xml");
  add_overlap_option(*verb);
  add_engine_options(*verb, "span for horizontal rays, reference for the rest");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella ray grip.step --from 0,0,5 --dir 1,0,0\n"
      "  lamella ray grip.step --from 0,0,5 --dir 0,0,1 --json\n"
      "  lamella ray grip.step --rays rays.txt --json\n"
      "t is the distance in mm from the point along the direction; the whole line counts, so t may be negative.");
  verb->final_callback([verb, files, &action] {
    const RayOptions options = read_options(*verb, *files);
    action = [options](const Session& session) { return run(session, options); };
  });
}

}  // namespace lamella::apps
