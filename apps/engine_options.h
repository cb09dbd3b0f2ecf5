#pragma once

#include <CLI/CLI.hpp>
#include <optional>

#include "materials/material_table.h"
#include "slicing/slicer.h"

namespace lamella::apps {

/// The engine that was asked for, if one was, and what the reference engine is told.
struct EngineChoice {
  std::optional<EngineKind> engine;
  ReferenceOptions reference;
};

/// Adds --engine, --solver, --tolerance and --subdivision; `fallback` says what happens without --engine.
void add_engine_options(CLI::App& verb, const std::string& fallback);
/// Throws UsageError on an unknown word, on numbers that make no sense, and on options of the reference engine when it
/// isn't asked for.
[[nodiscard]] EngineChoice read_engine_options(const CLI::App& verb);

/// Adds --overlap.
void add_overlap_option(CLI::App& verb);
[[nodiscard]] OverlapPolicy read_overlap_policy(const CLI::App& verb);

}  // namespace lamella::apps
