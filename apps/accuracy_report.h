#pragma once

#include <ostream>
#include <string>

#include "apps/json.h"
#include "slicing/accuracy/accuracy_study.h"

namespace lamella::apps {

/// The object of docs/command.md; what was skipped or not asked for is null.
[[nodiscard]] Json accuracy_json(const accuracy::StudyResult& result);
/// Tables for people.
[[nodiscard]] std::string accuracy_text(const accuracy::StudyResult& result);
/// One line a measurement: direct slicing, each deflection, each lattice. Empty cells are unknown or don't apply.
void write_accuracy_csv(const accuracy::StudyResult& result, std::ostream& stream);

}  // namespace lamella::apps
