#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/session.h"
#include "core/geometry.h"

namespace lamella::apps {

/// A number as an option's value: one finite number and nothing else. Throws UsageError that names the option.
[[nodiscard]] double parse_number(std::string_view option, std::string_view text);
/// The same, more than zero.
[[nodiscard]] double parse_positive(std::string_view option, std::string_view text);
/// `count` numbers with commas between, two to four.
[[nodiscard]] std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count);
[[nodiscard]] Vec3 parse_vector(std::string_view option, std::string_view text);
/// A whole number in [low, high].
[[nodiscard]] long parse_whole(std::string_view option, std::string_view text, long low, long high);

/// Adds an option with one value, read by given().
CLI::Option* add_value(CLI::App& verb, const std::string& names, const std::string& help, const char* type);
/// Adds an option without a value; given or not is `verb.count(name) > 0`.
void add_switch(CLI::App& verb, const std::string& name, const std::string& help);

/// Adds --json, --quiet and --threads to a verb.
void add_common(CLI::App& verb, CommonOptions& options);

/// The option as it was given, or nothing; an empty value counts as given.
[[nodiscard]] std::optional<std::string> given(const CLI::App& verb, const std::string& option);

}  // namespace lamella::apps
