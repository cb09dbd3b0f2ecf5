#include <algorithm>
#include <fmt/format.h>
#include <map>

#include "apps/assembly.h"
#include "apps/options.h"
#include "apps/outputs.h"
#include "apps/table.h"
#include "apps/verbs.h"
#include "core/atomic_file.h"
#include "materials/color.h"
#include "model/solid_status.h"

namespace lamella::apps {

namespace {

struct InfoOptions {
  std::vector<std::string> files;
  std::optional<std::string> materials;
  std::optional<std::string> write_materials;
};

/// Counts over one solid's faces.
struct FaceCounts {
  std::size_t faces = 0;
  std::size_t edges = 0;
  std::map<std::string, std::size_t> surface_types;
};

/// Calls `visit` with every face of the solid.
void for_each_face(const Scene& scene, SolidId solid, const auto& visit) {
  for (const ShellId shell : scene.solids[solid].shells) {
    for (const FaceId face : scene.shells[shell].faces) visit(face);
  }
}

FaceCounts count_faces(const Scene& scene, SolidId solid) {
  FaceCounts counts;
  std::vector<EdgeId> edges;
  for_each_face(scene, solid, [&](FaceId id) {
    const Face& face = scene.faces[id];
    ++counts.faces;
    ++counts.surface_types[surface_type_name(face.surface)];
    for (const LoopId loop : face.loops) {
      for (const HalfEdgeId half_edge : scene.loops[loop].half_edges) edges.push_back(scene.half_edges[half_edge].edge);
    }
  });
  std::sort(edges.begin(), edges.end());
  counts.edges = static_cast<std::size_t>(std::unique(edges.begin(), edges.end()) - edges.begin());
  return counts;
}

Json file_json(const SourceFile& file) { return {{"path", file.path}, {"schema", file.schema}, {"unit", file.unit}}; }

Json solid_json(const Assembly& assembly, SolidId id) {
  const SolidInfo& info = assembly.scene.solids[id].info;
  const SolidMeasure& measure = assembly.measures[id];
  const Assignment& assignment = assembly.table.assignments[id];
  const FaceCounts counts = count_faces(assembly.scene, id);
  return {{"id", id.value()},
          {"file", info.file},
          {"name", info.name},
          {"path", info.path},
          {"color", info.color ? Json(format_color(*info.color)) : Json(nullptr)},
          {"layer", text_or_null(info.layer)},
          {"step_material", text_or_null(info.step_material)},
          {"material", assembly.table.materials[assignment.material].name},
          {"rule", assignment.rule},
          {"volume", measure.volume},
          {"area", measure.area},
          {"bounds", json_of(measure.bounds)},
          {"faces", counts.faces},
          {"edges", counts.edges},
          {"surface_types", counts.surface_types},
          {"closed", info.closed},
          {"healed", info.healed},
          {"max_tolerance", info.max_tolerance},
          {"status", status_word(info)},
          {"priority", assignment.priority},
          {"step_density", info.step_density ? Json(*info.step_density) : Json(nullptr)},
          {"volume_error", measure.volume_error}};
}

Json info_json(const Assembly& assembly) {
  Json files = Json::array();
  for (const SourceFile& file : assembly.scene.files) files.push_back(file_json(file));
  Json solids = Json::array();
  for (const SolidId id : assembly.scene.solids.ids()) solids.push_back(solid_json(assembly, id));
  return {{"files", files}, {"solids", solids}, {"warnings", json_of(assembly.findings)}};
}

std::string files_text(const Scene& scene) {
  TextTable table({{"file"}, {"schema"}, {"length unit"}});
  for (const SourceFile& file : scene.files) table.add({file.path, file.schema, file.unit});
  return table.text();
}

std::string size_text(const Box3& box) {
  if (box.isEmpty() || !box.min().allFinite() || !box.max().allFinite()) return "-";
  const Vec3 size = box.sizes();
  return fmt::format("{:.5g} x {:.5g} x {:.5g}", size.x(), size.y(), size.z());
}

std::string solids_text(const Assembly& assembly) {
  TextTable table({{"id", true},
                   {"solid"},
                   {"material"},
                   {"by"},
                   {"faces", true},
                   {"volume [mm^3]", true},
                   {"area [mm^2]", true},
                   {"size [mm]"},
                   {"tolerance [mm]", true},
                   {"status"}});
  for (const SolidId id : assembly.scene.solids.ids()) {
    const SolidInfo& info = assembly.scene.solids[id].info;
    const SolidMeasure& measure = assembly.measures[id];
    const Assignment& assignment = assembly.table.assignments[id];
    table.add({std::to_string(id.value()), info.path, assembly.table.materials[assignment.material].name,
               assignment.rule, std::to_string(count_faces(assembly.scene, id).faces), short_number(measure.volume),
               short_number(measure.area), size_text(measure.bounds), short_number(info.max_tolerance),
               status_word(info)});
  }
  return table.text();
}

std::string materials_text(const Assembly& assembly) {
  TextTable table({{"material"}, {"color"}, {"density [g/cm^3]", true}, {"solids", true}, {"volume [mm^3]", true}});
  for (const MaterialId id : assembly.table.materials.ids()) {
    const Material& material = assembly.table.materials[id];
    std::size_t solids = 0;
    double volume = 0.0;
    for (const SolidId solid : assembly.scene.solids.ids()) {
      if (assembly.table.assignments[solid].material != id) continue;
      ++solids;
      volume += assembly.measures[solid].volume;
    }
    table.add({material.name, format_color(material.color), material.density ? short_number(*material.density) : "-",
               std::to_string(solids), short_number(volume)});
  }
  return table.text();
}

std::string surfaces_text(const Scene& scene) {
  std::map<std::string, std::size_t> types;
  for (const Face& face : scene.faces) ++types[surface_type_name(face.surface)];
  std::string out = "surfaces:";
  for (const auto& [type, count] : types) out += fmt::format(" {} {}", count, type);
  return out + "\n";
}

std::string healed_text(const Scene& scene) {
  std::string out;
  for (const Solid& solid : scene.solids) {
    for (const std::string& line : solid.info.healed)
      out += printable("healed: " + solid.info.path + ": " + line) + "\n";
  }
  return out;
}

/// The error of a run on this model, if there is nothing to slice.
std::optional<InputError> find_hopeless(const Scene& scene) {
  try {
    require_solid(scene, false);
    return std::nullopt;
  } catch (const InputError& error) {
    return error;
  }
}

bool all_sound(const Scene& scene) {
  return std::all_of(scene.solids.begin(), scene.solids.end(),
                     [](const Solid& solid) { return solid.info.status == SolidStatus::ok && solid.info.closed; });
}

ExitCode run(const Session& session, const InfoOptions& options) {
  if (options.write_materials) {
    std::vector<std::string> inputs = options.files;
    if (options.materials) inputs.push_back(*options.materials);
    refuse_inputs_as_outputs({*options.write_materials}, inputs);
  }
  Assembly assembly = read_assembly(session, options.files, options.materials);
  if (options.write_materials) refuse_inputs_as_outputs({*options.write_materials}, assembly.material_files);
  measure_assembly(session, assembly);
  if (options.write_materials) {
    const auto folder = std::filesystem::absolute(*options.write_materials).parent_path();
    write_file_atomically(*options.write_materials, starter_rules(assembly.scene, assembly.table, folder));
  }
  const auto hopeless = find_hopeless(assembly.scene);
  if (session.json()) {
    Json object = info_json(assembly);
    if (hopeless) object["error"] = json_of(*hopeless);
    session.print(object);
  }
  session.print(files_text(assembly.scene) + "\n" + solids_text(assembly) + "\n" + materials_text(assembly) + "\n" +
                surfaces_text(assembly.scene) + healed_text(assembly.scene));
  if (options.write_materials) session.print("materials written to " + *options.write_materials + "\n");
  if (hopeless) session.terminal().error(*hopeless);
  if (hopeless) return hopeless->code();
  return all_sound(assembly.scene) ? ExitCode::ok : ExitCode::budget;
}

}  // namespace

void add_info(CLI::App& program, CommonOptions& common, Action& action) {
  CLI::App* verb = program.add_subcommand("info", "solids, materials, volumes, faults of STEP files");
  auto files = std::make_shared<std::vector<std::string>>();
  verb->add_option("files", *files, "STEP files; several are one assembly")->required()->type_name("FILE");
  add_value(*verb, "--materials", "show what this materials file makes of the solids", "M.xml");
  add_value(*verb, "--write-materials", "write a materials file to edit: what the solids are made of now", "M.xml");
  add_common(*verb, common);
  verb->footer(
      "Examples:\n"
      "  lamella info grip.step\n"
      "  lamella info grip.step insert.step --json\n"
      "  lamella info grip.step --write-materials grip.xml\n"
      "  lamella info grip.step --materials grip.xml\n"
      "  lamella info grip.step --materials shop.xml --write-materials grip.xml\n"
      "Lengths mm, areas mm^2, volumes mm^3. Exit code 0: all solids are sound, 2: nothing to slice, 3: some are not.");
  verb->final_callback([verb, files, &action] {
    const InfoOptions options{*files, given(*verb, "--materials"), given(*verb, "--write-materials")};
    action = [options](const Session& session) { return run(session, options); };
  });
}

}  // namespace lamella::apps
