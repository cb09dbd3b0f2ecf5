#include "model/step/read_step.h"

#include <fstream>
#include <gp_Trsf.hxx>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "core/sha256.h"
#include "model/move_scene.h"
#include "model/step/assembly_walk.h"
#include "model/step/convert_solid.h"
#include "model/step/import_report.h"
#include "model/step/raw_properties.h"
#include "model/step/raw_structure.h"
#include "model/step/raw_topology.h"
#include "model/step/shape_list.h"
#include "model/step/solid_report.h"
#include "model/step/step_session.h"
#include "model/step/step_shapes.h"
#include "model/step/text.h"
#include "model/topology.h"

namespace lamella {
namespace {

using step::Part21;

std::string read_bytes(const std::filesystem::path& path, const StepOptions& options) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw InputError("there is no such file", path.string());
  if (!std::filesystem::is_regular_file(status)) throw InputError("not a regular file", path.string());
  const auto size = std::filesystem::file_size(path, error);
  if (error) throw InputError("can't read the file: " + error.message(), path.string());
  if (size > options.max_bytes) {
    throw InputError(
        "the file has " + std::to_string(size) + " bytes, more than the limit of " + std::to_string(options.max_bytes),
        path.string());
  }
  std::ifstream stream(path, std::ios::binary);
  std::string bytes(size, '\0');
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) {
    throw InputError("can't read the file", path.string());
  }
  return bytes;
}

std::string sha256_of(const std::string& bytes) {
  Sha256 digest;
  digest.update(std::as_bytes(std::span(bytes)));
  return digest.finish();
}

/// Without its placement a part would lie at the wrong place, and nothing in the result would show it.
void refuse_broken_placements(const Part21& raw, const std::string& name,
                              const std::vector<step::RefusedEntity>& broken) {
  for (const step::RefusedEntity& entity : broken) {
    const std::string keyword = raw.keyword_of(entity.number);
    for (const char* placement : {"RELATIONSHIP_WITH_TRANSFORMATION", "ITEM_DEFINED_TRANSFORMATION",
                                  "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION"}) {
      if (keyword.find(placement) == std::string::npos) continue;
      throw InputError("the placement of a part can't be read: " + entity.reason,
                       name + ", " + step::label_of(entity.number) + " " + keyword, "export the file again");
    }
  }
}

SourceFile describe_file(const std::filesystem::path& path, const std::string& bytes, const Part21& raw,
                         std::vector<Finding>& findings) {
  SourceFile file;
  file.path = path.string();
  file.sha256 = sha256_of(bytes);
  file.schema = step::application_protocol(raw.schema());
  const auto units = step::length_units(raw);
  if (units.empty()) {
    file.unit = "millimetre";
    findings.push_back({Severity::warning,
                        {},
                        {},
                        {},
                        path.string() + " states no length unit",
                        "millimetres are assumed: check the sizes"});
    return file;
  }
  file.unit = units.front().name;
  file.unit_in_mm = units.front().in_mm;
  for (std::size_t i = 1; i < units.size(); ++i) {
    findings.push_back({Severity::note,
                        {},
                        {},
                        step::label_of(units[i].entity),
                        "parts of the file are in another length unit: " + units[i].name,
                        "each part is converted by its own unit"});
  }
  return file;
}

void report_syntax(const Part21& raw, const std::string& path, std::vector<Finding>& findings) {
  for (const step::SyntaxFault& fault : raw.faults()) {
    findings.push_back({Severity::warning,
                        {},
                        {},
                        step::label_of(fault.entity),
                        "syntax error in " + path + ", line " + std::to_string(fault.line) + ": " + fault.what,
                        "what the statement says is lost; export the file again"});
  }
}

/// Loose geometry that must be in the scene all the same: shells of what the file states to be a solid, which the
/// import couldn't close, and everything where there is no solid at all, so that the command can name it.
void keep_broken_solids(step::Assembly& assembly, const step::RawTopology& topology, std::vector<Finding>& findings) {
  const bool all = assembly.solids.empty();
  std::vector<step::SolidSource> loose;
  for (step::SolidSource& source : assembly.loose) {
    const int shell = source.info.step_entity;
    const int owner = topology.solid_of(shell);
    const bool stated_solid = owner != 0 && owner != shell;
    if (all || stated_solid) {
      const bool faces = source.shape.ShapeType() != TopAbs_SHELL;
      findings.push_back({Severity::error,
                          source.info.path,
                          {},
                          step::label_of(shell),
                          stated_solid ? "the solid is in pieces that don't close"
                          : faces      ? "loose faces that belong to no shell and no solid"
                                       : "a shell that bounds no solid",
                          "close it and make it a solid in the CAD system, or slice with --allow-open"});
    }
    if (stated_solid) source.info.step_entity = owner;
    (all || stated_solid ? assembly.solids : loose).push_back(std::move(source));
  }
  assembly.loose = std::move(loose);
}

