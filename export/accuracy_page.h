#pragma once

#include <ostream>
#include <string>

#include "slicing/accuracy/accuracy_study.h"

namespace lamella {

/// Writes an accuracy study as one HTML page that needs nothing else and no network: totals, charts with logarithmic
/// axes, tables, and how it was measured. Light or dark as the reader's system is. `title` names the model.
void write_accuracy_page(const accuracy::StudyResult& result, const std::string& title, std::ostream& stream);

}  // namespace lamella
