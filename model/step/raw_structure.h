#pragma once

#include <string>

#include "model/step/part21.h"

/// Private to model/step: checks of a file's references before the import follows them.
namespace lamella::step {

/// Throws InputError, naming the entities, when following references of shapes, placements or products would never
/// end: the import recurses along them. Cycles elsewhere are harmless.
void require_acyclic(const Part21& file, const std::string& path, const Progress& progress);

/// An entity whose attributes the import could not read, with its reason.
struct RefusedEntity {
  int number = 0;
  std::string reason;
};

/// Whether what the import complains about is only a name that is missing, which does no harm.
[[nodiscard]] inline bool is_about_a_name(const std::string& reason) {
  return reason.find("quoted String") != std::string::npos;
}

/// Geometry and topology below the shells that lacks what it is made of, and all that is built on it, up to the face or
/// solid, in the file's order; `refused` may add causes. The import would follow the missing references and crash, but
/// bears shells with missing faces: what is listed must be taken out of the text before shapes are made.
[[nodiscard]] std::vector<RefusedEntity> broken_geometry(const Part21& file, const std::vector<RefusedEntity>& refused);

/// Throws InputError that says why the file holds no shape at all: what it holds instead, or what is missing where.
/// `refused` lists entities the import could not read.
[[noreturn]] void throw_nothing_readable(const Part21& file, const std::string& path,
                                         const std::vector<RefusedEntity>& refused);

/// Throws InputError when the text is no STEP file, is cut short, or holds no entity.
void require_step_text(const Part21& file, const std::string& path);

}  // namespace lamella::step
