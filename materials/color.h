#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "model/scene.h"

namespace lamella {

/// "#rrggbb" (either case) as a colour, or nothing.
[[nodiscard]] std::optional<Color> parse_color(std::string_view text);

/// The nearest 8-bit colour as "#rrggbb", lower case.
[[nodiscard]] std::string format_color(const Color& color);

/// Whether both round to the same 8-bit colour.
[[nodiscard]] bool same_color(const Color& a, const Color& b);

/// A plain word for a colour, the nearest of about thirty: "red", "dark green", "light grey".
[[nodiscard]] std::string color_word(const Color& color);

/// The `index`th of an endless list of colours that are easy to tell apart.
[[nodiscard]] Color distinct_color(std::size_t index);

}  // namespace lamella
