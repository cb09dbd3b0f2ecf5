#pragma once

#include <memory>
#include <span>
#include <vector>

#include "materials/field.h"
#include "materials/material_table.h"
#include "materials/part_distance.h"

namespace lamella {

/// What the graded solids of an assembly consist of at every point: fields in the frames of their parts, bound to the
/// solids that they are for. Copies of one body share a field, so a moved copy has the same one. Immutable.
class Compositions {
 public:
  /// Throws InputError where a field can't be had for a solid. The scene must outlive it.
  Compositions(const Scene& scene, const MaterialTable& table);

  /// Whether no solid has a graded material.
  [[nodiscard]] bool empty() const { return fields_.empty(); }

  /// How many components the solid's material has; 0 if it isn't graded.
  [[nodiscard]] std::size_t components(SolidId solid) const { return empty() ? 0 : places_[solid].components; }
  /// Of Field::detail().
  [[nodiscard]] double detail(SolidId solid) const { return fields_[places_[solid].field]->detail(); }

  /// Samples for one thread.
  class Probe {
   public:
    explicit Probe(const Compositions& compositions);
    /// Starts on a solid.
    void start(SolidId solid);
    /// Starts on a piece of a row of the machine's frame; see FieldProbe::start_row().
    void start_row(SolidId solid, const RowPiece& piece);
    /// Fractions at a point of the machine's frame; see FieldProbe::sample().
    double sample(const Vec3& point, std::span<double> fractions);

   private:
    const Compositions& compositions_;
    std::vector<std::unique_ptr<FieldProbe>> probes_;  ///< by field, made when first asked for
    FieldProbe* probe_ = nullptr;
    const PartFrame* frame_ = nullptr;
  };

 private:
  struct Place {
    std::size_t components = 0;
    std::size_t field = 0;
    PartFrame frame;
  };
  std::vector<std::shared_ptr<const Field>> fields_;
  IdVector<SolidId, Place> places_;
};

}  // namespace lamella
