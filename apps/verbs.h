#pragma once

#include <CLI/CLI.hpp>

#include "apps/session.h"

namespace lamella::apps {

/// A verb's options live in the closure that `action` is set to when the verb was named.
void add_info(CLI::App& program, CommonOptions& common, Action& action);
void add_slice(CLI::App& program, CommonOptions& common, Action& action);
void add_orient(CLI::App& program, CommonOptions& common, Action& action);
void add_ray(CLI::App& program, CommonOptions& common, Action& action);
void add_export(CLI::App& program, CommonOptions& common, Action& action);
void add_plan(CLI::App& program, CommonOptions& common, Action& action);
void add_view(CLI::App& program, CommonOptions& common, Action& action);
void add_accuracy(CLI::App& program, CommonOptions& common, Action& action);
void add_check(CLI::App& program, CommonOptions& common, Action& action);

}  // namespace lamella::apps
