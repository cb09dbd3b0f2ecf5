#pragma once

#include <optional>
#include <span>
#include <vector>

#include "slicing/contact/gap_filler.h"

namespace lamella {

/// All that is known of how the solids of a run lie to one another: who wins, where they touch, what fills their gaps.
class Interfaces {
 public:
  /// Finds the contacts of `solids`. The scene must outlive it. Throws Cancelled when asked.
  Interfaces(const Scene& scene, const MaterialTable& table, const IdVector<SolidId, SolidMeasure>& measures,
             std::span<const SolidId> solids, const ContactOptions& options, const Progress& progress = {})
      : rank_(rank_solids(scene, table, measures)),
        gap_tolerance_(options.gap_tolerance),
        distances_(scene),
        contacts_(find_contacts(distances_, measures, rank_, solids, options, progress)),
        filler_(distances_, contacts_, rank_, options.gap_tolerance) {}
  Interfaces(const Interfaces&) = delete;
  Interfaces& operator=(const Interfaces&) = delete;

  /// Of rank_solids().
  [[nodiscard]] const IdVector<SolidId, int>& rank() const { return rank_; }
  /// mm; nothing: the faces' own.
  [[nodiscard]] const std::optional<double>& gap_tolerance() const { return gap_tolerance_; }
  [[nodiscard]] const SolidDistances& distances() const { return distances_; }
  [[nodiscard]] std::span<const Contact> contacts() const { return contacts_; }

  /// See GapFiller::fill().
  void fill(double z, const RowLattice& lattice, const SpanRows& spans, std::vector<GapFill>& out) const {
    filler_.fill(z, lattice, spans, out);
  }

 private:
  IdVector<SolidId, int> rank_;
  std::optional<double> gap_tolerance_;
  SolidDistances distances_;
  std::vector<Contact> contacts_;
  GapFiller filler_;
};

}  // namespace lamella
