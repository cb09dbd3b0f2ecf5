#pragma once

#include <string>
#include <string_view>

namespace lamella {

/// Bytes as base64 (RFC 4648, section 4), padded, on one line.
[[nodiscard]] std::string base64(std::string_view bytes);

}  // namespace lamella
