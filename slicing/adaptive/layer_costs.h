#pragma once

#include <string>

#include "slicing/adaptive/choose_layers.h"
#include "slicing/adaptive/layer_rules.h"
#include "slicing/adaptive/model_slants.h"

namespace lamella {

/// What layers between borders at multiples of a quantum deviate, and which materials refuse them.
class LayerCosts {
 public:
  /// All must outlive it.
  LayerCosts(const MaterialTable& table, const LayerRules& rules, const ModelSlants& slants, double bottom)
      : table_(table), rules_(rules), slants_(slants), bottom_(bottom) {}

  [[nodiscard]] double height(std::size_t border) const {
    return bottom_ + static_cast<double>(border) * rules_.quantum;
  }
  /// Bound for one material's surface, mm.
  [[nodiscard]] double deviation(MaterialId material, std::size_t border, std::size_t thickness) const;
  /// The largest of all materials.
  [[nodiscard]] double deviation(std::size_t border, std::size_t thickness) const;
  /// Whether a material takes the layer: its tolerance, and its thicknesses where the layer has more than half a
  /// quantum of it.
  [[nodiscard]] bool accepts(MaterialId material, std::size_t border, std::size_t thickness) const;
  /// The same for all materials.
  [[nodiscard]] bool accepts(std::size_t border, std::size_t thickness) const;

  /// Throws InputError that names the materials that leave no layer on the highest of `reached` borders where there is
  /// none.
  [[noreturn]] void refuse(const std::vector<std::size_t>& reached) const;

 private:
  [[nodiscard]] bool has(MaterialId material, std::size_t border, std::size_t thickness) const;
  [[nodiscard]] std::string demand(MaterialId material, std::size_t border) const;
  [[noreturn]] void refuse_at(std::size_t border, const std::vector<MaterialId>& materials) const;

  const MaterialTable& table_;
  const LayerRules& rules_;
  const ModelSlants& slants_;
  double bottom_;
};

}  // namespace lamella