void report_loose(const step::Assembly& assembly, std::vector<Finding>& findings) {
  for (const step::SolidSource& source : assembly.loose) {
    findings.push_back({Severity::warning,
                        source.info.path,
                        {},
                        step::label_of(source.info.step_entity),
                        "a shell or face outside any solid is left out",
                        "make it a solid in the CAD system if it is meant to be material"});
  }
}

void check_placements(std::span<const StepPart> parts) {
  std::size_t count = 0;
  for (const StepPart& part : parts) {
    count += part.placements.size();
    for (const Motion& motion : part.placements) {
      if (is_rotation(motion.turn) && motion.shift.allFinite()) continue;
      throw InputError("a placement is no rigid motion", part.file.string(), "turn and shift only, in finite numbers");
    }
  }
  if (count <= kMaxPlacements) return;
  throw InputError("more than " + std::to_string(kMaxPlacements) + " copies are asked for",
                   parts.empty() ? std::string() : parts.front().file.string(), "slice a part of them at a time");
}

TopLoc_Location location_of(const Motion& motion) {
  const Mat3& r = motion.turn;
  const Vec3& t = motion.shift;
  if (r == Mat3::Identity() && t == Vec3::Zero()) return {};
  gp_Trsf placement;
  placement.SetValues(r(0, 0), r(0, 1), r(0, 2), t.x(), r(1, 0), r(1, 1), r(1, 2), t.y(), r(2, 0), r(2, 1), r(2, 2),
                      t.z());
  return placement;
}

std::vector<step::RootPlace> root_places(const StepPart& part) {
  std::vector<step::RootPlace> places;
  for (const Motion& motion : part.placements) {
    step::RootPlace place{{}, location_of(motion)};
    if (!part.label.empty()) place.path = "/" + step::path_component(part.label, "part");
    if (!place.path.empty() && part.placements.size() > 1) place.path += "." + std::to_string(places.size() + 1);
    places.push_back(std::move(place));
  }
  return places;
}

/// Reads files into one scene.
class Reader {
 public:
  Reader(const StepOptions& options, const Progress& progress, StepShapes* shapes)
      : options_(options), progress_(progress), shapes_(shapes) {}

  void read(const StepPart& part);
  Scene finish();

 private:
  /// A text and what the import's reader made of it, with nothing in it that the import can't bear.
  struct Source {
    std::shared_ptr<const Part21> raw;
    std::unique_ptr<step::StepSession> session;
    std::vector<step::RefusedEntity> refused;
  };
  /// `raw` is the index of `bytes`.
  Source read_source(std::string& bytes, const std::string& name, std::shared_ptr<const Part21> raw);
  void convert(const step::Assembly& assembly, const step::EntityIndex& entities);
  void make_unique(std::string& path);
  void check_shapes(step::SolidReport& report, const step::Assembly& assembly, SolidId first,
                    const step::EntityIndex& entities);

  const StepOptions& options_;
  const Progress& progress_;
  StepShapes* shapes_;
  Scene scene_;
  std::vector<step::PendingFaults> pending_;
  std::set<std::string> paths_;
};

void Reader::read(const StepPart& part) {
  const std::filesystem::path& path = part.file;
  std::string bytes = read_bytes(path, options_);
  const std::string name = path.string();
  const auto raw = std::make_shared<const Part21>(bytes, progress_);
  step::require_step_text(*raw, name);
  step::require_acyclic(*raw, name, progress_);
  scene_.files.push_back(describe_file(path, bytes, *raw, scene_.findings));
  report_syntax(*raw, name, scene_.findings);
  const auto materials = step::materials(*raw, scene_.findings);
  Source source = read_source(bytes, name, raw);
  step::StepSession& session = *source.session;
  session.transfer(progress_);
  const step::EntityIndex entities = session.entities();
  const auto material_of = [&materials](int product) -> std::optional<step::StepMaterial> {
    const auto found = materials.find(product);
    return found == materials.end() ? std::nullopt : std::optional(found->second);
  };
  step::Assembly assembly = step::walk_assembly(session.document(), entities, material_of, root_places(part));
  if (assembly.solids.empty() && assembly.loose.empty()) step::throw_nothing_readable(*raw, name, source.refused);
  const step::RawTopology topology(*source.raw, progress_);
  keep_broken_solids(assembly, topology, scene_.findings);
  report_loose(assembly, scene_.findings);
  const SolidId first{scene_.solids.size()};
  convert(assembly, entities);

  step::SolidReport report(scene_, first, topology);
  report.add_refused(source.refused);
  report.add_remarks(step::transfer_remarks(session.model(), session.process()));
  report.add_lost_faces();
  check_shapes(report, assembly, first, entities);
  report.add_wide_tolerances();
  pending_.push_back({first, SolidId{scene_.solids.size()}, topology.faults()});
}

