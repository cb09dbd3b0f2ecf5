#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/session.h"
#include "core/xml.h"
#include "model/step/read_step.h"

namespace lamella::apps {

/// A job file (docs/formats/job.md): the parts with their placements, and options of `lamella slice` by their names.
struct Job {
  struct Option {
    std::string name;  ///< "--pitch"
    std::string value;
    std::string where;  ///< file:line
  };
  std::vector<StepPart> parts;
  std::vector<Option> options;
};

/// Reads a job for the options that `slice` has. Paths in it are relative to its folder and come out as seen from the
/// working directory. Throws InputError with file, line and hint.
[[nodiscard]] Job read_job(const std::filesystem::path& file, const CLI::App& slice);

/// Gives the verb the options of the job that the command line doesn't have: what is typed goes before what is written.
void apply_job(const Job& job, CLI::App& slice, CommonOptions& common);

}  // namespace lamella::apps
