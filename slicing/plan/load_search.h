#pragma once

#include <cstdint>
#include <optional>
#include <vector>

/// Three ways to choose loads; each gives, beside the materials of every step, their tools. See load_tools.h.
namespace lamella {

using ToolRows = std::vector<std::vector<std::uint32_t>>;

/// Loads what is missing in place of what is needed again last. Exact when materials that share a tool share all tools.
[[nodiscard]] ToolRows load_by_next_use(const ToolRows& needs, const std::vector<std::uint32_t>& holders,
                                        std::size_t tools);

/// All loads of all tools by dynamic programming; nothing when they are too many.
[[nodiscard]] std::optional<ToolRows> load_by_search(const ToolRows& needs, const std::vector<std::uint32_t>& holders,
                                                     std::size_t tools);

/// Step by step the matching with the fewest reloads, of equal ones that which drops what is needed again last.
[[nodiscard]] ToolRows load_by_matching(const ToolRows& needs, const std::vector<std::uint32_t>& holders,
                                        std::size_t tools);

}  // namespace lamella
