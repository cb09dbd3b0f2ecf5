#include "apps/options.h"

#include <charconv>
#include <cmath>

#include "core/error.h"

namespace lamella::apps {

namespace {

[[noreturn]] void refuse(std::string_view option, std::string_view text, const char* why, const char* hint) {
  std::string what = "'";
  what.append(text).append("' ").append(why);
  throw UsageError(what, std::string(option), hint);
}

/// Reads all of `text`; from_chars knows neither white space nor a leading plus.
template <class Number>
std::optional<Number> read_all(std::string_view text) {
  if (text.size() > 1 && text.front() == '+' && text[1] != '-') text.remove_prefix(1);
  Number value{};
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failure != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace

double parse_number(std::string_view option, std::string_view text) {
  const auto value = read_all<double>(text);
  if (!value || !std::isfinite(*value)) refuse(option, text, "is not a finite number", "write it as 0.05 or 5e-2");
  return *value;
}

double parse_positive(std::string_view option, std::string_view text) {
  const double value = parse_number(option, text);
  if (!(value > 0.0)) refuse(option, text, "is not more than zero", "give a positive number");
  return value;
}

std::vector<double> parse_numbers(std::string_view option, std::string_view text, std::size_t count) {
  std::vector<double> values;
  for (std::string_view rest = text;;) {
    const std::size_t comma = rest.find(',');
    values.push_back(parse_number(option, rest.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    rest.remove_prefix(comma + 1);
  }
  if (values.size() != count) {
    static constexpr const char* kWords[] = {"is not two numbers", "is not three numbers", "is not four numbers"};
    static constexpr const char* kHints[] = {"write x,y without blanks", "write x,y,z without blanks",
                                             "write them with commas between, without blanks"};
    refuse(option, text, kWords[count - 2], kHints[count - 2]);
  }
  return values;
}

Vec3 parse_vector(std::string_view option, std::string_view text) {
  const std::vector<double> values = parse_numbers(option, text, 3);
  return {values[0], values[1], values[2]};
}

long parse_whole(std::string_view option, std::string_view text, long low, long high) {
  const auto value = read_all<long>(text);
  if (!value) refuse(option, text, "is not a whole number", "write digits only");
  if (*value < low || *value > high) {
    throw UsageError(std::to_string(*value) + " is out of range", std::string(option),
                     "give " + std::to_string(low) + " to " + std::to_string(high));
  }
  return *value;
}

CLI::Option* add_value(CLI::App& verb, const std::string& names, const std::string& help, const char* type) {
  return verb
      .add_option(
          names, [](const CLI::results_t&) { return true; }, help)
      ->type_name(type);
}

void add_switch(CLI::App& verb, const std::string& name, const std::string& help) {
  verb.add_flag_callback(
      name, [] {}, help);
}

void add_common(CLI::App& verb, CommonOptions& options) {
  verb.add_flag("--json", options.json, "print one JSON object on stdout, in full precision");
  verb.add_flag("--quiet", options.quiet, "no progress; warnings and errors stay");
  verb.add_option("--threads", options.threads, "threads to use (default: all cores)")->type_name("N");
}

std::optional<std::string> given(const CLI::App& verb, const std::string& option) {
  const CLI::Option* found = verb.get_option(option);
  if (found->count() == 0) return std::nullopt;
  return found->as<std::string>();
}

}  // namespace lamella::apps
