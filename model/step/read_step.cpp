#include "model/step/read_step.h"

#include <fstream>

#include "core/sha256.h"
#include "model/step/assembly_walk.h"
#include "model/step/convert_solid.h"
#include "model/step/step_session.h"

namespace lamella {
namespace {

std::string read_bytes(const std::filesystem::path& path, const StepOptions& options) {
  std::error_code error;
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

void read_file(Scene& scene, const std::filesystem::path& path, const StepOptions& options, const Progress& progress) {
  const std::string text = read_bytes(path, options);
  SourceFile file;
  file.path = path.string();
  file.sha256 = sha256_of_file(path);
  const std::size_t index = scene.files.size();
  scene.files.push_back(file);

  step::StepSession session(path.string(), text, progress);
  session.transfer(progress);
  const step::EntityIndex entities = session.entities();
  step::Assembly assembly =
      step::walk_assembly(session.document(), entities, [](int) -> std::optional<step::StepMaterial> { return {}; });
  const auto& sources = assembly.solids.empty() ? assembly.loose : assembly.solids;
  std::size_t done = 0;
  for (step::SolidSource source : sources) {
    progress.throw_if_cancelled();
    progress.report("converting", static_cast<double>(done++) / static_cast<double>(sources.size()));
    source.info.file = index;
    step::append_solid(scene, source, entities, assembly.colors);
  }
}

}  // namespace

Scene read_step(std::span<const std::filesystem::path> files, const StepOptions& options, const Progress& progress) {
  const step::ImportGuard guard;
  Scene scene;
  for (const std::filesystem::path& path : files) read_file(scene, path, options, progress);
  return scene;
}

}  // namespace lamella
