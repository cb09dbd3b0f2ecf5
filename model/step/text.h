#pragma once

#include <string>
#include <string_view>

/// Private to model/step: names from STEP files as clean UTF-8.
namespace lamella::step {

[[nodiscard]] bool is_utf8(std::string_view text);

/// The bytes taken as ISO 8859-1.
[[nodiscard]] std::string latin1_to_utf8(std::string_view text);

/// A name as the user should see it: valid UTF-8 (other bytes are taken as Latin-1), control characters as spaces,
/// trimmed; the exporters' words for "no name" (NONE, "") become empty.
[[nodiscard]] std::string clean_name(std::string_view text);

/// The name as one component of a path: '/' becomes '_'; `fallback` when it is empty.
[[nodiscard]] std::string path_component(std::string_view name, std::string_view fallback);

}  // namespace lamella::step
