#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "slicing/layer_sink.h"

namespace lamella {

/// How pictures lie on the printer's display, in the words and with the sense of PrusaSlicer: neither mirrored nor
/// portrait, a picture shows the part from above. Portrait puts the machine's x up the picture and y to the left;
/// mirroring turns the finished picture's columns (x) or rows (y) round.
struct Sl1Display {
  bool is_portrait = false;
  bool mirror_x = false;
  bool mirror_y = false;
};

struct Sl1Options {
  std::optional<double> z_pitch{};  ///< mm, see UniformZ
  Sl1Display display{};
};

/// A folder with one SL1 archive per material, as mask printers take them: grey pictures of 8 bits and two tables of
/// keys (docs/formats/sl1.md).
[[nodiscard]] std::unique_ptr<LayerSink> make_sl1_sink(const std::filesystem::path& folder,
                                                       const Sl1Options& options = {});

}  // namespace lamella
