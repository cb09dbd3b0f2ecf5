#pragma once

#include <string>
#include <vector>

namespace lamella {

/// One file name per given name: a plain, portable part of a path, and unique among the results without regard to
/// ASCII case.
///
/// Letters and digits of every script, '-', '_', '+' and inner dots stay; blanks, path separators, control and
/// invisible formatting characters and bytes that aren't UTF-8 become '_'. An empty name becomes "unnamed"; names that
/// Windows reserves gain a '_', later duplicates and names that are `taken` already "_2", "_3" and so on. At most 100
/// bytes long.
[[nodiscard]] std::vector<std::string> safe_file_names(const std::vector<std::string>& names,
                                                       const std::vector<std::string>& taken = {});

}  // namespace lamella
