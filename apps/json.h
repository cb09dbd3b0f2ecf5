#pragma once

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/geometry.h"

namespace lamella::apps {

/// Keys in the order of docs/command.md; numbers that aren't finite become null.
using Json = nlohmann::ordered_json;

/// "note", "warning" or "error".
[[nodiscard]] const char* word_of(Severity severity);
[[nodiscard]] Json json_of(const Vec2& value);
[[nodiscard]] Json json_of(const Vec3& value);
/// Three rows.
[[nodiscard]] Json json_of(const Mat3& value);
/// [[x,y,z],[x,y,z]], or null when the box is empty or not finite.
[[nodiscard]] Json json_of(const Box3& box);
/// {"severity","solid","face","entity","what","hint"}; empty texts become null.
[[nodiscard]] Json json_of(const Finding& finding);
[[nodiscard]] Json json_of(const std::vector<Finding>& findings);
/// {"code","what","where","hint"}
[[nodiscard]] Json json_of(const Error& error);
/// The text, or null when it is empty.
[[nodiscard]] Json text_or_null(const std::string& text);
/// One line without blanks; bytes that aren't UTF-8 become U+FFFD.
[[nodiscard]] std::string dump(const Json& object);

}  // namespace lamella::apps
