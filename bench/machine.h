#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace lamella::bench {

/// What the figures depend on: CPU, cores, compiler, build, the commit as the caller says, and the UTC time.
[[nodiscard]] nlohmann::json describe_machine(const std::string& commit);

}  // namespace lamella::bench
