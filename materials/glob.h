#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace lamella {

/// Whether `pattern` matches the whole of `text`, character by character of UTF-8 and case sensitive: `*` any run (also
/// of '/'), `?` one character, `[a-z]` and `[!a-z]` one of a set, `\` takes the next character literally.
/// Time at most the product of the two lengths. A pattern that `glob_fault` names a fault of matches nothing.
[[nodiscard]] bool matches_glob(std::string_view pattern, std::string_view text);

/// What is wrong with a pattern (an open `[`, a trailing `\`, bytes that aren't UTF-8), or nothing.
[[nodiscard]] std::optional<std::string> glob_fault(std::string_view pattern);

/// A pattern that matches exactly `text`; characters that XML can't hold become `?`.
[[nodiscard]] std::string escape_glob(std::string_view text);

}  // namespace lamella
