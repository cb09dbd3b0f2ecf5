#pragma once

#include <CLI/CLI.hpp>

#include "materials/material_table.h"
#include "slicing/reference/reference_engine.h"

namespace lamella::apps {

/// Adds --engine, --solver, --tolerance and --subdivision.
void add_engine_options(CLI::App& verb);
/// Throws UsageError on an unknown word, the span engine (which isn't there yet), or numbers that make no sense.
[[nodiscard]] ReferenceOptions read_engine_options(const CLI::App& verb);

/// Adds --overlap.
void add_overlap_option(CLI::App& verb);
[[nodiscard]] OverlapPolicy read_overlap_policy(const CLI::App& verb);

}  // namespace lamella::apps