Reader::Source Reader::read_source(std::string& bytes, const std::string& name, std::shared_ptr<const Part21> raw) {
  constexpr int kRounds = 8;
  constexpr std::size_t kNamed = 20;
  std::vector<step::RefusedEntity> causes;
  for (int round = 0; round < kRounds; ++round) {
    if (round > 0) raw = std::make_shared<const Part21>(bytes, progress_);
    Source source{raw, nullptr, {}};
    auto broken = step::broken_geometry(*source.raw, {});
    if (broken.empty()) {
      source.session = std::make_unique<step::StepSession>(name, *source.raw, options_.heal, progress_);
      source.refused = step::refused_entities(source.session->model());
      const bool bare = !source.raw->has("SHAPE_DEFINITION_REPRESENTATION");
      if (bare && !source.refused.empty()) step::throw_nothing_readable(*source.raw, name, source.refused);
      broken = step::broken_geometry(*source.raw, source.refused);
      source.refused.insert(source.refused.end(), causes.begin(), causes.end());
      if (broken.empty()) return source;
    }
    refuse_broken_placements(*source.raw, name, broken);
    for (std::size_t i = 0; i < broken.size(); ++i) {
      if (causes.size() + i < kNamed) {
        const std::string keyword = source.raw->keyword_of(broken[i].number);
        // A style that is lost costs a colour, not material.
        const bool style = keyword.find("STYLE") != std::string::npos;
        Finding finding{style ? Severity::warning : Severity::error, {}, {}, step::label_of(broken[i].number), {}, {}};
        finding.what = keyword + " can't be read: " + broken[i].reason;
        finding.hint = style ? "a colour may be missing" : "the file is damaged; export it again";
        scene_.findings.push_back(finding);
      }
      source.raw->blank_entity(bytes, broken[i].number);
    }
    causes.insert(causes.end(), broken.begin(), broken.end());
  }
  throw InputError(
      "the file is too damaged to be read: " + step::label_of(causes.front().number) + ": " + causes.front().reason,
      name, "export it again");
}

void Reader::convert(const step::Assembly& assembly, const step::EntityIndex& entities) {
  const std::size_t file = scene_.files.size() - 1;
  std::size_t done = 0;
  std::map<std::pair<const void*, TopAbs_Orientation>, std::size_t> bodies;
  for (step::SolidSource source : assembly.solids) {
    progress_.throw_if_cancelled();
    progress_.report("converting", 0.7 * static_cast<double>(done++) / static_cast<double>(assembly.solids.size()));
    source.info.file = file;
    const TopoDS_Shape& shape = source.shape;
    const std::size_t body =
        bodies.emplace(std::pair(shape.TShape().get(), shape.Orientation()), bodies.size()).first->second;
    source.info.instance.emplace().body = body;
    make_unique(source.info.path);
    step::append_solid(scene_, source, entities, assembly.colors);
    if (shapes_ != nullptr) shapes_->list().shapes.push_back(shape);
    if (scene_.faces.size() > options_.max_faces) {
      throw InputError("the assembly has more than " + std::to_string(options_.max_faces) + " faces, instances counted",
                       scene_.files.back().path, "read a part of it at a time");
    }
  }
}

/// Roots of several files, and parts with numbers in their names, can meet in one path.
void Reader::make_unique(std::string& path) {
  const std::string wanted = path;
  for (int n = 2; !paths_.insert(path).second; ++n) path = wanted + "." + std::to_string(n);
}

void Reader::check_shapes(step::SolidReport& report, const step::Assembly& assembly, SolidId first,
                          const step::EntityIndex& entities) {
  std::set<const void*> seen;
  std::map<int, std::vector<SolidId>> pieces;  // of one stated solid, each body once
  for (std::size_t i = 0; i < assembly.solids.size(); ++i) {
    progress_.throw_if_cancelled();
    progress_.report("converting", 0.7 + 0.3 * static_cast<double>(i) / static_cast<double>(assembly.solids.size()));
    const TopoDS_Shape& shape = assembly.solids[i].shape;
    if (shape.ShapeType() == TopAbs_COMPOUND || !seen.insert(shape.TShape().get()).second) continue;
    if (shape.ShapeType() == TopAbs_SOLID) {
      pieces[assembly.solids[i].info.step_entity].push_back(SolidId{first.value() + i});
    }
    report.add_shape_faults(SolidId{first.value() + i}, step::check_shape(shape.Located(TopLoc_Location()), entities));
  }
  pieces.erase(0);
  for (const auto& [entity, solids] : pieces) report.add_split(solids);
}

Scene Reader::finish() {
  complete_topology(scene_);
  for (const step::PendingFaults& faults : pending_) step::settle_raw_faults(scene_, faults);
  return std::move(scene_);
}

}  // namespace

Scene read_step(std::span<const std::filesystem::path> files, const StepOptions& options, const Progress& progress) {
  std::vector<StepPart> parts;
  for (const std::filesystem::path& file : files) parts.push_back({file, {}});
  return read_step_parts(parts, options, progress);
}

Scene read_step_parts(std::span<const StepPart> parts, const StepOptions& options, const Progress& progress,
                      StepShapes* shapes) {
  if (parts.empty()) throw InputError("no STEP file given");
  check_placements(parts);
  const step::ImportGuard guard;
  Reader reader(options, progress, shapes);
  for (const StepPart& part : parts) {
    progress.throw_if_cancelled();
    reader.read(part);
  }
  return reader.finish();
}

}  // namespace lamella
