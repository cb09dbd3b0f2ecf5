#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "slicing/layer_sink.h"

namespace lamella {

struct Sl1Options {
  std::optional<double> z_pitch{};  ///< mm, see UniformZ
};

/// A folder with one SL1 archive per material, as mask printers take them: grey pictures of 8 bits and two tables of
/// keys (docs/formats/sl1.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_sl1_sink(const std::filesystem::path& folder,
                                                       const Sl1Options& options = {});

}  // namespace lamella
