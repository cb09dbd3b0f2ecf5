#pragma once

#include <string>

#include "slicing/layer.h"

namespace lamella {

/// SHA-256 of a layer's content, independent of how it is stored: docs/formats/store.md, "Checksums".
[[nodiscard]] std::string digest_of(const Layer& layer);

}  // namespace lamella
